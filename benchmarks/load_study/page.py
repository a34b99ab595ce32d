"""The section on load of docs/performance.md, and its picture."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from matplotlib import pyplot as plt

from benchmarks.accuracy_study.figures import save
from benchmarks.accuracy_study.statistics import Target, number, table, target_table
from benchmarks.load_study.cells import CELLS, Result
from benchmarks.load_study.pacing import Plan

TEXT = """## A fleet

How many devices the service holds that send a minute of driving once a minute (200 Hz, three axes, GPS at 4 Hz), two
server processes and the load generator sharing the machine; made by `make bench-load`. A chunk is due at its own time
whatever became of those before it, and its latency counts from then. A count is held when 99 % of the answers come
within {limit:.0f} ms, none is an error or missing, and afterwards every acknowledged chunk is found in the database
exactly once. Each run warms up for {warm_up:.0f} s and is measured for {measure:.0f} s."""
COLUMNS = [
    "",
    "devices",
    "held",
    "p50 / p95 / p99 / longest, ms",
    "errors",
    "CPU a chunk, ms",
    "of it database",
    "generator, ms",
    "fsyncs a chunk",
    "RSS, MiB",
    "cores busy",
]

Runs = Mapping[str, Sequence[Result]]


def largest_held(results: Sequence[Result], limit: float) -> int:
    """Give the largest count held, 0 when none was."""
    return max((result.devices for result in results if result.held(limit)), default=0)


def targets(runs: Runs, skipped: Mapping[str, str], limit: float) -> list[Target]:
    """Judge the cells."""
    judged = []
    for name, cell in CELLS.items():
        what = f"devices, {cell.database}, {cell.encoding}" + (f", fsync {1e3 * cell.fsync:g} ms" if cell.fsync else "")
        if name in runs:
            held = largest_held(runs[name], limit)
            judged.append(Target(what, f"≥ {cell.wanted}", str(held), held >= cell.wanted))
        else:
            judged.append(Target(what, f"≥ {cell.wanted}", skipped.get(name, "–"), None))
    return judged


def row(name: str, result: Result, limit: float) -> list[str]:
    """Give a run as a row of the table."""
    failed = sum(result.errors.values()) + result.unanswered + result.wrong
    return [
        name,
        str(result.devices),
        "yes" if result.held(limit) else "no",
        " / ".join(number(1e3 * value) for value in result.latency),
        str(failed),
        number(1e3 * result.server_cpu),
        number(1e3 * result.database_cpu),
        number(1e3 * result.generator_cpu),
        number(result.fsyncs),
        " ".join(f"{mib:.0f}" for mib in result.rss),
        number(result.cores),
    ]


def stage_table(stages: Mapping[str, Mapping[str, float]]) -> str:
    """Give the table of stages, an encoding per column."""
    names = list(next(iter(stages.values())))
    rows = [[stage, *(number(column[stage]) for column in stages.values())] for stage in names]
    return table(["", *stages], rows)


def assemble(
    runs: Runs, skipped: Mapping[str, str], stages: Mapping[str, Mapping[str, float]], plan: Plan, limit: float
) -> str:
    """Write the section."""
    parts = [
        TEXT.format(limit=1e3 * limit, warm_up=plan.warm_up, measure=plan.measure),
        target_table(targets(runs, skipped, limit)),
        table(COLUMNS, [row(name, result, limit) for name, results in runs.items() for result in results]),
        "![p99 against the number of devices](pictures/load.png)",
    ]
    if stages:
        parts.append(f"CPU of a chunk by stage, in one process without HTTP, median ms:\n\n{stage_table(stages)}")
    return "\n\n".join(parts)


def draw(runs: Runs, limit: float, path: Path) -> None:
    """Draw p99 against the number of devices."""
    figure, axis = plt.subplots(figsize=(7, 3.5))
    for name, results in runs.items():
        ordered = sorted(results, key=lambda result: result.devices)
        axis.semilogy([r.devices for r in ordered], [1e3 * r.latency.p99 for r in ordered], "o-", label=name)
    axis.axhline(1e3 * limit, color="black", lw=0.7)
    axis.set(xlabel="devices", ylabel="p99, ms")
    axis.legend(fontsize=7)
    save(figure, path)
