"""The plainest estimate there is, for comparison: least squares over epochs of a second, in closed form.

k_v = (dv/dt + g sin(grade), v * yaw rate, g) from the fixes, f_s = R_sv k_v + b with a prior on b. No filter, no
gyroscope, no latency, no lever arm.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.ndimage import gaussian_filter1d

from core import Samples, quaternion
from core.samples import ALTITUDE, COURSE, SPEED
from core.simulation_motion import GRAVITY

Floats = NDArray[np.float64]

MIN_EPOCH, MAX_EPOCH = 0.95, 2.6
"""s"""
MIN_SPEED = 1.0
"""m/s"""
MAX_YAW_RATE = 1.5
"""rad/s; reversing and nonsense"""
MAX_GRADE = 0.2
BIAS_SIGMA = 20e-3 * GRAVITY
"""m/s2, prior"""
FIRST_NOISE = 0.5
"""m/s2 of residual in an epoch, before it is known"""
MIN_EPOCHS = 10
ALTITUDE_SMOOTHING = 2.0
"""s"""


class Epochs(NamedTuple):
    """Mean specific force and what it should be; E epochs in motion."""

    t: Floats
    """(E,) s, end"""
    f_s: Floats
    """(E, 3) m/s2, sensor axes"""
    k_v: Floats
    """(E, 3) m/s2, vehicle axes"""


def epochs(samples: Samples) -> Epochs:
    """Cut a drive into epochs of about a second between fixes."""
    usable = samples.fix_valid & np.all(np.isfinite(samples.fix[:, [SPEED, COURSE]]), axis=1)
    row, fix = samples.fix_row[usable], samples.fix[usable]
    t = samples.t[row]
    ends = _every_second(t)
    period, r0, r1 = np.diff(t[ends]), row[ends[:-1]], row[ends[1:]]
    total = np.vstack([np.zeros(3), np.cumsum(samples.f_s, axis=0)])
    f_s = (total[r1] - total[r0]) / (r1 - r0)[:, None]
    v, altitude = fix[ends, SPEED], _smooth_altitude(t, fix[:, ALTITUDE])[ends]
    speed = 0.5 * (v[1:] + v[:-1])
    grade = np.clip(np.diff(altitude) / np.maximum(speed * period, 0.1), -MAX_GRADE, MAX_GRADE)
    yaw_rate = -np.angle(np.exp(1j * np.diff(fix[ends, COURSE]))) / period
    ahead = np.diff(v) / period + GRAVITY * np.sin(np.arctan(grade))
    k_v = np.stack([ahead, speed * yaw_rate, np.full(period.size, GRAVITY)], axis=-1)
    moving = np.minimum(v[1:], v[:-1]) > MIN_SPEED
    good = moving & (period < MAX_EPOCH) & (np.abs(yaw_rate) < MAX_YAW_RATE)
    return Epochs(t[ends[1:]][good], f_s[good], k_v[good])


def _every_second(t: Floats) -> NDArray[np.int64]:
    ends = [0] if t.size else []
    for k, moment in enumerate(t.tolist()):
        if moment - t[ends[-1]] >= MIN_EPOCH:
            ends.append(k)
    return np.array(ends, np.int64)


def _smooth_altitude(t: Floats, altitude: Floats) -> Floats:
    known = np.isfinite(altitude)
    if known.sum() < 2:
        return np.zeros(t.size)
    rate = (t.size - 1) / (t[-1] - t[0])
    smooth: Floats = gaussian_filter1d(np.interp(t, t[known], altitude[known]), ALTITUDE_SMOOTHING * rate)
    return smooth


def procrustes(samples: Samples, times: ArrayLike) -> Floats:
    """Estimate the mounting from all that was seen up to each time.

    Parameters
    ----------
    samples
        a drive
    times
        (K,) s

    Returns
    -------
    (K, 4)
        q_vs; nan as long as there is too little
    """
    seen = epochs(samples)
    counts = np.searchsorted(seen.t, np.asarray(times, np.float64), side="right")
    q_vs = np.full((counts.size, 4), np.nan)
    for k, count in enumerate(counts):
        if count >= MIN_EPOCHS:
            q_vs[k] = solve(seen.f_s[:count], seen.k_v[:count])
    return q_vs


def solve(f_s: Floats, k_v: Floats) -> Floats:
    """Give the q_vs (4,) that best turns f_s (E, 3), less a constant bias, into k_v (E, 3); m/s2."""
    count, noise = f_s.shape[0], FIRST_NOISE
    f, k = f_s.sum(axis=0), k_v.sum(axis=0)
    square, product = float(np.sum(f_s**2) + np.sum(k_v**2)), f_s.T @ k_v
    r_vs = np.eye(3)
    for _ in range(3):
        weight = 1 / (count + (noise / BIAS_SIGMA) ** 2)
        b = product - weight * np.outer(f, k)
        u, _, vt = np.linalg.svd(b)
        r_vs = vt.T @ np.diag([1.0, 1.0, np.linalg.det(vt.T @ u.T)]) @ u.T
        misfit = square - weight * (f @ f + k @ k) - 2 * np.trace(r_vs @ b)
        noise = np.sqrt(max(misfit / (3 * count), 1e-6))
    return quaternion.from_matrix(r_vs)
