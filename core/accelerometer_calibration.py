"""Calibration of an accelerometer from poses in which it lies still (thesis B.3).

At rest an accelerometer reads gravity and nothing else, however it lies: |f_s| = g in every pose. The nine parameters
of `reading = A f_s + offset` (B.5) are those for which that holds best,

    e = g^2 - |A^-1 (reading - offset)|^2                                                                   (B.7)

by the method of Levenberg and Marquardt from A = 1, offset = 0, each e divided by its sigma. Nine parameters need nine
poses.

Slips in print: in (B.5) the last cross gain is alpha_yz, not alpha_yx; (B.8) has alpha_xy twice, once as alpha_yx, and
leaves out alpha_xz; (A^-1)^2 in (B.7) holds because A is symmetric, in general it is A^-T A^-1.

What poses cannot show: (B.7) knows A only by its square, so that a mirrored axis looks like a sound one (A is taken
positive definite); and a turn of all axes together changes no |f_s|. Gains are relative to standard gravity: where it
is stronger or weaker, by 0.3 % at most, they take that up.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from core._kernel import GRAVITY
from core.accelerometer import AccelerometerCalibration, CalibrationError, apply, check
from core.poses import PAIRS, Pose, missing, stack

Floats = NDArray[np.float64]

PARAMETERS = 9
REST_SIGMA = 0.005
"""m/s2, 1 sigma of a pose's mean beside its noise: tables tremble and sensors drift"""
MIN_SPREAD = 0.06
"""smallest singular value of what the directions say of the parameters: 0.20 of each axis up, each down and between
each two, about 0.05 when an axis never points down"""
MAX_RMS = 0.2
"""m/s2 by which |f_s| may still miss gravity, root mean square over the poses"""


class Fit(NamedTuple):
    """A calibration, and how good it is."""

    calibration: AccelerometerCalibration
    gain_sigma: Floats
    """(3, 3) 1 sigma of the gain matrix"""
    offset_sigma: Floats
    """(3,) m/s2, 1 sigma"""
    rms_before: float
    """m/s2, root mean square of |reading| - g over the poses"""
    rms: float
    """m/s2, root mean square of |f_s| - g: what the calibration leaves"""
    pose_count: int


def fit(poses: Sequence[Pose]) -> Fit:
    """Calibrate an accelerometer (thesis B.9).

    Parameters
    ----------
    poses
        of one accelerometer, as `core.poses.find_poses` gives them; nine at least, spread over the sphere

    Returns
    -------
    Fit
        the gain matrix has no unit, offsets are in m/s2, sensor axes

    Raises
    ------
    CalibrationError
        too few poses, or too much alike; they do not follow the model; or its parameters are not of this world
    """
    reading, noise = stack(poses)
    _require_spread(reading)
    sigma = 2 * GRAVITY * np.hypot(noise, REST_SIGMA)
    try:
        solution = least_squares(_residuals, _start(), _jacobian, method="lm", args=(reading, sigma))
    except np.linalg.LinAlgError:
        solution = None
    if solution is None or not solution.success:
        raise CalibrationError("The fit did not converge: the readings do not look like gravity in various poses.")
    calibration = unpack(solution.x)
    check(calibration)
    rms = _miss(apply(calibration, reading))
    if rms > MAX_RMS:
        raise CalibrationError(
            f"The readings miss gravity by {rms:.2f} m/s2 even after the calibration: an axis is faulty, or it moved."
        )
    gain_sigma, offset_sigma = _sigmas(solution.x, reading, sigma)
    return Fit(calibration, gain_sigma, offset_sigma, _miss(reading), rms, len(poses))


def unpack(p: Floats) -> AccelerometerCalibration:
    """Give the calibration of parameters (9,): gains x, y, z, cross gains xy, xz, yz, offsets (B.8, put right)."""
    return AccelerometerCalibration(_symmetric(p[:6]), p[6:].copy())


def _symmetric(values: Floats) -> Floats:
    matrix = np.diag(values[:3])
    for (i, j), value in zip(PAIRS, values[3:6], strict=True):
        matrix[i, j] = matrix[j, i] = value
    return matrix


def _start() -> Floats:
    return np.concatenate([np.ones(3), np.zeros(6)])


def _residuals(p: Floats, reading: Floats, sigma: Floats) -> Floats:
    """(P,) e of (B.7) in its sigmas."""
    squares: Floats = (apply(unpack(p), reading) ** 2).sum(axis=1)
    return (GRAVITY**2 - squares) / sigma


def _jacobian(p: Floats, reading: Floats, sigma: Floats) -> Floats:
    """(P, 9) derivative of `_residuals`: de = 2 w' (dA f + d offset) with w = A^-T f."""
    f_s = apply(unpack(p), reading)
    w = np.linalg.solve(unpack(p).gain.T, f_s.T).T
    cross = [w[:, i] * f_s[:, j] + w[:, j] * f_s[:, i] for i, j in PAIRS]
    return 2 * np.column_stack([w * f_s, *cross, w]) / sigma[:, None]


def _sigmas(p: Floats, reading: Floats, sigma: Floats) -> tuple[Floats, Floats]:
    """Give the sigmas of gain (3, 3) and offset (3,), raised when the poses scatter more than their noise."""
    jacobian = _jacobian(p, reading, sigma)
    surplus = len(reading) - PARAMETERS
    excess = max(1.0, float((_residuals(p, reading, sigma) ** 2).sum()) / surplus) if surplus else 1.0
    deviations = np.sqrt(excess * np.diag(np.linalg.inv(jacobian.T @ jacobian)))
    return _symmetric(deviations[:6]), deviations[6:]


def _miss(f_s: Floats) -> float:
    return float(np.sqrt(((np.linalg.norm(f_s, axis=1) - GRAVITY) ** 2).mean()))


def _require_spread(reading: Floats) -> None:
    """Refuse poses that cannot tell nine parameters, and say which ones would."""
    wanted = missing(reading)
    advice = f" Let the device also lie {'; '.join(wanted)}." if wanted else " Add some in other directions."
    if len(reading) < PARAMETERS:
        found = {0: "No pose was found in which the device lay still", 1: "1 pose was found"}
        counted = found.get(len(reading), f"{len(reading)} poses were found")
        raise CalibrationError(f"{counted}, {PARAMETERS} are needed, at least 10 degrees apart.{advice}")
    direction = reading / np.linalg.norm(reading, axis=1, keepdims=True)
    ones = np.full(len(reading), np.sqrt(len(reading)))
    said = _jacobian(_start(), direction, 2 * ones)
    if np.linalg.svd(said, compute_uv=False)[-1] < MIN_SPREAD:
        raise CalibrationError(f"The {len(reading)} poses are too much alike to calibrate every axis.{advice}")
