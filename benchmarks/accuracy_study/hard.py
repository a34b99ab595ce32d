"""Drives that go wrong: nothing false may be confirmed on them."""

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from benchmarks.accuracy_study import parallel
from benchmarks.accuracy_study.options import Options
from benchmarks.accuracy_study.runs import Json, confirmations, of_kind, run, size
from benchmarks.accuracy_study.statistics import Target, none_of, number, table
from core import DEFAULT, EventKind
from core.simulation import Scenario, simulate
from core.simulation_faults import Disturbances
from core.simulation_motion import GRAVITY

DRIVES = 2000
WRONG = 5.0
"""deg"""
MIRRORS: tuple[tuple[float, float, float], ...] = ((-1, -1, -1), (-1, 1, 1), (1, -1, 1), (1, 1, -1))
ROADS = ("city", "hills", "straight", "motorway", "curves")

Change = Callable[[Scenario, np.random.Generator], Scenario]


class Kind(NamedTuple):
    """A way in which drives are hard."""

    change: Change
    sensor_fault: bool = False
    """the estimator should report a fault of the sensor"""
    mirrored: bool = False
    """no rotation is right: whatever is confirmed is wrong"""
    counted: bool = True
    """counts towards the target; not so where the vehicle itself is not upright"""


def on(route: str, **fields: object) -> Change:
    """Drive another route."""
    return lambda scenario, _: replace(scenario, route=route, **fields)  # type: ignore[arg-type]


def spoilt(draw: Callable[[np.random.Generator], Disturbances]) -> Change:
    """Lay faults over the drive."""
    return lambda scenario, rng: replace(scenario, disturbances=draw(rng))


def span(rng: np.random.Generator, longest: float) -> tuple[float, float]:
    """Draw a (start, end), s, within ten minutes."""
    start = float(rng.uniform(20, 500))
    return start, start + float(rng.uniform(5, longest))


def _outages(scenario: Scenario, rng: np.random.Generator) -> Scenario:
    return replace(scenario, outages=tuple(sorted(span(rng, 60.0) for _ in range(5))))


def _stuck(rng: np.random.Generator) -> Disturbances:
    return Disturbances(stuck=(int(rng.integers(3)), float(rng.uniform(0, 200))))


def _mirrored(rng: np.random.Generator) -> Disturbances:
    signs = MIRRORS[int(rng.integers(1, 4))]
    return Disturbances(signs=signs, gyro_signs=signs)


def _log_faults(rng: np.random.Generator) -> Disturbances:
    steps = tuple((float(rng.uniform(20, 500)), float(rng.choice([0.3, 2.0, 30.0, 3600.0]))) for _ in range(3))
    return Disturbances(dropped=0.05, duplicated=0.05, clock_steps=tuple(sorted(steps)))


def _wild_fixes(rng: np.random.Generator) -> Disturbances:
    return Disturbances(jumps=int(rng.integers(3, 30)), frozen_course=tuple(span(rng, 60.0) for _ in range(4)))


def _everything(rng: np.random.Generator) -> Disturbances:
    faults = replace(_log_faults(rng), jumps=10, frozen_course=(span(rng, 30.0),), altitude_noise=5.0)
    return replace(faults, multipath=2.0, bias_drift=0.1)


KINDS = {
    "parked": Kind(on("parked")),
    "parked, multipath": Kind(
        lambda s, r: replace(s, route="parked", disturbances=Disturbances(multipath=float(r.uniform(1, 5))))
    ),
    "constant speed, no bends": Kind(on("constant")),
    "motorway without altitude": Kind(
        lambda s, _: replace(s, route="motorway", disturbances=Disturbances(no_altitude=True))
    ),
    "GPS outages": Kind(_outages),
    "GPS multipath": Kind(spoilt(lambda r: Disturbances(multipath=float(r.uniform(1, 5))))),
    "wild fixes, frozen course": Kind(spoilt(_wild_fixes)),
    "strong vibration": Kind(lambda s, r: replace(s, vibration=float(r.uniform(3, 8)))),
    "steep hills": Kind(on("steep")),
    "ferry": Kind(on("ferry")),
    "reversing": Kind(lambda s, _: replace(s, route="city", reverse=True)),
    "crawling": Kind(on("crawl")),
    "altitude missing": Kind(spoilt(lambda _: Disturbances(no_altitude=True))),
    "altitude noisy": Kind(spoilt(lambda _: Disturbances(altitude_noise=5.0))),
    "samples lost, repeated, clock steps": Kind(spoilt(_log_faults)),
    "sampling jitter, GPS once a second": Kind(lambda s, _: replace(s, jitter=4e-3, gps_rate=1.0)),
    "bias drifts": Kind(spoilt(lambda _: Disturbances(bias_drift=0.3))),
    "all of it": Kind(spoilt(_everything)),
    "saturated": Kind(
        lambda s, r: replace(s, vibration=float(r.uniform(12, 20)), disturbances=Disturbances(full_scale=2 * GRAVITY)),
        sensor_fault=True,
    ),
    "stuck axis": Kind(spoilt(_stuck), sensor_fault=True),
    "left-handed, accelerometer": Kind(
        spoilt(lambda r: Disturbances(signs=MIRRORS[int(r.integers(4))])), sensor_fault=True, mirrored=True
    ),
    "left-handed, both sensors": Kind(spoilt(_mirrored), sensor_fault=True, mirrored=True),
    "towed, nose up 8°": Kind(on("towed"), counted=False),
}


