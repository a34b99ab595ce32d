"""What goes wrong with a recording: faults laid over the samples of a simulated drive, each drawn on its own.

Times are those of the undisturbed drive; the faults are laid on in the order of the fields of `Disturbances`, and only
then does the log lose, repeat and mistime its rows.
"""

from dataclasses import dataclass, replace
from math import radians

import numpy as np
from numpy.typing import NDArray

from core import quaternion
from core.samples import ALTITUDE, COURSE, LATITUDE, LONGITUDE, SPEED, VERTICAL_SPEED, Samples
from core.simulation_motion import GRAVITY, smooth_noise
from core.simulation_sensors import EARTH_RADIUS

Floats = NDArray[np.float64]
Span = tuple[float, float]
"""(start, end) s"""
Rotation = tuple[float, float, float]
"""rotation vector, rad"""

BURST, BURST_EVERY = (5.0, 30.0), 45.0
"""s, how long multipath lasts, and mean time until it begins again"""
MULTIPATH_TIME = 4.0
"""s over which velocity errors of multipath are correlated"""
METRES_PER_SPEED = 5.0
"""m by which position and altitude jump per m/s of multipath"""
JUMP_SPEED, JUMP_DISTANCE = (10.0, 30.0), (50.0, 500.0)
"""m/s, m"""
GYRO_PER_BIAS = radians(0.3) / (20e-3 * GRAVITY)
"""rad/s of gyroscope drift per m/s2 of accelerometer drift"""
LONGEST_GAP = 20
"""samples lost in a row"""


@dataclass(frozen=True)
class Disturbances:
    """Faults of sensor, receiver and log; as it stands, none."""

    bias_drift: float = 0.0
    """m/s2, amplitude by which the accelerometer bias follows the temperature, and the gyroscope's in proportion"""
    drift_period: float = 4 * 3600.0
    """s of a temperature cycle"""
    knocks: tuple[tuple[float, Rotation], ...] = ()
    """(s, rotation in sensor axes) when the device is turned, at once; the truth of the drive says nothing of it"""
    signs: tuple[float, float, float] = (1.0, 1.0, 1.0)
    """factor of each accelerometer axis: (-1, -1, -1) or (1, 1, -1) make the sensor left-handed"""
    gyro_signs: tuple[float, float, float] = (1.0, 1.0, 1.0)
    """the same of the gyroscope"""
    full_scale: float | None = None
    """m/s2 where the accelerometer saturates"""
    stuck: tuple[int, float] | None = None
    """(axis, s) from when on an accelerometer axis repeats its value"""
    multipath: float = 0.0
    """m/s rms per axis of velocity errors in bursts, with jumps of position and altitude"""
    jumps: int = 0
    """number of single fixes with a wild position and speed"""
    frozen_course: tuple[Span, ...] = ()
    """(start, end) s in which the receiver repeats its course"""
    no_altitude: bool = False
    altitude_noise: float = 1.0
    """factor of the altitude errors of the receiver"""
    dropped: float = 0.0
    """share of samples lost, in gaps of up to 20; a row with a fix is never lost"""
    duplicated: float = 0.0
    """share of samples logged twice"""
    clock_steps: tuple[tuple[float, float], ...] = ()
    """(s, s) at what time the device's clock jumps forward, and by how much"""


def disturb(samples: Samples, faults: Disturbances, rng: np.random.Generator) -> Samples:
    """Lay the faults over the samples.

    Parameters
    ----------
    samples
        samples of an undisturbed drive: N rows, M fixes
    faults
        what goes wrong
    rng
        source of all that is drawn; what one fault draws changes no other

    Returns
    -------
    Samples
        M fixes still, each with the sample it came with; N rows less those dropped and more those duplicated
    """
    if faults == Disturbances():
        return samples
    drifting, reflecting, jumping, logging = rng.spawn(4)
    f_s, w_s = _knocked(samples.t, *_drifted(samples, faults, drifting), faults.knocks)
    f_s, w_s = f_s * np.array(faults.signs), w_s * np.array(faults.gyro_signs)
    if faults.full_scale is not None:
        f_s = np.clip(f_s, -faults.full_scale, faults.full_scale)
    if faults.stuck is not None:
        axis, since = faults.stuck
        row = int(np.searchsorted(samples.t, since))
        f_s[row:, axis] = f_s[min(row, len(samples) - 1), axis]
    fix = _disturbed_fixes(samples, faults, reflecting, jumping)
    return _logged(replace(samples, f_s=f_s, w_s=w_s, fix=fix), faults, logging)


