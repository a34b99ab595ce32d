"""The section on load of docs/performance.md, and its picture."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from matplotlib import pyplot as plt

from benchmarks.accuracy_study.figures import save
from benchmarks.accuracy_study.statistics import Target, number, percent, table, target_table
from benchmarks.load_study.cells import BESIDE, CELLS, NAIVE, P99, SQLITE, Cell
from benchmarks.load_study.drives import ENCODINGS
from benchmarks.load_study.result import Result, largest_held
from benchmarks.load_study.study import Study

TEXT = """## A fleet

How many devices the service holds that send a minute of driving once a minute (200 Hz, three axes, GPS at 4 Hz), two
server processes, database and load generator sharing the machine; made by `make bench-load`. Every device has driven
for six minutes before and drives on; its mounting is confirmed, so that events are looked for in its samples, and a
second filter watches over it. Samples are not kept (`LIVELLA_RAW_RETENTION_DAYS=0`; keeping them takes 2 to 4 ms more
of the processor a chunk). CSV has decimals, Arrow what the sensors count: 16-bit accelerations, positions in
10⁻⁷ degrees.
Chunks are due evenly spread over the minute, the devices in any order, not in the one in which they have connected.
A chunk is due at its own time whatever became of those before it, and its latency counts
from then. A count is held when 99 % of the answers come
within {limits}, none is an error or missing, and afterwards every
acknowledged chunk is found in the database exactly once. The counts wanted are measured for {full:.0f} s; where one is
missed, shorter runs look for what is held, and for SQLite with CSV also for what is held beyond. A run without hope is
broken off. Figures differ from run to run, by a tenth and more on a shared machine."""
COLUMNS = [
    "",
    "devices",
    "held",
    "measured, s",
    "p50 / p95 / p99 / longest, ms",
    "errors",
    "CPU a chunk, ms",
    "of it database",
    "generator, ms",
    "of all CPU",
    "fsyncs a chunk",
    "RSS of a worker, MiB",
    "cores busy",
    "loop, ms",
]
ERRORS = """"Errors" are answers other than 200, chunks without an answer, and devices of which something acknowledged
is not stored exactly once. CPU is that of all the service's processes and of the database, from the end of the warm-up
to the end of the run, for each chunk that was taken in: where many are refused (503), refusing is in it. "Loop" is
what a million additions in Python took on the same machine just before and after: its speed changes with what others do
on it, and every figure with it."""
STAGE_TEXT = """### Where the CPU of a chunk goes

Median ms of the functions of an upload, called one after the other in one process on SQLite. The last line is what the
service's processes needed for a chunk in the runs above, with {devices} devices; the one before it is what that
is more than the functions: HTTP, threads, housekeeping, and that busy cores disturb each other."""
NAIVE_TEXT = """### Beside a naive stack

