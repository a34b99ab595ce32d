"""What the drive test of 40 s lets pass: docs/method.md, section 5, written once more in a few lines."""

from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from benchmarks.accuracy_study import parallel
from benchmarks.accuracy_study.options import Options
from benchmarks.accuracy_study.procrustes import Epochs, epochs
from benchmarks.accuracy_study.runs import Json
from benchmarks.accuracy_study.statistics import percent, share_of, table
from core import quaternion
from core.samples import ALTITUDE, SPEED
from core.simulation import Drive, Scenario, simulate
from core.simulation_motion import GRAVITY

Floats = NDArray[np.float64]

DURATION, LIMIT = 40.0, 2.5
"""s, m/s"""
MOVING = 1.0
"""m/s"""
ROUTES = ("city", "hills", "straight", "motorway")
DRIVES = 40
STARTS = np.arange(120.0, 520.0, 50.0)
"""s"""
OFFSETS = (5.0, 10.0, 20.0, 45.0, 90.0, 180.0)
"""deg"""
RIGHT = "right within 1°"
LARGEST_BIAS = 60e-3 * GRAVITY
"""m/s2; three sigma of the accelerometer bias, the most that is believed of it"""
ALTITUDE_SMOOTHING = 2.0
"""s"""


class Work(NamedTuple):
    """Epochs between two fixes in motion, E of them."""

    t: Floats
    """(E,) s, begin"""
    period: Floats
    f_s: Floats
    """(E, 3) m/s2, mean specific force"""
    speed: Floats
    energy: Floats
    """(E,) m2/s2, kinetic and potential energy gained"""


def work_of(drive: Drive) -> Work:
    """Cut a drive into epochs, the latency of the fixes taken off."""
    samples, fix = drive.samples, drive.samples.fix
    t = drive.truth.t
    rows = np.searchsorted(samples.t, t - drive.truth.latency)
    total = np.vstack([np.zeros(3), np.cumsum(samples.f_s, axis=0)])
    count = np.maximum(np.diff(rows), 1)[:, None]
    height = gaussian_filter1d(fix[:, ALTITUDE], ALTITUDE_SMOOTHING * drive.truth.scenario.gps_rate)
    speed = 0.5 * (fix[1:, SPEED] + fix[:-1, SPEED])
    energy = speed * np.diff(fix[:, SPEED]) + GRAVITY * np.diff(height)
    moving = (np.minimum(fix[1:, SPEED], fix[:-1, SPEED]) > MOVING) & (np.diff(rows) > 0)
    mean = (total[rows[1:]] - total[rows[:-1]]) / count
    return Work(t[:-1][moving], np.diff(t)[moving], mean[moving], speed[moving], energy[moving])


def speed_error(work: Work, forward_s: Floats, bias: Floats, start: float) -> float:
    """Speed error, m/s, after 40 s of driving from `start`, of a forward axis (3,) in sensor axes; nan if too short."""
    first = int(np.searchsorted(work.t, start))
    last = first + int(np.searchsorted(np.cumsum(work.period[first:]), DURATION)) + 1
    if last > work.t.size:
        return float("nan")
    part = Work(*(column[first:last] for column in work))
    excess = np.sum((part.f_s - bias) @ forward_s * part.speed * part.period - part.energy)
    return float(abs(excess) * part.period.sum() / np.sum(part.speed * part.period))


def fitted_bias(seen: Epochs, q_vs: Floats, start: float) -> Floats:
    """Give the bias (3,), m/s2, that an estimator with this mounting would have found before the test."""
    count = int(np.searchsorted(seen.t, start))
    r_vs = quaternion.matrix(q_vs)
    misfit_v = r_vs @ seen.f_s[:count].mean(axis=0) - seen.k_v[:count].mean(axis=0)
    bias: Floats = np.clip(misfit_v, -LARGEST_BIAS, LARGEST_BIAS) @ r_vs
    return bias


def mountings(rng: np.random.Generator) -> dict[str, Floats]:
    """Rotation vectors, rad, by which a right and the wrong mountings are off."""
    way = rng.normal(size=3)
    wrong = {
        f"{angle:.0f}° about {name}": np.radians(angle) * rng.choice([-1.0, 1.0]) * axis
        for angle, (name, axis) in product(OFFSETS, zip("xyz", np.eye(3), strict=True))
    }
    return {RIGHT: np.radians(rng.uniform(0, 1)) * way / np.linalg.norm(way)} | wrong


def follow(item: tuple[str, int]) -> Json:
    """Put the mountings on the test at several times of a drive; the errors, m/s."""
    route, seed = item
    rng = np.random.default_rng(seed)
    drive = simulate(Scenario(route, 600.0, seed, imu_rate=100.0))
    work, seen, found = work_of(drive), epochs(drive.samples), dict[str, list[float]]()
    for start in STARTS:
        for name, turn in mountings(rng).items():
            q_vs = quaternion.multiply(quaternion.from_rotation_vector(turn), drive.truth.q_vs)
            bias = fitted_bias(seen, q_vs, float(start))
            error = speed_error(work, quaternion.matrix(q_vs)[0], bias, float(start))
            found.setdefault(name, []).append(error)
    return {name: [value for value in values if np.isfinite(value)] for name, values in found.items()}


def measure(options: Options) -> Json:
    """Run every route."""
    items = [(route, seed) for route in ROUTES for seed in range(7000, 7000 + options.scaled(DRIVES))]
    results = parallel.run("drive-test", follow, items)
    shares = dict[str, dict[str, float]]()
    for route in ROUTES:
        runs = [r for r, (name, _) in zip(results, items, strict=True) if name == route]
        shares[route] = {name: share_of([error < LIMIT for run in runs for error in run[name]]) for name in runs[0]}
    return {"tests": len(STARTS) * options.scaled(DRIVES), "shares": shares}


def text(result: Json) -> str:
    """Table."""
    shares = result["shares"]
    rows = [[name, *(percent(shares[route][name]) for route in ROUTES)] for name in shares[ROUTES[0]]]
    return f"""## What the drive test accepts

Share of tests of {DURATION:.0f} s passed (error below {LIMIT} m/s), up to {result["tests"]} tests in each field: the
work of the forward specific force against the energy gained, by mountings that are right and by mountings turned about
the vehicle's forward (x), left (y) and upward (z) axis, each with the accelerometer bias that fits it best before the
test, at most 60 mg along each of these axes.

{table(["", *ROUTES], rows)}

The test measures along the forward axis only, so it cannot see a turn about x; a turn about y it sees at once, by
gravity; a turn about z as far as the vehicle brakes and accelerates. The other angles are settled before the test, by
the stated sigma and the second opinion."""
