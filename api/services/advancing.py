"""The estimator's work on a chunk: on samples less the accelerometer's errors, where they are known."""

from dataclasses import replace
from typing import Any

import numpy as np

import core
from api import metrics

Correction = dict[str, Any] | None
"""Calibration of a device's accelerometer, as it is stored."""


def advance(
    params: core.Parameters, correction: Correction, state: core.State, samples: core.Samples
) -> tuple[core.State, core.Outcome]:
    """Advance by samples, less the accelerometer's errors where they are known; what is left of its bias is small."""
    if correction is not None:
        params = core.calibrated(params)
    with metrics.estimator():
        return core.advance(params, state, corrected(correction, samples))


def corrected(correction: Correction, samples: core.Samples) -> core.Samples:
    """Give samples less the accelerometer's errors, where they are known."""
    if correction is None:
        return samples
    calibration = core.AccelerometerCalibration(np.array(correction["gain"]), np.array(correction["offset"]))
    return replace(samples, f_s=core.accelerometer.apply(calibration, samples.f_s))
