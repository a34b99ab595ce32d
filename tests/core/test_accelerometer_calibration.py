import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from core import CalibrationError, Samples
from core import accelerometer_calibration as calibrating
from core._kernel import GRAVITY
from core.accelerometer import apply
from core.accelerometer_calibration import REST_SIGMA, Fit, fit
from core.poses import Pose, find_poses
from tests.core.poses import NINE, UPRIGHT, directions, random_calibration, readings, recording

Floats = NDArray[np.float64]


def poses(reading: Floats, noise: float = 0.0) -> list[Pose]:
    return [Pose(row, noise, 3.0) for row in reading]


def errors(found: Fit, gain: Floats, offset: Floats) -> Floats:
    """(9,) errors of the parameters in their stated sigmas."""
    upper = np.triu_indices(3)
    return np.concatenate(
        [
            (found.calibration.gain - gain)[upper] / found.gain_sigma[upper],
            (found.calibration.offset - offset) / found.offset_sigma,
        ]
    )


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=50, deadline=None)
def test_any_calibration_is_recovered_exactly_without_noise(seed: int) -> None:
    generator = np.random.default_rng(seed)
    truth = random_calibration(generator)
    up = np.vstack([NINE, directions(generator, seed % 4)])
    found = fit(poses(readings(truth, up)))
    np.testing.assert_allclose(found.calibration.gain, truth.gain, atol=1e-6)
    np.testing.assert_allclose(found.calibration.offset, truth.offset, atol=1e-5)
    np.testing.assert_array_equal(found.calibration.gain, found.calibration.gain.T)
    assert found.rms < 1e-5 < found.rms_before
    assert found.pose_count == len(up)


def test_the_stated_sigmas_are_honest() -> None:
    generator = np.random.default_rng(3)
    normalised = []
    for _ in range(200):
        truth, noise = random_calibration(generator), generator.uniform(0.0, 0.03)
        up = np.vstack([NINE, directions(generator, int(generator.integers(0, 15)))])
        reading = readings(truth, up) + np.hypot(noise, REST_SIGMA) * generator.normal(size=up.shape)
        normalised.append(errors(fit(poses(reading, noise)), *truth))
    assert 0.85 < np.std(normalised) < 1.1
    assert np.abs(np.mean(normalised)) < 0.1
    assert np.abs(normalised).max() < 5


def test_poses_worse_than_their_noise_raise_the_sigmas() -> None:
    generator = np.random.default_rng(4)
    up = np.vstack([NINE, directions(generator, 30)])
    reading = readings(random_calibration(generator), up)
    calm = fit(poses(reading))
    rough = fit(poses(reading + 0.05 * generator.normal(size=up.shape)))
    assert 5 < np.median(rough.offset_sigma / calm.offset_sigma) < 20


def test_a_recording_of_nine_poses_is_enough() -> None:
    truth = random_calibration(np.random.default_rng(5))
    found = fit(find_poses([recording(readings(truth, NINE), noise=0.03)]))
    assert found.pose_count == 9
    assert np.abs(errors(found, *truth)).max() < 4
    other = readings(truth, directions(np.random.default_rng(6), 100))
    np.testing.assert_allclose(np.linalg.norm(apply(found.calibration, other), axis=1), GRAVITY, atol=0.05)
    assert np.ptp(np.linalg.norm(other, axis=1)) > 0.5


def test_the_jacobian_is_the_derivative_of_the_residuals() -> None:
    generator = np.random.default_rng(7)
    truth, sigma = random_calibration(generator), generator.uniform(0.1, 1, 12)
    p = np.concatenate([np.diag(truth.gain), truth.gain[[0, 0, 1], [1, 2, 2]], truth.offset])
    reading, step = readings(truth, directions(generator, 12)) + 0.1, 1e-6
    for column in range(9):
        change = np.zeros(9)
        change[column] = step
        forward, back = (calibrating._residuals(p + sign * change, reading, sigma) for sign in (1, -1))
        np.testing.assert_allclose(
            calibrating._jacobian(p, reading, sigma)[:, column], (forward - back) / (2 * step), rtol=1e-5, atol=1e-5
        )


# ---------------------------------------------------------------- refused, in words


@pytest.mark.parametrize(
    ("up", "words"),
    [
        (np.empty((0, 3)), "No pose was found in which the device lay still, 9 are needed"),
        (NINE[:1], "1 pose was found, 9 are needed"),
        (NINE[[0, 1, 2, 3, 4, 6, 7, 8]], "8 poses were found, 9 are needed.*also lie with its z axis down.$"),
        (UPRIGHT, "6 poses were found.*between its x and y axes; tilted half-way between its x and z axes;"),
    ],
)
def test_too_few_poses(up: Floats, words: str) -> None:
    with pytest.raises(CalibrationError, match=words):
        fit(poses(GRAVITY * up))


def test_poses_that_never_turn_the_device_over() -> None:
    up = directions(np.random.default_rng(8), 40)
    with pytest.raises(CalibrationError, match=r"40 poses are too much alike.*also lie with its z axis down.$"):
        fit(poses(GRAVITY * np.abs(up * [0, 0, 1]) + GRAVITY * up * [1, 1, 0]))


def test_poses_about_one_axis() -> None:
    angle = np.linspace(0, 2 * np.pi, 12, endpoint=False)
    ring = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(12)])
    with pytest.raises(CalibrationError, match=r"too much alike.*z axis up; with its z axis down; tilted"):
        fit(poses(GRAVITY * ring))


def test_poses_askew_leave_no_better_advice_than_more_of_them() -> None:
    askew = np.cos(np.radians(30)) * np.eye(3) + np.sin(np.radians(30)) * np.roll(np.eye(3), 1, axis=1)
    with pytest.raises(CalibrationError, match=r"^6 poses were found.*apart\. Add some in other directions\.$"):
        fit(poses(GRAVITY * np.vstack([askew, -askew])))


@pytest.mark.parametrize("scale", [0.7, 1.3])
def test_gains_of_another_unit(scale: float) -> None:
    with pytest.raises(CalibrationError, match="gains"):
        fit(poses(scale * GRAVITY * NINE))


def test_an_axis_that_is_dead() -> None:
    up = directions(np.random.default_rng(9), 60)
    with pytest.raises(CalibrationError):
        fit(poses(GRAVITY * up * [1, 1, 0]))


def test_readings_that_follow_no_model() -> None:
    up = directions(np.random.default_rng(10), 60)
    bent = GRAVITY * up * (1 + 0.1 * np.sign(up[:, :1]) * np.abs(up[:, 1:2]))
    with pytest.raises(CalibrationError, match=r"miss gravity by 0\.\d\d m/s2 even after"):
        fit(poses(bent))


def test_a_drive_is_no_calibration() -> None:
    generator = np.random.default_rng(11)
    manoeuvres = np.repeat(generator.normal(size=(60, 3)), 50, axis=0)
    f_s = manoeuvres + generator.normal(size=(3000, 3)) + np.array([0, 0, GRAVITY])
    with pytest.raises(CalibrationError, match="needed"):
        fit(find_poses([Samples.make(np.arange(3000) / 50, f_s)]))
