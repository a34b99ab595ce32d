"""Attitude filters beside published packages on the same logs: writes the measured part of docs/attitude.md."""

import time
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.motion_study import attitude_figures
from benchmarks.motion_study.attitude_logs import CELLS, MOTIONS, SECONDS, SEEDS, SETTLED, Cell, Error, error
from benchmarks.motion_study.attitude_packages import PACKAGES, vqf
from benchmarks.sections import write_section
from core import quaternion
from core.attitude import FILTERS, initial_state
from core.simulation_marg import MargLog, MargScenario, simulate

Floats = NDArray[np.float64]
Table = Mapping[str, Mapping[Cell, Error]]

PAGE = Path(__file__).resolve().parents[2] / "docs/attitude.md"
TILT, HEADING = 1.0, 3.0
"""deg, wanted; heading in an undisturbed field"""
CLOSE = 1.1
"""of the best package's error, wanted"""
ALL = "all together"
BEGUN, FOUND = 10.0, 30.0
"""s into a log at which a filter is switched on, and s after that from which its errors count"""
TUNED = "vqf, tauAcc = 10 s"
FOLLOWING = [name for name, used in FILTERS.items() if used.follows_field]
LEVEL_ONLY = [name for name in FILTERS if name not in FOLLOWING]
"""measured near the level, where the linear filter is meant to work; their heading is that of the gyroscope"""
REPEATS = 20


def own(name: str, log: MargLog) -> Floats:
    return FILTERS[name].run(log.samples)[1].q_ns


def measure() -> Table:
    """Run everything on every log once."""
    finders: dict[str, Callable[[MargLog], Floats]] = {name: partial(own, name) for name in FILTERS}
    finders |= {**PACKAGES, TUNED: partial(vqf, tauAcc=10.0)}
    table: dict[str, dict[Cell, Error]] = {name: {} for name in finders}
    for cell in CELLS:
        logs = cell.logs()
        for name, find in finders.items():
            if name not in LEVEL_ONLY or cell.motion == "level":
                table[name][cell] = error(find, logs)
    return table


def accuracy(table: Table) -> str:
    heads = [*(f"{MOTIONS[cell.motion]}{', disturbed' if cell.disturbed else ''}" for cell in CELLS), ALL]
    lines = [f"| | {' | '.join(heads)} |", "|---" * (len(heads) + 1) + "|"]
    for name, errors in table.items():
        shown = [*map(errors.get, CELLS), together(errors)]
        cells = [f"{e.tilt:.2f} / {e.heading:.2f}" if e else "" for e in shown]
        lines.append(f"| {f'**{name}**' if name in FILTERS else name} | {' | '.join(cells)} |")
    return "\n".join(lines)


def together(errors: Mapping[Cell, Error]) -> Error | None:
    """Give the error over the logs of all cells, where there are all."""
    if len(errors) < len(CELLS):
        return None
    return Error(*np.sqrt(np.mean(np.square(list(errors.values())), axis=0)).tolist())


def begun_in_motion() -> str:
    """Errors where nothing is known of the start."""
    lines = [f"| | {' | '.join(MOTIONS.values())} |", "|---" * (len(MOTIONS) + 1) + "|"]
    finders = {name: partial(own, name) for name in FOLLOWING} | {"vqf": vqf}
    logs = {motion: [begun(log) for log in Cell(motion, disturbed=False).logs()] for motion in MOTIONS}
    for name, find in finders.items():
        errors = [error(find, logs[motion], since=BEGUN + FOUND) for motion in MOTIONS]
        lines.append(f"| {name} | {' | '.join(f'{e.tilt:.2f} / {e.heading:.2f}' for e in errors)} |")
    return "\n".join(lines)


def begun(log: MargLog) -> MargLog:
    """Leave out the beginning, and with it the rest."""
    first, n = int(np.searchsorted(log.samples.t, BEGUN)), len(log.samples)
    return log._replace(samples=log.samples.slice(first, n), q_ns=log.q_ns[first:])


