"""Static initialisation (seed 004, "procedimento di autoapprendimento"): roll and pitch of a device from gravity.

The vehicle stands on level ground; the mean specific force, turned into the vehicle's axes, is to be (0, 0, +g). Its
yaw does not change that force: it is not observable at standstill, and is taken from the mounting known before.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import OptimizeResult, least_squares

from core import quaternion
from core.motion.vehicle import STANDARD_GRAVITY

Floats = NDArray[np.float64]

LEVEL = np.array([0.0, 0.0, STANDARD_GRAVITY])
STARTS = ((0.0, 0.0), (2.5, 0.3), (-1.5, -0.3), (1.5, 0.3))
"""rad, roll and pitch from which the optimisation begins, none of them opposite to all minima"""
EQUAL = 1e-12
"""(m/s2)2, difference of objectives that is none"""


class StaticStart(NamedTuple):
    """Outcome of the optimisation."""

    q_vs: Floats
    """(4,) mounting"""
    angles: tuple[float, float, float]
    """roll, pitch, yaw, rad, intrinsic z-y'-x''"""
    yaw_known: bool
    """False: no mounting was given, and yaw is zero for want of anything better"""
    objective: float
    """m/s2, |R f - (0, 0, g)|: what no rotation explains, the accelerometer's own error"""
    reason: str
    """why the optimisation ended, in its own words"""


def static_start(f_s: ArrayLike, mounting: ArrayLike | None = None) -> StaticStart:
    """Find the Euler angles that minimise |R f - (0, 0, g)| for the mean of `f_s` (N, 3), m/s2, at standstill.

    Parameters
    ----------
    f_s
        readings while the vehicle stood on level ground
    mounting
        (4,) q_vs known before, such as the confirmed one; its yaw is kept
    """
    mean = np.mean(np.reshape(np.asarray(f_s, np.float64), (-1, 3)), axis=0)
    roll, pitch, yaw = (0.0, 0.0, 0.0) if mounting is None else quaternion.angles(np.asarray(mounting))
    found = [_optimise(mean, np.array([*start, yaw])) for start in ((roll, pitch), *STARTS)]
    least = min(float(result.cost) for result in found)
    best = next(result for result in found if result.cost < least + EQUAL)  # the first: near the mounting
    q_vs = quaternion.from_angles(float(best.x[0]), float(best.x[1]), yaw)  # where the optimum leaves yaw means nothing
    return StaticStart(
        q_vs, quaternion.angles(q_vs), mounting is not None, float(np.sqrt(2 * best.cost)), str(best.message)
    )


def _optimise(mean: Floats, angles: Floats) -> OptimizeResult:
    def error(x: Floats) -> Floats:
        difference: Floats = quaternion.rotate(quaternion.from_angles(*x), mean) - LEVEL
        return difference

    return least_squares(error, angles, xtol=1e-14, ftol=1e-14, gtol=1e-14)
