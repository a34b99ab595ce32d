"""The study: every cell at the count wanted, then, while time is left, what is held where that was missed."""

import time
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

from benchmarks.load_study.cells import Cell, why_not
from benchmarks.load_study.measuring import NotSlowedError, measure
from benchmarks.load_study.pacing import Plan, next_count
from benchmarks.load_study.result import Result

OVERHEAD = 40.0
"""s a run takes beside the time that chunks become due: database, start, end"""

Runs = dict[str, list[Result]]
Measure = Callable[[Cell, Plan], Result]


class Study(NamedTuple):
    """What was measured."""

    runs: Runs
    skipped: dict[str, str]
    """why, by cell"""


def carry_out(cells: Mapping[str, Cell], full: Plan, short: Plan, seconds: float, run: Measure = measure) -> Study:
    """Measure the cells in at most about so many seconds; the baseline is narrowed down first, for the ratio."""
    deadline = time.monotonic() + seconds
    study = Study({}, {})
    for name, cell in cells.items():
        _first(study, name, cell, short if cell.naive else full, run)
    while waiting := [name for name in study.runs if _next(cells[name], study.runs[name]) is not None]:
        if time.monotonic() + short.seconds + OVERHEAD > deadline:
            print(f"load: no time left to narrow down {', '.join(waiting)}", flush=True)
            break
        name = min(waiting, key=lambda name: (len(study.runs[name]), not cells[name].naive))
        count = _next(cells[name], study.runs[name])
        assert count is not None
        _add(study, name, cells[name], run(cells[name], short._replace(devices=count)))
    return study


def _first(study: Study, name: str, cell: Cell, plan: Plan, run: Measure) -> None:
    reason = why_not(cell)
    try:
        if reason is None:
            _add(study, name, cell, run(cell, plan._replace(devices=cell.devices)))
    except NotSlowedError as error:
        reason = str(error)
    if reason is not None:
        study.skipped[name] = reason
        print(f"{name}: not measured, {reason}", flush=True)


def _add(study: Study, name: str, cell: Cell, result: Result) -> None:
    study.runs.setdefault(name, []).append(result)
    print(told(name, result, cell.limit), flush=True)


def _next(cell: Cell, results: Sequence[Result]) -> int | None:
    tried = {result.devices: result.held(cell.limit) for result in results}
    fewest = min((result for result in results if not result.held(cell.limit)), key=_devices, default=None)
    return next_count(tried, 0.0 if fewest is None else fewest.served, cell.devices, cell.step, cell.beyond)


def _devices(result: Result) -> int:
    return result.devices


def told(name: str, result: Result, limit: float) -> str:
    """Give a line on a run."""
    p50, p95, p99, longest = (1e3 * value for value in result.latency)
    verdict = "held" if result.held(limit) else "not held"
    return (
        f"{name}: {result.devices} devices {verdict}; p50 {p50:.0f} p95 {p95:.0f} p99 {p99:.0f} "
        f"longest {longest:.0f} ms; "
        f"{1e3 * result.server_cpu:.2f} ms CPU a chunk; generator {1e3 * result.generator_cpu:.2f} ms, "
        f"{100 * result.generator_share:.0f} % of all; {result.cores:.2f} cores; fsyncs {result.fsyncs:.2f}; "
        f"errors {result.errors}, unanswered {result.unanswered}, wrong {result.wrong}; "
        f"RSS {[round(mib) for mib in result.rss]} MiB"
    )
