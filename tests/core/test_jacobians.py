"""Every Jacobian of the filter against finite differences."""

import numpy as np
from numpy.typing import NDArray

from core import _kernel
from core.params import DEFAULT, as_record
from core.quaternion import random
from core.state import FILTER, STATES

Floats = NDArray[np.float64]
STEP = 1e-6


def random_filter(seed: int) -> NDArray[np.void]:
    generator = np.random.default_rng(seed)
    record = np.zeros(1, FILTER)
    record["speed"], record["acceleration"], record["yaw_rate"] = 12.0, 1.5, 0.3
    record["q_nv"][0], record["q_vs"][0] = random(generator), random(generator)
    record["bias"][0], record["gyro_bias"][0] = generator.normal(size=(2, 3)) * 0.1
    return record


def predicted(record: NDArray[np.void]) -> tuple[Floats, Floats]:
    z, h = np.zeros(_kernel.MEASUREMENTS), np.zeros((_kernel.MEASUREMENTS, STATES))
    _kernel.predict_measurements(record[0], z, h)
    return z, h


def perturbed(record: NDArray[np.void], index: int, step: float) -> NDArray[np.void]:
    record, dx = record.copy(), np.zeros(STATES)
    dx[index] = step
    _kernel.fold(record[0], dx)
    return record


def test_measurement_jacobian() -> None:
    for seed in range(20):
        record = random_filter(seed)
        _, h = predicted(record)
        for index in range(STATES):
            ahead, behind = (predicted(perturbed(record, index, s))[0] for s in (STEP, -STEP))
            np.testing.assert_allclose(h[:, index], (ahead - behind) / (2 * STEP), atol=1e-6, err_msg=str(index))


def error_between(moved: NDArray[np.void], reference: NDArray[np.void]) -> Floats:
    """Error state that takes the reference to the moved filter."""
    dx = np.zeros(STATES)
    for i, name in enumerate(("speed", "acceleration", "yaw_rate")):
        dx[i] = moved[name][0] - reference[name][0]
    _kernel.difference(moved["q_nv"][0], reference["q_nv"][0], dx[3:6])
    _kernel.difference(moved["q_vs"][0], reference["q_vs"][0], dx[6:9])
    dx[9:12] = moved["bias"][0] - reference["bias"][0]
    dx[12:] = moved["gyro_bias"][0] - reference["gyro_bias"][0]
    return dx


def test_transition_jacobian() -> None:
    """F as applied to the covariance equals the derivative of the predicted state near level driving."""
    params = as_record(DEFAULT)
    period = 0.25
    record = random_filter(1)
    _kernel.set_heading(record[0], 0.7)
    reference = record.copy()
    _kernel.predict(params[0], reference[0], period)
    for index in range(STATES):
        ends = []
        for step in (STEP, -STEP):
            moved = perturbed(record, index, step)
            _kernel.predict(params[0], moved[0], period)
            ends.append(error_between(moved, reference))
        numeric = (ends[0] - ends[1]) / (2 * STEP)
        unit = record.copy()
        unit["covariance"][0, index, index] = 1.0
        noise = record.copy()
        for filters in (unit, noise):
            _kernel.predict(params[0], filters[0], period)
        applied = unit["covariance"][0] - noise["covariance"][0]  # F e e' F'
        np.testing.assert_allclose(applied, np.outer(numeric, numeric), rtol=5e-3, atol=2e-6, err_msg=str(index))