def targets(table: Table) -> str:
    """Worst errors of each filter beside what is wanted, and where a package as it comes does better."""
    lines = ["| filter | worst tilt | worst heading, undisturbed | where it misses |", "|---|---|---|---|"]
    for name in ["linear", *FOLLOWING]:
        errors = table[name]
        heading = max(e.heading for cell, e in errors.items() if not cell.disturbed)
        shown = f"{heading:.2f}°" if name in FOLLOWING else "-"
        misses = "; ".join(_misses(name, table)) or "nowhere"
        lines.append(f"| {name} | {max(e.tilt for e in errors.values()):.2f}° | {shown} | {misses} |")
    return "\n".join(lines)


def _misses(name: str, table: Table) -> list[str]:
    found = []
    for cell, mine in table[name].items():
        where = f"{MOTIONS[cell.motion]}{', disturbed' if cell.disturbed else ''}"
        for word, limit, index in (("tilt", TILT, 0), ("heading", HEADING, 1)):
            if word == "heading" and name not in FOLLOWING:
                continue
            best = min(PACKAGES, key=lambda package, cell=cell, index=index: table[package][cell][index])  # type: ignore[misc]
            theirs = table[best][cell][index]
            if mine[index] > limit and not (word == "heading" and cell.disturbed):
                found.append(f"{word} above {limit:.0f}° {where}")
            if mine[index] > CLOSE * theirs:
                found.append(f"{word} {mine[index]:.2f}° against {theirs:.2f}° of {best} {where}")
    return found


def speed() -> str:
    samples = simulate(MargScenario("violent", SECONDS, SEEDS[0])).samples
    lines = ["| filter | µs a sample |", "|---|---|"]
    for name, used in FILTERS.items():
        state, taken = initial_state(used.params), []
        for _ in range(REPEATS):
            begin = time.perf_counter()
            used.advance(used.params, state, samples)
            taken.append(time.perf_counter() - begin)
        lines.append(f"| {name} | {min(taken) / len(samples) * 1e6:.2f} |")
    return "\n".join(lines)


def drift() -> str:
    log = attitude_figures.at_rest()
    lines = ["| filter | degrees off after 150 s |", "|---|---|"]
    for name in FILTERS:
        off = quaternion.angle_between(own(name, log)[-1], log.q_ns[-1])
        lines.append(f"| {name} | {np.degrees(off):.2f} |")
    return "\n".join(lines)


def write() -> None:
    """Measure, and write the section and the pictures."""
    table = measure()
    attitude_figures.draw(PAGE.parent / "pictures/attitude")
    write_section(
        PAGE,
        "measured",
        f"""## Measured

By `make bench-motion`. {len(SEEDS)} logs of {SECONDS:.0f} s at 100 Hz of each kind (`core/simulation_marg.py`), with
seeds no filter was tuned on. The gyroscope has a bias of 0.5 deg/s on each axis. Every log begins with 4 s at rest, and
errors count from {SETTLED:.0f} s on. Packages run with the settings they come with, our filters with what was tuned on
other logs of these kinds. So that this is not taken for more than it is, VQF is also shown with a longer time constant.

### Error, degrees root mean square: tilt / heading

{accuracy(table)}

The disturbed logs have fields of 15 to 60 µT that come and go, up to half of the time. `gyro` and `linear` do not
follow the field: their heading drifts with the bias. They are shown near the level, where the linear filter is meant to
work.

### Beside what was wanted

Tilt at most {TILT:.0f}° everywhere, heading at most {HEADING:.0f}° in an undisturbed field, and neither more than 10 %
above the best of the packages as they come, on each kind of logs.

{targets(table)}

![Errors of a walk in a disturbed field](pictures/attitude/walk.png)

### Begun in the middle of motion

The same undisturbed logs from {BEGUN:.0f} s on, errors from {FOUND:.0f} s after that: neither tilt nor bias were to
be seen at rest.

{begun_in_motion()}

### At rest

As in 003 figure 12: a bias of 0.07 deg/s, 150 s.

{drift()}

![Drift at rest](pictures/attitude/rest.png)

### Speed

Of the compiled kernel, violent motion, magnetometer and barometer, the best of {REPEATS} runs on the machine that
wrote this page.

{speed()}
""",
    )
