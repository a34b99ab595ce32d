"""The rotation between two devices in one car, from their gyroscopes alone."""

import numpy as np
from numpy.typing import NDArray

from core import Samples, quaternion

Floats = NDArray[np.float64]

RATE = 20.0
"""Hz, of the common raster"""
LONGEST_LAG = 20.0
"""s between the clocks of the two devices"""


def relative_rotation(a: Samples, b: Samples) -> Floats:
    """Give the rotation (4,) that turns angular rates of device b into those of device a: Wahba's problem."""
    start, end = max(a.t[0], b.t[0]), min(a.t[-1], b.t[-1])
    t = np.arange(start + LONGEST_LAG, end - LONGEST_LAG, 1 / RATE)
    w_a = _at(a, t)
    lags = np.arange(-LONGEST_LAG, LONGEST_LAG, 1 / RATE)
    likeness = [np.corrcoef(np.linalg.norm(w_a, axis=1), np.linalg.norm(_at(b, t + x), axis=1))[0, 1] for x in lags]
    w_b = _at(b, t + lags[int(np.argmax(likeness))])
    u, _, vt = np.linalg.svd((w_a - w_a.mean(axis=0)).T @ (w_b - w_b.mean(axis=0)))
    return quaternion.from_matrix(u @ np.diag([1.0, 1.0, np.linalg.det(u @ vt)]) @ vt)


def _at(samples: Samples, t: Floats) -> Floats:
    """(K, 3) angular rate, rad/s, averaged over the raster."""
    known = np.all(np.isfinite(samples.w_s), axis=1)
    time, w_s = samples.t[known], samples.w_s[known]
    angle = np.vstack([np.zeros(3), np.cumsum(0.5 * (w_s[1:] + w_s[:-1]) * np.diff(time)[:, None], axis=0)])
    ends = (t - 0.5 / RATE, t + 0.5 / RATE)
    before, after = (np.stack([np.interp(x, time, angle[:, i]) for i in range(3)], axis=-1) for x in ends)
    return RATE * (after - before)
