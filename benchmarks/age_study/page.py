"""The section on age of docs/performance.md."""

import os
from collections.abc import Iterator, Mapping
from statistics import median

from benchmarks.accuracy_study.statistics import Target, number, table, target_table
from benchmarks.age_study.past import MOUNTS
from benchmarks.age_study.study import Study
from benchmarks.kernel_speed.page import processor
from benchmarks.kernel_speed.timing import Timing

GROWTH = 1.2
"""times as long as on the first day, at most"""
PAGE, CHART = 0.05, 0.1
"""s"""
LISTS, ALERTS, YEAR = "devices", "alerts", "chart of a year"
SAME = {"lists of devices": LISTS, "lists of alerts": ALERTS, "charts": "chart"}
COMPARED = ("devices", "alerts", "alerts, state open", "chart of an hour", "chart of a day")
"""what shows the same on the first day as after a year; the first stands for all lists of devices"""
TEXT = """## After a year

What a year of history costs, made by `make bench-age`. Two equal databases with {devices} devices, every fiftieth with
an open alert. In one a year has passed: {alerts} resolved alerts, and {senders} devices have driven {hours:.0f} hours a
day in {sessions} sessions, with their coarse and fine history, the receipts that are kept, and {mounts} former
mountings each. In the other the same devices are new. The same chunks (a minute, 200 Hz, Arrow) go to both in turn
through the service's own functions, and lists (pages of 100) and charts (1000 points) are read from both in turn, up to
the JSON that is sent; so noise falls on both alike.

Times of uploads are medians and p99 of {uploads} of each; those of lists and charts medians, with the shortest behind
the slash. Growth is how many times as long something takes after a year: of lists and charts by their shortest times,
the median over those that show the same in both, in brackets the largest.

Measured on: {machine}, shared with other work (load average {load:.1f}, this included)."""
UPLOAD_TEXT = "Uploads, ms:"
LIST_TEXT = (
    """Lists of {devices} devices and of their alerts, and charts, ms: first page, and the slowest of the deep ones."""
)
Studies = Mapping[str, Study | str]
"""by database; or why it was not measured"""


def assemble(studies: Studies) -> str:
    """Write the section."""
    done = {kind: study for kind, study in studies.items() if isinstance(study, Study)}
    size = next(iter(done.values())).size
    text = TEXT.format(
        devices=f"{size.devices:,}",
        alerts=f"{size.devices * size.alerts_each:,}",
        senders=size.senders,
        hours=size.sessions_a_day * size.hours,
        sessions=size.sessions_a_day,
        mounts=MOUNTS,
        uploads=next(iter(done.values())).uploads.number,
        machine=processor(),
        load=os.getloadavg()[1],
    )
    return "\n\n".join([text, target_table(targets(studies)), uploads(done), looks(done)])


def targets(studies: Studies) -> list[Target]:
    """Judge everything on every database."""
    return [target for kind, study in studies.items() for target in _targets(kind, study)]


def _targets(kind: str, study: Study | str) -> Iterator[Target]:
    if isinstance(study, str):
        yield Target(kind, "", study, None)
        return
    sent = study.uploads
    yield _growth(f"upload, median, {kind}", [sent.old.median / sent.fresh.median])
    yield _growth(f"upload, p99, {kind}", [sent.old.p99 / sent.fresh.p99])
    for what, begin in SAME.items():
        yield _growth(f"{what}, {kind}", growth(study, begin))
    yield _within(f"slowest list of devices, {kind}", slowest(study, LISTS), PAGE)
    yield _within(f"slowest list of alerts, {kind}", slowest(study, ALERTS), PAGE)
    yield _within(f"chart of a year, {kind}", study.looks["old", YEAR].median, CHART)


def growth(study: Study, begin: str) -> list[float]:
    """Give how many times as long looks of a kind take after a year."""
    names = [name for age, name in study.looks if age == "old" and name.startswith(begin)]
    same = [name for name in names if begin == LISTS or name in COMPARED]
    return [study.looks["old", name].least / study.looks["fresh", name].least for name in same]


def slowest(study: Study, begin: str) -> float:
    """Give the longest time of looks of a kind after a year, s."""
    return max(timing.median for (age, name), timing in study.looks.items() if age == "old" and name.startswith(begin))


def _growth(what: str, ratios: list[float]) -> Target:
    middle = median(ratios)
    largest = f" ({number(max(ratios))})" if len(ratios) > 1 else ""
    return Target(f"growth: {what}", f"≤ {GROWTH} times", f"{number(middle)}{largest}", middle <= GROWTH)


def _within(what: str, seconds: float, limit: float) -> Target:
    return Target(what, f"≤ {1e3 * limit:.0f} ms", f"{_ms(seconds)} ms", seconds <= limit)


def uploads(done: Mapping[str, Study]) -> str:
    """Write of uploads."""
    rows = [
        [f"{kind}, {age}", _ms(latency.median), _ms(latency.p99)]
        for kind, study in done.items()
        for age, latency in (("after a year", study.uploads.old), ("fresh", study.uploads.fresh))
    ]
    return f"{UPLOAD_TEXT}\n\n{table(['', 'median', 'p99'], rows)}"


def looks(done: Mapping[str, Study]) -> str:
    """Write of lists and charts."""
    first = next(iter(done.values()))
    names = [name for age, name in first.looks if age == "old" and " a page " not in name]
    columns = [f"{kind}, {what}" for kind in done for what in ("first", "deep", "first, fresh")]
    rows = [[name, *(_both(timing) for study in done.values() for timing in _times(study, name))] for name in names]
    text = LIST_TEXT.format(devices=f"{first.size.devices:,}")
    return f"{text}\n\n{table(['', *columns], rows)}"


def _times(study: Study, name: str) -> list[Timing | None]:
    deep = [timing for (age, at), timing in study.looks.items() if age == "old" and at.startswith(f"{name}, a page")]
    slowest_deep = max(deep, key=lambda timing: timing.median, default=None)
    return [study.looks["old", name], slowest_deep, study.looks["fresh", name]]


def _both(timing: Timing | None) -> str:
    return "–" if timing is None else f"{_ms(timing.median)} / {_ms(timing.least)}"


def _ms(seconds: float) -> str:
    return number(1e3 * seconds)


def told(kind: str, study: Study) -> str:
    """Give the verdicts on a database, a line each."""
    return "\n".join(f"{target.what}: {target.measured} {target.wanted}" for target in _targets(kind, study))