`benchmarks/naive.py` is the same upload as one would write it first: FastAPI, pyarrow, `scipy.signal.decimate`, a numpy
filter, an ORM session per request, the state as JSON; what it leaves out is in its favour. Same generator, same
machine, same run, as many processes, {what}, p99 within {limit:.0f} ms."""
MEMORY, MIB = 600, 1.048576
"""MB"""
HTTP, WHOLE = "HTTP and the rest", "whole, under load"

Stages = Mapping[str, Mapping[str, float]]


def targets(study: Study) -> list[Target]:
    """Judge the cells, and the memory of a worker in the largest run of the one that has most to keep."""
    return [*(_target(name, cell, study) for name, cell in CELLS.items() if not cell.naive), *_memory(study)]


def _memory(study: Study) -> list[Target]:
    runs = [run for run in study.runs.get(BESIDE, []) if run.devices >= CELLS[BESIDE].devices]
    if not runs:
        return []
    most = max(max(run.rss) for run in runs) * MIB
    what = f"memory of a worker with {CELLS[BESIDE].devices} devices or more"
    return [Target(what, f"≤ {MEMORY} MB", f"{most:.0f} MB", most <= MEMORY)]


def _target(name: str, cell: Cell, study: Study) -> Target:
    what = f"devices, {cell.words}, p99 ≤ {1e3 * cell.limit:.0f} ms"
    if name not in study.runs:
        return Target(what, f"≥ {cell.devices}", study.skipped.get(name, "–"), None)
    best = largest_held(study.runs[name], cell.limit)
    held = 0 if best is None else best.devices
    return Target(what, f"≥ {cell.devices}", held_words(study.runs[name], cell.limit), held >= cell.devices)


def held_words(results: list[Result], limit: float) -> str:
    """Say how many devices were held, or below how many that lies."""
    best = largest_held(results, limit)
    return str(best.devices) if best is not None else f"< {min(result.devices for result in results)}"


def row(name: str, result: Result) -> list[str]:
    """Give a run as a row of the table."""
    failed = sum(result.errors.values()) + result.unanswered + result.wrong
    return [
        name,
        str(result.devices),
        "yes" if result.held(CELLS[name].limit) else "no",
        f"{result.seconds:.0f}",
        " / ".join(number(1e3 * value) for value in result.latency),
        str(failed),
        number(1e3 * result.server_cpu),
        number(1e3 * result.database_cpu),
        number(1e3 * result.generator_cpu),
        percent(result.generator_share),
        number(result.fsyncs),
        " ".join(f"{mib:.0f}" for mib in result.rss),
        number(result.cores),
        " ".join(number(1e3 * seconds) for seconds in result.loop),
    ]


def typical(name: str, study: Study) -> Result | None:
    """Give the run that speaks for a cell: with the most devices held, or else with the fewest tried."""
    results = study.runs.get(name, [])
    best = largest_held(results, CELLS[name].limit)
    return best or min(results, key=lambda result: result.devices, default=None)


def with_http(stages: Stages, study: Study) -> dict[str, dict[str, float]]:
    """Add to the stages of each encoding what a chunk costs beside them under load."""
    complete = {}
    for encoding, times in stages.items():
        run = typical(_on_sqlite(encoding), study)
        whole = float("nan") if run is None else 1e3 * run.server_cpu
        complete[encoding] = {**times, HTTP: whole - sum(times.values()), WHOLE: whole}
    return complete


def _on_sqlite(encoding: str) -> str:
    return next(name for name, cell in CELLS.items() if (cell.database, cell.encoding) == (SQLITE, encoding))


def stage_section(stages: Stages, study: Study) -> str:
    """Write of the stages."""
    complete = with_http(stages, study)
    counted = [typical(_on_sqlite(encoding), study) for encoding in complete]
    devices = " and ".join("–" if run is None else str(run.devices) for run in counted)
    names = list(next(iter(complete.values())))
    rows = [[name, *(number(column[name]) for column in complete.values())] for name in names]
    return f"{STAGE_TEXT.format(devices=devices)}\n\n{table(['', *complete], rows)}"


def ratios(study: Study) -> list[list[str]]:
    """Compare Livella and the baseline: devices held, CPU of a chunk."""
    if not {BESIDE, NAIVE} <= set(study.runs):
        return []
    own, naive = (largest_held(study.runs[name], CELLS[name].limit) for name in (BESIDE, NAIVE))
    own_cpu, naive_cpu = (1e3 * run.server_cpu for name in (BESIDE, NAIVE) if (run := typical(name, study)))
    words = [held_words(study.runs[name], CELLS[name].limit) for name in (BESIDE, NAIVE)]
    return [
        ["devices held", *words, f"×{number(own.devices / naive.devices)}" if own and naive else "–"],
        ["CPU a chunk, ms", number(own_cpu), number(naive_cpu), f"×{number(naive_cpu / own_cpu)}"],
    ]


def naive_section(study: Study) -> str:
    """Write of the baseline."""
    cell = CELLS[NAIVE]
    text = NAIVE_TEXT.format(what=cell.words, limit=1e3 * cell.limit)
    return f"{text}\n\n{table(['', 'Livella', 'naive', ''], ratios(study))}"


def assemble(study: Study, stages: Stages, full: float) -> str:
    """Write the section; `full` s are a long run."""
    limits = " and ".join(f"{1e3 * P99[encoding]:.0f} ms ({encoding.split()[0]})" for encoding in ENCODINGS)
    rows = [row(name, result) for name, results in study.runs.items() for result in results]
    parts = [
        TEXT.format(limits=limits, full=full),
        target_table(targets(study)),
        "![p99 against the number of devices](pictures/load.png)",
        table(COLUMNS, rows),
        ERRORS,
    ]
    if stages:
        parts.append(stage_section(stages, study))
    if ratios(study):
        parts.append(naive_section(study))
    return "\n\n".join(parts)


def draw(runs: Mapping[str, Sequence[Result]], path: Path) -> None:
    """Draw p99 against the number of devices: filled where it was held."""
    figure, axis = plt.subplots(figsize=(7, 3.5))
    for i, (name, results) in enumerate(runs.items()):
        for result in results:
            face = f"C{i}" if result.held(CELLS[name].limit) else "none"
            axis.plot(result.devices, 1e3 * result.latency.p99, "o", color=f"C{i}", markerfacecolor=face)
        ordered = sorted(results, key=lambda result: result.devices)
        axis.plot([r.devices for r in ordered], [1e3 * r.latency.p99 for r in ordered], color=f"C{i}", label=name)
    for encoding, limit in P99.items():
        axis.axhline(1e3 * limit, color="black", lw=0.7)
        axis.annotate(
            f"limit, {encoding}", (1.0, 1e3 * limit), xycoords=("axes fraction", "data"), ha="right", va="bottom"
        )
    axis.set(xscale="log", yscale="log", xlabel="devices", ylabel="p99, ms (filled: held)")
    axis.legend(fontsize=7)
    save(figure, path)