def _drifted(samples: Samples, faults: Disturbances, rng: np.random.Generator) -> tuple[Floats, Floats]:
    phase = rng.uniform(-np.pi, np.pi, (2, 3))
    angle = 2 * np.pi * samples.t[:, None] / faults.drift_period
    acceleration, turning = (faults.bias_drift * (np.sin(angle + p) - np.sin(p)) for p in phase)
    return samples.f_s + acceleration, samples.w_s + GYRO_PER_BIAS * turning


def _knocked(t: Floats, f_s: Floats, w_s: Floats, knocks: tuple[tuple[float, Rotation], ...]) -> tuple[Floats, Floats]:
    """Give the readings of a device that was turned at some moments."""
    for when, turn in knocks:
        later = (t >= when)[:, None]
        further = quaternion.matrix(quaternion.from_rotation_vector(turn))  # f_s = R f_s' of the device turned further
        f_s, w_s = np.where(later, f_s @ further, f_s), np.where(later, w_s @ further, w_s)
    return f_s, w_s


def _disturbed_fixes(
    samples: Samples, faults: Disturbances, reflecting: np.random.Generator, jumping: np.random.Generator
) -> Floats:
    """(M, 8) fixes."""
    t, fix = samples.t[samples.fix_row], samples.fix.copy()
    if faults.multipath and t.size:
        _reflect(t, fix, faults.multipath, reflecting)
    for row in jumping.choice(t.size, min(faults.jumps, t.size), replace=False):
        way = jumping.uniform(-np.pi, np.pi)
        _shift(fix[row : row + 1], jumping.uniform(*JUMP_DISTANCE) * np.array([[np.sin(way), np.cos(way)]]))
        fix[row, SPEED] += jumping.uniform(*JUMP_SPEED)
    for start, end in faults.frozen_course:
        frozen = (t >= start) & (t < end)
        if np.any(frozen):
            fix[frozen, COURSE] = fix[np.flatnonzero(frozen)[0], COURSE]
    if faults.no_altitude:
        fix[:, ALTITUDE] = np.nan
    return fix


def _reflect(t: Floats, fix: Floats, size: float, rng: np.random.Generator) -> None:
    """Multipath in bursts: the velocity wanders, position and altitude are somewhere else."""
    rate = (t.size - 1) / max(t[-1] - t[0], 1e-9)
    wander = size * np.stack([smooth_noise(rng, t.size, MULTIPATH_TIME * rate) for _ in range(3)], axis=-1)
    start = t[0] + rng.exponential(BURST_EVERY)
    while start < t[-1]:
        end = start + rng.uniform(*BURST)
        hit = (t >= start) & (t < end)
        offset = METRES_PER_SPEED * size * rng.normal(size=3)
        _shift(fix[:], hit[:, None] * offset[:2])
        fix[hit, ALTITUDE] += offset[2]
        start = end + rng.exponential(BURST_EVERY)
        _add_velocity(fix, hit, wander)


def _add_velocity(fix: Floats, hit: NDArray[np.bool_], wander: Floats) -> None:
    speed, course = fix[hit, SPEED], fix[hit, COURSE]
    east = speed * np.sin(course) + wander[hit, 0]
    north = speed * np.cos(course) + wander[hit, 1]
    fix[hit, SPEED] = np.hypot(east, north)
    fix[hit, COURSE] = np.arctan2(east, north) % (2 * np.pi)
    fix[hit, VERTICAL_SPEED] += wander[hit, 2]


def _shift(fix: Floats, offset: Floats) -> None:
    """Move positions by (M, 2) m east and north."""
    fix[:, LONGITUDE] += offset[:, 0] / (EARTH_RADIUS * np.cos(fix[:, LATITUDE]))
    fix[:, LATITUDE] += offset[:, 1] / EARTH_RADIUS


def _logged(samples: Samples, faults: Disturbances, rng: np.random.Generator) -> Samples:
    """What the log keeps: rows lost, rows twice, and the time as the device's clock shows it."""
    losing, repeating = rng.spawn(2)
    count = np.ones(len(samples), np.int64)
    gaps = losing.random(count.size) < 2 * faults.dropped / (LONGEST_GAP + 1)
    for first in np.flatnonzero(gaps).tolist():
        count[first : first + losing.integers(1, LONGEST_GAP + 1)] = 0
    count[samples.fix_row] = 1
    count[(repeating.random(count.size) < faults.duplicated) & (count > 0)] = 2
    t = samples.t.copy()
    for when, step in faults.clock_steps:
        t[samples.t >= when] += step
    kept = np.repeat(np.arange(count.size), count)
    row = (np.cumsum(count) - count)[samples.fix_row]
    return Samples.make(t[kept], samples.f_s[kept], samples.w_s[kept], row, samples.fix_valid, samples.fix)
