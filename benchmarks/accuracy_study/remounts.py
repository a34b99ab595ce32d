"""A device that is turned during a drive in town: noticed or not, when, and the new mounting."""

from collections.abc import Sequence
from itertools import product

import numpy as np

from benchmarks.accuracy_study import parallel
from benchmarks.accuracy_study.options import Options
from benchmarks.accuracy_study.runs import Json, confirmations, of_kind, run, size
from benchmarks.accuracy_study.statistics import Target, at_most, number, percent, quantile, share_of, spread, table
from core import DEFAULT, EventKind, quaternion
from core.simulation import REMOUNT_SECONDS, Scenario, simulate

SIZES = ((6.0, 10.0), (10.0, 20.0), (20.0, 40.0))
"""deg"""
AXES = {"any axis": 180.0, "yaw only": 360.0}
"""s within which it should be noticed"""
EACH = 60
SECONDS, WHEN = 1800.0, (450.0, 750.0)

Item = tuple[str, bool, tuple[float, float], int]
"""axis, gyro, size, seed"""


def scenario_of(item: Item) -> tuple[Scenario, float]:
    """Make up a drive and by how much the device is turned on it, deg."""
    axis, gyro, sizes, seed = item
    rng = np.random.default_rng([seed, list(AXES).index(axis), gyro, SIZES.index(sizes)])
    angle, before = float(rng.uniform(*sizes)), quaternion.random(rng)
    way = rng.normal(size=3) if axis == "any axis" else np.array([0.0, 0.0, rng.choice([-1.0, 1.0])])
    turn = quaternion.from_rotation_vector(np.radians(angle) * way / np.linalg.norm(way))
    remount = (float(rng.uniform(*WHEN)), quaternion.multiply(turn, before))
    seed = int(rng.integers(2**31))
    return Scenario("city", SECONDS, seed, before, gyro=gyro, imu_rate=50.0, remount=remount), angle


def follow(item: Item) -> Json:
    """Run one drive: s, deg."""
    scenario, angle = scenario_of(item)
    drive = simulate(scenario)
    moved = drive.truth.remounted[0] if drive.truth.remounted else np.inf
    events = run(DEFAULT, drive.samples).events
    found = of_kind(events, EventKind.ORIENTATION_CHANGED)
    seen = [event for event in found if event.t >= moved]
    told = seen[0].angle if seen else None
    confirmed = confirmations(drive, events)
    anew = [c for c in confirmed if seen and c["t"] > seen[0].t]
    return {
        "before": any(c["t"] < moved for c in confirmed),
        "false": len(found) - len(seen),
        "delay": seen[0].t - moved if seen else None,
        "angle_error": None if told is None else float(np.degrees(told)) - angle,
        "anew": size(anew[0]) if anew else None,
        "anew_after": anew[0]["t"] - moved if anew else None,
    }


def measure(options: Options) -> Json:
    """Run every size, axis and sensor."""
    seeds = range(options.scaled(EACH))
    items: list[Item] = list(product(AXES, (True, False), SIZES, seeds))
    results = parallel.run("remounts", follow, items)
    return {"drives": [[list(item), result] for item, result in zip(items, results, strict=True)]}


def chosen(result: Json, axis: str, gyro: bool | None = None, sizes: Sequence[float] | None = None) -> list[Json]:
    """Pick the drives whose device was confirmed before it was turned."""
    return [
        drive
        for (a, g, s, _), drive in result["drives"]
        if a == axis and gyro in (None, g) and (sizes is None or list(sizes) == list(s)) and drive["before"]
    ]


def targets(result: Json) -> list[Target]:
    """Delays, a turn that is not noticed counting as infinitely late."""
    made = []
    for axis, limit in AXES.items():
        for gyro in (True, False):
            delays = [drive["delay"] for drive in chosen(result, axis, gyro)]
            what = f"device turned by 6 to 40°, {axis}, {_sensor(gyro)}: noticed after, 90th percentile"
            made.append(at_most(what, (quantile(delays, 0.9),), (limit,), " s"))
    return made


def text(result: Json) -> str:
    """Table."""
    rows = [
        _row(f"{axis}, {sizes[0]:.0f} to {sizes[1]:.0f}°, {_sensor(gyro)}", chosen(result, axis, gyro, sizes))
        for axis, sizes, gyro in product(AXES, SIZES, (True, False))
    ]
    columns = ["", "drives", "noticed", "after, s", "angle off, °", "confirmed anew", "error, °", "after, s "]
    count = len(result["drives"])
    early = sum(drive["false"] for _, drive in result["drives"])
    missing = sum(not drive["before"] for _, drive in result["drives"])
    return f"""## A device that is turned

Town driving of {SECONDS:.0f} s at 50 Hz; after {WHEN[0]:.0f} to {WHEN[1]:.0f} s the device is turned within
{REMOUNT_SECONDS:.0f} s. Delays from the turn, median / 90th percentile; angle told against the true one and error of
the newly confirmed mounting, median / 95th percentile. {missing} of {count} devices were not confirmed when they were
turned and are left out; {early} changes were reported before the turn.

{table(columns, rows)}"""


def _sensor(gyro: bool) -> str:
    return "gyro" if gyro else "no gyro"


def _row(name: str, drives: list[Json]) -> list[str]:
    noticed = [drive for drive in drives if drive["delay"] is not None]
    anew = [drive["anew"] for drive in drives if drive["anew"] is not None]
    return [
        name,
        str(len(drives)),
        percent(share_of([drive["delay"] is not None for drive in drives])),
        spread([drive["delay"] for drive in drives], 0.9),
        spread([abs(drive["angle_error"]) for drive in noticed if drive["angle_error"] is not None]),
        f"{len(anew)} of {len(drives)}",
        spread(anew),
        number(quantile([drive["anew_after"] for drive in drives], 0.5)),
    ]
