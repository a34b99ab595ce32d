"""Accuracy over time: random drives of ten minutes, by road and sensor."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.accuracy_study import figures, parallel
from benchmarks.accuracy_study.options import PICTURES, Options
from benchmarks.accuracy_study.procrustes import procrustes
from benchmarks.accuracy_study.runs import Json, confirmations, degrees_off, errors, first_motion, plain, run
from benchmarks.accuracy_study.statistics import Target, at_most, number, quantile, spread, table, within
from core import DEFAULT, THESIS, calibrated
from core.simulation import Scenario, simulate

Floats = NDArray[np.float64]

TIMES = np.arange(10.0, 601.0, 10.0)
"""s"""
SHOWN = {"2 min": 11, "5 min": 29, "10 min": 59}
"""indices of TIMES"""
HONEST = {"1 min": 5, **SHOWN}
ESTIMATORS = ("default", "thesis", "procrustes")
NEES_RANGE = (2.1, 4.2)
"""0.7 to 1.4 times the 3 degrees of freedom"""


FIRST_SEED = 30000
"""drives that nothing was tuned on"""


class Cell(NamedTuple):
    """A road and a sensor."""

    route: str
    sensor: str
    gyro: bool
    after_2_min: tuple[float, float]
    """deg, median and 95th percentile wanted"""
    after_10_min: tuple[float, float]


CELLS = {
    "city, calibrated, gyro": Cell("city", "calibrated", True, (1.2, 2.5), (0.4, 0.9)),
    "city, mems, gyro": Cell("city", "mems", True, (1.5, 3.0), (0.6, 1.3)),
    "city, mems": Cell("city", "mems", False, (2.0, 4.5), (0.8, 2.0)),
    "city, tmd2": Cell("city", "tmd2", False, (2.2, 5.0), (1.0, 2.5)),
    "hills, mems": Cell("hills", "mems", False, (2.2, 5.0), (0.9, 2.2)),
    "straight, mems": Cell("straight", "mems", False, (2.5, 6.0), (1.0, 2.2)),
    "motorway, mems": Cell("motorway", "mems", False, (4.0, 9.0), (1.5, 3.5)),
}


def measure(options: Options) -> Json:
    """Run every cell."""
    items = [(name, seed) for name in CELLS for seed in range(FIRST_SEED, FIRST_SEED + options.drives)]
    results = parallel.run("cells", follow, items)
    return {name: [r for r, (cell, _) in zip(results, items, strict=True) if cell == name] for name in CELLS}


def follow(item: tuple[str, int]) -> Json:
    """Run one drive through the three estimators; deg at `TIMES`."""
    cell, seed = CELLS[item[0]], item[1]
    drive = simulate(Scenario(cell.route, 600.0, seed, sensor=cell.sensor, gyro=cell.gyro))
    truth = drive.truth.q_vs
    outcome = run(calibrated(DEFAULT) if cell.sensor == "calibrated" else DEFAULT, drive.samples)
    ours = errors(outcome.estimates, truth, TIMES)
    theirs = errors(run(THESIS, drive.samples).estimates, truth, TIMES)
    return {
        "default": plain(ours.angle),
        "thesis": plain(theirs.angle),
        "procrustes": plain(degrees_off(procrustes(drive.samples, TIMES), truth)),
        "nees": plain(ours.nees),
        "moving": first_motion(drive),
        "confirmed": confirmations(drive, outcome.events),
    }


def series(result: Json, cell: str, name: str) -> Floats:
    """(drives, times) of one cell."""
    return np.array([drive[name] for drive in result[cell]], np.float64)


def mean_nees(result: Json, cell: str) -> Floats:
    """(times,) mean over the drives that have an estimate; nan where there is none."""
    values = series(result, cell, "nees")
    count = np.sum(np.isfinite(values), axis=0)
    return np.where(count > 0, np.nansum(values, axis=0) / np.maximum(count, 1), np.nan)


def targets(result: Json) -> list[Target]:
    """Errors after 2 and 10 minutes, and honesty."""
    accuracy, honesty = [], []
    for name, cell in CELLS.items():
        angle = series(result, name, "default")
        for after, wanted in (("2 min", cell.after_2_min), ("10 min", cell.after_10_min)):
            column = angle[:, SHOWN[after]]
            what = f"{name}: error after {after}, median / 95th percentile"
            accuracy.append(at_most(what, _pair(column), wanted, "°"))
        nees = mean_nees(result, name)[list(HONEST.values())]
        honesty.append(within(f"{name}: mean NEES after {', '.join(HONEST)}", nees.tolist(), *NEES_RANGE))
    return accuracy + honesty


def _pair(values: Floats) -> tuple[float, float]:
    return quantile(values, 0.5), quantile(values, 0.95)


def text(result: Json) -> str:
    """Tables and pictures."""
    _draw(result)
    count = len(next(iter(result.values())))
    return f"""## Accuracy over time

{count} random drives per row, 600 s, accelerometer at 200 Hz, GPS at 4 Hz, any mounting, total rotation error in
degrees, median / 95th percentile over the drives. `thesis` is the 9-state filter as printed, Procrustes a closed-form
fit without filter, gyroscope or latency. The rows of a road share their drives and differ in the sensor.

{_accuracy_table(result)}

![Error over time, median and the band up to the 95th percentile](pictures/accuracy/error.png)

### Does the stated uncertainty hold?

Normalised squared error of `default`: error about the vehicle's three axes over the stated sigma, squared and summed,
mean over the drives. Honest is 3; wanted is 2.1 to 4.2. Above, the estimator claims more than it knows.

{_honesty_table(result)}

![Mean normalised error over time](pictures/accuracy/nees.png)"""


def _draw(result: Json) -> None:
    panels = {name: {e: series(result, name, e) for e in ESTIMATORS} for name in CELLS}
    marks = {name: ((120.0, cell.after_2_min), (600.0, cell.after_10_min)) for name, cell in CELLS.items()}
    figures.save(figures.over_time(TIMES, panels, marks), PICTURES / "error.png")
    nees = {name: mean_nees(result, name) for name in CELLS}
    figures.save(figures.honesty(TIMES, nees, NEES_RANGE), PICTURES / "nees.png")


def _accuracy_table(result: Json) -> str:
    rows = []
    for name, cell in CELLS.items():
        wanted = {"2 min": cell.after_2_min, "10 min": cell.after_10_min}
        for after, k in SHOWN.items():
            goal = " / ".join(number(limit) for limit in wanted[after]) if after in wanted else ""
            each = [spread(series(result, name, estimator)[:, k]) for estimator in ESTIMATORS]
            rows.append([f"{name}, {after}", goal, *each])
    return table(["", "target", "`default`", "`thesis`", "Procrustes"], rows)


def _honesty_table(result: Json) -> str:
    rows = [[name, *(number(mean_nees(result, name)[k]) for k in HONEST.values())] for name in CELLS]
    return table(["", *HONEST], rows)
