import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from core import AccelerometerCalibration, CalibrationError
from core.accelerometer import apply, check
from tests.core.poses import NINE, random_calibration, readings


@given(st.integers(0, 2**32 - 1))
def test_a_correction_undoes_the_errors(seed: int) -> None:
    generator = np.random.default_rng(seed)
    calibration = random_calibration(generator)
    f_s = 20 * generator.normal(size=(5, 3))
    np.testing.assert_allclose(apply(calibration, f_s @ calibration.gain.T + calibration.offset), f_s, atol=1e-12)
    np.testing.assert_allclose(apply(calibration, f_s[0]), apply(calibration, f_s)[0])


def test_gravity_is_as_long_as_it_should_be_after_the_correction() -> None:
    calibration = random_calibration(np.random.default_rng(1))
    raw = readings(calibration, NINE)
    assert np.ptp(np.linalg.norm(raw, axis=1)) > 0.1
    np.testing.assert_allclose(np.linalg.norm(apply(calibration, raw), axis=1), 9.80665)


def test_the_estimator_gets_arrays_as_it_needs_them() -> None:
    corrected = apply(random_calibration(np.random.default_rng(2)), np.ones((7, 3)))
    assert corrected.flags.c_contiguous
    assert corrected.dtype == np.float64


def test_no_samples_stay_no_samples() -> None:
    assert apply(AccelerometerCalibration(np.eye(3), np.zeros(3)), np.empty((0, 3))).shape == (0, 3)


def changed(row: int, column: int, value: float) -> np.ndarray:
    gain = np.eye(3)
    gain[row, column] = value
    return gain


@pytest.mark.parametrize(
    ("gain", "offset", "words"),
    [
        (changed(0, 0, 0.79), [0, 0, 0], "gains are 0.79, 1, 1: expected 0.8 to 1.2"),
        (changed(1, 1, 1.21), [0, 0, 0], "gains"),
        (-np.eye(3), [0, 0, 0], "gains"),
        (changed(0, 1, 0.01), [0, 0, 0], "symmetric"),
        (np.eye(3) + 0.2 * (1 - np.eye(3)), [0, 0, 0], "cross gains are 0.2, 0.2, 0.2"),
        (np.eye(3), [0, -3, 0], "offsets are 0, -3, 0 m/s2"),
        (changed(2, 2, np.nan), [0, 0, 0], "finite"),
        (np.eye(3), [0, np.inf, 0], "finite"),
    ],
)
def test_what_no_accelerometer_has_is_refused(gain: np.ndarray, offset: list[float], words: str) -> None:
    with pytest.raises(CalibrationError, match=words):
        check(AccelerometerCalibration(gain, np.array(offset, float)))


def test_what_is_just_possible_is_taken() -> None:
    check(AccelerometerCalibration(np.diag([0.8, 1.2, 1.0]) + 0.19 * (1 - np.eye(3)), np.array([2.9, -2.9, 0])))
