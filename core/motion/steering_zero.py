"""When the steering wheel is straight, and when a film began: from the yaw rate of the drive."""

import numpy as np
from scipy.optimize import least_squares

from core.motion.steering_terms import Floats
from core.samples import SPEED, Samples

LEAST_SECONDS = 20.0
"""s of driving that show it"""
LARGEST_ANGLE = np.radians(120.0)
"""rad from the median beyond which the angle is no longer in proportion to the curvature"""
LARGEST_YAW_RATE = 0.25
"""rad/s"""


def speed_at(samples: Samples, t: Floats) -> Floats:
    """(N,) m/s over ground at times within the fixes, nan elsewhere and where the receiver gives none."""
    there = samples.t[samples.fix_row]
    speed = samples.fix[:, SPEED]
    usable = samples.fix_valid & np.isfinite(speed)
    if usable.sum() < 2:
        return np.full(t.size, np.nan)
    return np.interp(t, there[usable], speed[usable], left=np.nan, right=np.nan)


def yaw_rate(f_s: Floats, w_s: Floats) -> Floats:
    """(N,) rad/s about the vertical, to the left, of a device at any attitude; the mean specific force shows it."""
    up = np.nanmean(f_s, axis=0)
    rate: Floats = w_s @ (up / np.linalg.norm(up))
    return rate


def straight_angle(
    angle: Floats, yaw: Floats, speed: Floats, step: float, least_speed: float
) -> tuple[float, float] | None:
    """Angle (rad) at which the vehicle goes straight on, and its 1 sigma; None when the drive does not show it.

    angle = zero + a yaw/v + b yaw v: the bend's curvature, and the understeer that grows with the lateral acceleration.
    """
    with np.errstate(invalid="ignore"):
        used = (speed > least_speed) & (np.abs(yaw) < LARGEST_YAW_RATE) & np.isfinite(angle)
        used &= np.abs(angle - np.median(angle[used]) if used.any() else angle) < LARGEST_ANGLE
    thin = np.flatnonzero(used)[:: max(round(0.2 / step), 1)]
    if used.sum() * step < LEAST_SECONDS:
        return None
    columns = np.stack([np.ones(thin.size), yaw[thin] / speed[thin], yaw[thin] * speed[thin] / 400.0], axis=-1)
    fit = least_squares(_line_misfit, np.zeros(3), loss="soft_l1", f_scale=np.radians(3.0), args=(columns, angle[thin]))
    scatter = 1.5 * np.median(np.abs(columns @ fit.x - angle[thin]))
    alike = 5.0  # s over which neighbouring residuals are alike: the driver's corrections, banks of the road
    covariance = np.linalg.inv(columns.T @ columns) * scatter**2 * max(alike / 0.2, 1.0)
    return float(fit.x[0]), float(np.sqrt(covariance[0, 0]))


def _line_misfit(p: Floats, columns: Floats, angle: Floats) -> Floats:
    misfit: Floats = columns @ p - angle
    return misfit
