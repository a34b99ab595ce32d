"""Every Jacobian of the filter against finite differences."""

import numpy as np
import pytest
from numpy.typing import NDArray

from core import DEFAULT, THESIS, Parameters, _kernel
from core.params import as_record
from core.quaternion import conjugate, from_angles, multiply, random, rotation_vector
from core.state import FILTER

Floats = NDArray[np.float64]
STATES = _kernel.STATES
STEP = 1e-6
PARTS = (
    ("speed", 0, 1), ("acceleration", 1, 1), ("yaw_rate", 2, 1), ("yaw_rate_before", 3, 1), ("gradient", 4, 2),
    ("bias", 12, 3), ("lever_arm", 15, 2), ("altitude", 17, 1), ("latency", 18, 1), ("suspension", 19, 2),
    ("antenna", 21, 1), ("gyro_bias", 22, 3), ("bounce", 25, 2), ("bounce_before", 27, 2),
)  # fmt: skip
"""Parts of the state that add up: name, first index and size in the error state."""
ATTITUDE, MOUNTING = 6, 9


def random_filter(seed: int) -> NDArray[np.void]:
    generator = np.random.default_rng(seed)
    record = np.zeros(1, FILTER)
    record["speed"], record["acceleration"], record["yaw_rate"], record["yaw_rate_before"] = 12.0, 1.5, 0.3, 0.2
    record["q_nv"][0] = from_angles(*(generator.normal(size=3) * [0.1, 0.1, 2.0]).tolist())
    record["q_vs"][0] = random(generator)
    record["bias"][0], record["gyro_bias"][0] = generator.normal(size=(2, 3)) * 0.1
    record["gradient"][0], record["bounce"][0], record["bounce_before"][0] = generator.normal(size=(3, 2)) * 1e-3
    record["lever_arm"][0], record["suspension"][0] = [1.2, -0.4], [0.009, 0.007]
    record["last_forward"], record["last_lateral"] = 1.2, 2.0
    record["antenna"], record["latency"], record["altitude"], record["road_variance"] = 0.3, 0.4, 100.0, 1e-3
    return record


def work() -> np.void:
    scratch: np.void = np.zeros(1, _kernel.WORK)[0]
    return scratch


def random_epoch(seed: int) -> NDArray[np.void]:
    generator = np.random.default_rng(100 + seed)
    epoch = np.zeros(1, _kernel.EPOCH)
    epoch["period"], epoch["gyro"] = 0.5, True
    epoch["f_slope"][0], epoch["w_slope"][0] = generator.normal(size=(2, 3))
    return epoch


def predicted(params: Parameters, record: NDArray[np.void], turn: NDArray[np.void]) -> tuple[Floats, Floats]:
    """What the sensors would read, turned into the vehicle's axes as `turn` has them, and the Jacobian."""
    z, h = np.zeros(_kernel.MEASUREMENTS), np.zeros((_kernel.MEASUREMENTS, STATES))
    now, reference = np.zeros((3, 3)), np.zeros((3, 3))
    _kernel.rotation_matrix(record["q_vs"][0], now)
    _kernel.rotation_matrix(turn["q_vs"][0], reference)
    _kernel.predict_measurements(as_record(params)[0], record[0], EPOCHS[0], now, z, h, work())
    for first in (_kernel.FORCE, _kernel.RATE):
        z[first : first + 3] = reference @ now.T @ z[first : first + 3]
    return z, h


EPOCHS = random_epoch(0)


def perturbed(params: Parameters, record: NDArray[np.void], index: int, step: float) -> NDArray[np.void]:
    record, dx = record.copy(), np.zeros(STATES)
    dx[index] = step
    _kernel.fold(as_record(params)[0], record[0], dx, _kernel.STATES, work())
    return record


@pytest.mark.parametrize("params", [DEFAULT, THESIS], ids=["default", "thesis"])
def test_measurement_jacobian(params: Parameters) -> None:
    for seed in range(20):
        record = random_filter(seed)
        if params is THESIS:
            record["lever_arm"] = record["suspension"] = record["antenna"] = record["gradient"] = 0.0
        _, h = predicted(params, record, record)
        for index in range(STATES):
            if index == _kernel.LATENCY:
                continue  # stands for what is measured, below
            ends = (predicted(params, perturbed(params, record, index, s), record)[0] for s in (STEP, -STEP))
            ahead, behind = ends
            np.testing.assert_allclose(h[:, index], (ahead - behind) / (2 * STEP), atol=2e-6, err_msg=str(index))


def test_latency_column_is_the_change_of_the_signals_with_time() -> None:
    """A fix later by dt tells of an earlier moment: the signals are then too late by their slope times dt."""
    record = random_filter(3)
    _, h = predicted(DEFAULT, record, record)
    r_vs = np.zeros((3, 3))
    _kernel.rotation_matrix(record["q_vs"][0], r_vs)
    np.testing.assert_allclose(h[_kernel.FORCE : _kernel.FORCE + 3, _kernel.LATENCY], r_vs @ EPOCHS["f_slope"][0])
    np.testing.assert_allclose(h[_kernel.RATE : _kernel.RATE + 3, _kernel.LATENCY], r_vs @ EPOCHS["w_slope"][0])


def error_between(moved: NDArray[np.void], reference: NDArray[np.void]) -> Floats:
    """Error state that takes the reference to the moved filter."""
    dx = np.zeros(STATES)
    for name, first, size in PARTS:
        dx[first : first + size] = moved[name][0] - reference[name][0]
    q_nv, q_vs = (multiply(moved[n][0], conjugate(reference[n][0])) for n in ("q_nv", "q_vs"))
    dx[MOUNTING : MOUNTING + 3] = rotation_vector(q_vs)
    dx[ATTITUDE : ATTITUDE + 3] = rotation_vector(
        multiply(conjugate(reference["q_nv"][0]), multiply(q_nv, reference["q_nv"][0]))
    )
    return dx


@pytest.mark.parametrize("params", [DEFAULT, THESIS], ids=["default", "thesis"])
def test_transition_jacobian(params: Parameters) -> None:
    """F as applied to the covariance equals the derivative of the predicted state near level driving.

    The distance driven in the epoch is taken as known, so the road does not change with the error of the speed.
    """
    period, values = 0.25, as_record(params)[0]
    record = random_filter(1)
    record["gradient"] = 0.0
    _kernel.set_heading(record[0], 0.7)
    reference = record.copy()
    _kernel.predict(values, reference[0], period, STATES, work())
    for index in range(STATES):
        if index == _kernel.LATENCY and params is THESIS:
            continue  # the thesis knows of none
        ends = []
        for step in (STEP, -STEP):
            moved = perturbed(params, record, index, step)
            _kernel.predict(values, moved[0], period, STATES, work())
            ends.append(error_between(moved, reference))
        numeric = (ends[0] - ends[1]) / (2 * STEP)
        unit, noise = record.copy(), record.copy()
        unit["covariance"][0, index, index] = 1.0
        for filters in (unit, noise):
            _kernel.predict(values, filters[0], period, STATES, work())
        applied = unit["covariance"][0] - noise["covariance"][0]  # F e e' F'
        np.testing.assert_allclose(applied, np.outer(numeric, numeric), rtol=5e-3, atol=1e-5, err_msg=str(index))