def scenario_of(kind: str, seed: int, seconds: float | None = None) -> Scenario:
    """Make up a drive of a kind: road, sensor, rates and length from the seed."""
    rng = np.random.default_rng([seed, list(KINDS).index(kind)])
    base = Scenario(
        route=str(rng.choice(ROADS)),
        seconds=float(rng.uniform(300, 600)),
        seed=int(rng.integers(2**31)),
        sensor=str(rng.choice(["tmd2", "mems", "calibrated"])),
        gyro=bool(rng.random() < 0.5),
        imu_rate=float(rng.choice([50.0, 80.0, 100.0])),
        gps_rate=float(rng.choice([1.0, 2.0, 4.0])),
    )
    changed = KINDS[kind].change(base, rng)
    return changed if seconds is None else replace(changed, seconds=seconds)


def follow(item: tuple[str, int]) -> Json:
    """Run one hard drive."""
    drive = simulate(scenario_of(*item))
    events = run(DEFAULT, drive.samples).events
    faults = [str(event.fault) for event in of_kind(events, EventKind.FAULT)]
    return {"confirmed": confirmations(drive, events), "faults": faults}


def measure(options: Options) -> Json:
    """Run every kind."""
    each = max(1, round(options.scaled(DRIVES) / len(KINDS) + 0.5))
    items = [(kind, seed) for kind in KINDS for seed in range(each)]
    results = parallel.run("hard", follow, items)
    return {kind: [r for r, (k, _) in zip(results, items, strict=True) if k == kind] for kind in KINDS}


def off_by(kind: str, drive: Json) -> float:
    """Give the worst confirmed error of a drive, deg; nan when nothing was confirmed, 180 when nothing can be right."""
    if not drive["confirmed"]:
        return float("nan")
    return 180.0 if KINDS[kind].mirrored else max(size(c) for c in drive["confirmed"])


def wrong(kind: str, drives: list[Json]) -> int:
    """Count the drives on which something wrong was confirmed."""
    return sum(off_by(kind, drive) > WRONG for drive in drives)


def targets(result: Json) -> list[Target]:
    """Nothing wrong is confirmed."""
    counted = {kind: drives for kind, drives in result.items() if KINDS[kind].counted}
    total = sum(len(drives) for drives in counted.values())
    count = sum(wrong(kind, drives) for kind, drives in counted.items())
    return [
        none_of(f"hard drives on which a mounting more than {WRONG:.0f}° off was confirmed", count, total, "drives")
    ]


def text(result: Json) -> str:
    """Table."""
    rows = [_row(kind, drives) for kind, drives in result.items()]
    count = sum(len(drives) for drives in result.values())
    columns = [
        "",
        "drives",
        "confirmed",
        f"more than {WRONG:.0f}° off",
        "worst, °",
        "drive",
        "drives with a fault reported",
    ]
    return f"""## Hard drives

{count} drives of 300 to 600 s, accelerometer at 50 to 100 Hz, GPS at 1 to 4 Hz, any road, sensor and mounting, each
kind with one thing wrong. A left-handed sensor has no right mounting: anything confirmed with it counts as 180° off. A
towed car is itself tilted by 8°, which no sensor fixed to it can tell from a mounting: it is shown, and not counted.
Drive k of a kind is `hard.scenario_of(kind, k)`.

{table(columns, rows)}"""


def _row(kind: str, drives: list[Json]) -> list[str]:
    off = np.array([off_by(kind, drive) for drive in drives])
    known = off[np.isfinite(off)]
    reported = [drive["faults"] for drive in drives if drive["faults"]]
    names = sorted({name for faults in reported for name in faults})
    told = f"{len(reported)} ({', '.join(names)})" if reported else "0"
    worst = number(float(known.max())) if known.size else "–"
    expected = ", wanted" if KINDS[kind].sensor_fault else ""
    which = str(int(np.nanargmax(off))) if known.size else "–"
    return [kind, str(len(drives)), str(known.size), str(wrong(kind, drives)), worst, which, told + expected]
