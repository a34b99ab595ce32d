"""Acceleration moved from one point of a rigid body to another (Rivals' formula, seed 004 equations (4) and (5))."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.motion import _kernel

Floats = NDArray[np.float64]


def transfer(a_v: ArrayLike, w_v: ArrayLike, dw_v: ArrayLike, d_v: ArrayLike) -> Floats:
    """Give a + dw x d + w x (w x d), the acceleration of the point at `d_v` from the one that has `a_v`.

    From a device at (xs, ys, zs) to the centre of gravity `d_v` is -(xs, ys, zs).

    Parameters
    ----------
    a_v, w_v, dw_v
        (N, 3) acceleration or specific force, m/s2; angular rate, rad/s; its derivative, rad/s2
    d_v
        (3,) m
    """
    w, dw, d = (np.ascontiguousarray(x, np.float64) for x in (w_v, dw_v, d_v))
    difference = np.empty_like(w)
    _kernel.rivals_all(w, dw, d, difference)
    moved: Floats = np.asarray(a_v, np.float64) + difference
    return moved
