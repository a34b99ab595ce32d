"""Constant errors of an accelerometer and their correction (thesis B.5): reading = A f_s + offset.

A holds three gains and, symmetric, three cross gains, because the axes of a chip are not quite perpendicular. (B.5)
prints the last cross gain as alpha_yx where it has to be alpha_yz. How A is found: `core.accelerometer_calibration`.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

GAIN_RANGE = (0.8, 1.2)
"""Gains outside it are no error of a sensor but a wrong unit or a fault."""
MAX_CROSS_GAIN = 0.2
"""Axes further from perpendicular are no axes; with `GAIN_RANGE` it keeps A positive definite (Gershgorin)."""
MAX_OFFSET = 3.0
"""m/s2, per axis"""
MAX_ASYMMETRY = 1e-6
"""Largest difference of two cross gains that is taken for rounding."""


class CalibrationError(ValueError):
    """An accelerometer cannot be calibrated so; the message is a sentence that says why."""


class AccelerometerCalibration(NamedTuple):
    """What turns the readings of one accelerometer into specific force."""

    gain: Floats
    """(3, 3) symmetric, no unit: A of (B.5), sensor axes"""
    offset: Floats
    """(3,) m/s2, what the axes read at zero specific force"""


def apply(calibration: AccelerometerCalibration, reading: Floats) -> Floats:
    """Give the specific force behind readings (thesis B.5 solved for it).

    Parameters
    ----------
    calibration
        of the accelerometer that read
    reading
        (..., 3) m/s2, sensor axes

    Returns
    -------
    Floats
        (..., 3) m/s2, f_s = A^-1 (reading - offset), sensor axes
    """
    corrected: Floats = (reading - calibration.offset) @ np.linalg.inv(calibration.gain).T
    return np.ascontiguousarray(corrected)


def check(calibration: AccelerometerCalibration) -> None:
    """Refuse a calibration that no accelerometer can have.

    Parameters
    ----------
    calibration
        gain (3, 3) and offset (3,), m/s2

    Raises
    ------
    CalibrationError
        not finite, not symmetric, or out of range
    """
    gain, offset = calibration
    if not (np.isfinite(gain).all() and np.isfinite(offset).all()):
        raise CalibrationError("A gain or an offset is not a finite number.")
    if np.abs(gain - gain.T).max() > MAX_ASYMMETRY:
        raise CalibrationError("The gain matrix is not symmetric.")
    low, high = GAIN_RANGE
    if ((np.diag(gain) < low) | (np.diag(gain) > high)).any():
        raise CalibrationError(f"The gains are {_list(np.diag(gain))}: expected {low} to {high}.")
    cross = gain[[0, 0, 1], [1, 2, 2]]
    if (np.abs(cross) >= MAX_CROSS_GAIN).any():
        raise CalibrationError(f"The cross gains are {_list(cross)}: expected less than {MAX_CROSS_GAIN}.")
    if (np.abs(offset) >= MAX_OFFSET).any():
        raise CalibrationError(f"The offsets are {_list(offset)} m/s2: expected less than {MAX_OFFSET}.")


def _list(values: Floats) -> str:
    return ", ".join(f"{value:.4g}" for value in values)
