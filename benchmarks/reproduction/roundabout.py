"""Straight, then a roundabout: figures 5.11, 5.12, 5.16 to 5.18, tables 5.2 and 5.4."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from benchmarks.reproduction import figures
from benchmarks.reproduction.angles import Angles
from benchmarks.reproduction.common import (
    FIRST_MOUNT,
    PICTURES,
    SECOND_MOUNT,
    angles_text,
    case,
    columns_table,
    estimate_text,
    picture,
    printed_text,
    table,
    traces,
)
from benchmarks.reproduction.runs import PRESETS, Trace, integrated_speed
from core.samples import COURSE, SPEED
from core.simulation import Drive, simulate

Floats = NDArray[np.float64]

PRINTED: tuple[Angles, Angles] = ((-93.2120, -5.6945, 23.3673), (-93.0093, -3.1417, 39.9257))
PRINTED_TEST = ((0.3, 1.05, 3.6, 8.1), (0.24, 0.52, 1.1, 2.2))
TEST_TIMES = (10.0, 20.0, 40.0, 60.0)
WHICH = ("first", "second")


def roundabout() -> str:
    """Tables 5.2 and 5.4 with their figures."""
    drive = case("roundabout", 300.0, SECOND_MOUNT)
    runs, threshold = traces(drive), PRESETS["thesis"].settling.reliable_yaw_rate
    turn = first_turn(drive, threshold)
    moments = {name: two_moments(run, turn) for name, run in runs.items()}
    _draw(drive, runs, threshold)
    rows = [["printed", *(printed_text(angles, SECOND_MOUNT) for angles in PRINTED)]]
    for name, run in runs.items():
        rows.append([f"`{name}`", *(estimate_text(run.average[k], SECOND_MOUNT) for k in moments[name])])
    first, second = (f"{runs['thesis'].t[k]:.0f} s" for k in moments["thesis"])
    return f"""## Straight, then a roundabout (thesis figures 5.11, 5.12, 5.16, 5.17, table 5.2)

{picture("routes", "Routes: straight, curves, roundabout")}

Mounting {angles_text(SECOND_MOUNT)}, where theta = -90° and only phi - psi is defined. First estimate: the moving
average when the first roundabout begins ({first}); second: its first STABLE value well after it (`thesis`: {second}).

{table(["", "first estimate", "second estimate"], rows)}

{picture("roundabout", "Components of the estimated quaternion on the roundabout drive")}

{picture("moving_average", "First component and its moving average")}

{picture("yaw_rate", "Yaw rate from the course, with the threshold of RELIABLE")}

The course of events is the print's: stable and wrong on the straight, right after the roundabouts. Our first estimate
is worse than the print's: the filter starts 90° away, and one acceleration and the unevenness of the road are all that
shows the mounting on the straight. In the roundabout the yaw rate (5.2) exceeds the threshold of RELIABLE,
{threshold:.2f} rad/s. So does the noise of the receiver's course at walking pace, when the vehicle drives off. The
course is unwrapped before it is differenced, so that there are no peaks at 0/360°.

{_drive_test(drive, runs, moments)}"""


def first_turn(drive: Drive, threshold: float) -> float:
    """The first time at which a moving vehicle turns faster than the threshold."""
    rate = np.abs(np.gradient(np.unwrap(drive.samples.fix[:, COURSE]), drive.truth.t))
    return float(drive.truth.t[np.flatnonzero((rate > threshold) & (drive.samples.fix[:, SPEED] > 4))[0]])


def two_moments(run: Trace, turn: float) -> tuple[int, int]:
    """Index of the last value before the turn and of the first STABLE one well after it."""
    stable = np.flatnonzero(run.stable & (run.t > turn + 25))
    return int(np.searchsorted(run.t, turn)) - 1, int(stable[0]) if stable.size else run.t.size - 1


def _draw(drive: Drive, runs: dict[str, Trace], threshold: float) -> None:
    others = {name: case(name, seconds, FIRST_MOUNT) for name, seconds in (("straight", 157.0), ("curves", 150.0))}
    figures.save(figures.routes(others | {"roundabout": drive}), PICTURES / "routes.png")
    figures.save(figures.components({"straight, then roundabouts": (drive, runs)}), PICTURES / "roundabout.png")
    figures.save(figures.yaw_rate(drive, threshold), PICTURES / "yaw_rate.png")
    figures.save(figures.moving_average(runs["thesis"], 200.0), PICTURES / "moving_average.png")


def _drive_test(drive: Drive, runs: dict[str, Trace], moments: dict[str, tuple[int, int]]) -> str:
    starts = [float(runs["thesis"].t[k]) for k in moments["thesis"]]
    tests = {
        f"{name}, {WHICH[which]} estimate": integrated_speed(
            drive, run.average[moments[name][which]], starts[which], 60
        )
        for which in (0, 1)
        for name, run in runs.items()
    }
    figures.save(figures.drive_tests(tests), PICTURES / "drive_test.png")
    flat = simulate(replace(drive.truth.scenario, relief=0.0))
    calibrated = simulate(replace(flat.truth.scenario, sensor="calibrated", gyro=False))
    for name, other in (("same road", drive), ("flat road", flat), ("flat road, 3 mg", calibrated)):
        tests[f"truth, {name}"] = integrated_speed(other, drive.truth.q_vs, starts[1], 60)
    columns = {f"printed, {which}": [f"{x:.2f}" for x in row] for which, row in zip(WHICH, PRINTED_TEST, strict=True)}
    columns |= {name: [f"{departure(test, t):.2f}" for t in TEST_TIMES] for name, test in tests.items()}
    return f"""## Drive test (thesis 5.4, figure 5.18, table 5.4)

Forward specific force integrated as printed (5.6), no slope and no bias taken off; departure from the GPS speed, m/s.

{picture("drive_test", "Integrated speed and GPS speed")}

{columns_table("after", [f"{t:.0f} s" for t in TEST_TIMES], columns)}

Even the true mounting (last columns) departs: one per cent of grade makes 3.9 m/s in 40 s, ten mg of bias along the
vehicle as much. The print's second estimate departs by 1.1 m/s in 40 s, so its road was flat to about 0.3 % and its
sensor good to 3 mg along that axis, or the estimate had taken up the bias."""


def departure(test: tuple[Floats, Floats, Floats], t: float) -> float:
    """Difference of integrated and GPS speed after a time, m/s."""
    times, integrated, gps = test
    k = min(int(np.searchsorted(times, t)), times.size - 1)
    return float(abs(integrated[k] - gps[k]))
