"""When the steering wheel is straight, and when a film began: from the yaw rate of the drive."""

import numpy as np
from scipy.optimize import least_squares

from core.motion.steering_clocks import averages, even_raster
from core.motion.steering_terms import Booleans, Floats, Steering, SteeringError
from core.samples import SPEED, Samples

LEAST_SECONDS = 20.0
"""s of driving that show it"""
LARGEST_ANGLE = np.radians(120.0)
"""rad from the median beyond which the angle is no longer in proportion to the curvature"""
LARGEST_YAW_RATE = 0.25
"""rad/s"""
START_RATE = 20.0
"""Hz at which a film is held against a log"""
START_SPEED = 3.0
"""m/s beyond which the yaw rate shows the steering"""
LEAST_AGREEMENT = 0.6
"""correlation of angle and curvature"""


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


def find_start(samples: Samples, steering: Steering) -> float:
    """Find when a film began on the clock of a log, s: where the yaw rate goes with steering angle times speed.

    Raises
    ------
    SteeringError
        the log has no gyroscope or no speeds, or it does not go with the film.
    """
    raster = even_raster(samples.t, START_RATE)
    yaw = yaw_rate(*(averages(samples.t, x, raster) for x in (samples.f_s, samples.w_s)))
    speed = np.nan_to_num(speed_at(samples, raster))
    known = np.isfinite(steering.angle)
    if not np.isfinite(yaw).any() or not speed.any() or known.sum() < 2:
        raise SteeringError("The log shows no yaw rate or no speed, by which the film's start could be found.")
    film = np.arange(steering.t[0], steering.t[-1], 1 / START_RATE)
    angle = np.interp(film, steering.t[known], steering.angle[known])
    # curvature where the vehicle moves; elsewhere it says nothing
    moving = speed > START_SPEED
    curvature = np.where(moving, np.nan_to_num(yaw) / np.maximum(speed, START_SPEED), 0.0)
    value = [_agreement(angle, curvature[k : k + film.size], moving[k : k + film.size]) for k in _lags(raster, film)]
    if not value or max(value) < LEAST_AGREEMENT:
        raise SteeringError("The film does not go with the log: say when it began with --video-start.")
    return float(raster[int(np.argmax(value))] - steering.t[0])


def _lags(raster: Floats, film: Floats) -> range:
    return range(max(raster.size - film.size + 1, 0))


def _agreement(angle: Floats, curvature: Floats, moving: Booleans) -> float:
    """Correlation of angle and curvature while the vehicle moves."""
    if moving.sum() < max(LEAST_SECONDS * START_RATE / 2, 0.3 * moving.size):
        return -1.0
    a, c = angle[moving], curvature[moving]
    a, c = a - a.mean(), c - c.mean()
    return float(a @ c / max(float(np.linalg.norm(a) * np.linalg.norm(c)), 1e-12))
