import numpy as np
import pytest
from numpy.typing import NDArray

from core.attitude import CharacteriseError, characterise
from core.attitude.characterise import FLICKER, allan_deviation

Floats = NDArray[np.float64]
STEP = 0.01
N = 60_000


def times(n: int = N) -> Floats:
    t: Floats = np.arange(n, dtype=np.float64) * STEP
    return t


def white(seed: int = 0, n: int = N) -> Floats:
    noise: Floats = np.random.default_rng(seed).normal(size=(n, 3)) * np.array([1.0, 2.0, 4.0])
    return noise


def test_means_and_variances_are_those_of_the_readings() -> None:
    found = characterise(times(), white() + np.array([0.1, -0.2, 0.3]))
    np.testing.assert_allclose(found.mean, [0.1, -0.2, 0.3], atol=0.07)
    np.testing.assert_allclose(found.variance, [1.0, 4.0, 16.0], rtol=0.03)
    assert found.rate == pytest.approx(100.0)
    assert found.seconds == pytest.approx(STEP * (N - 1))


def test_white_noise_has_the_density_it_was_made_with() -> None:
    found = characterise(times(), white())
    np.testing.assert_allclose(found.noise_density, np.sqrt(STEP) * np.array([1.0, 2.0, 4.0]), rtol=0.05)
    assert np.isnan(found.random_walk).all()


def test_a_random_walk_of_the_bias_is_found() -> None:
    walk = np.cumsum(white(1), axis=0) * 0.05 * np.sqrt(STEP)
    found = characterise(times(), walk)
    np.testing.assert_allclose(found.random_walk, 0.05 * np.array([1.0, 2.0, 4.0]), rtol=0.2)


def test_flicker_noise_gives_its_size() -> None:
    """Noise of the spectrum B^2 / (2 pi f) has the Allan deviation 0.664 B, level."""
    frequency = np.fft.rfftfreq(N, STEP)[1:]
    rng = np.random.default_rng(3)
    phases = np.exp(2j * np.pi * rng.random((frequency.size, 1)))
    size = np.sqrt(1 / (2 * np.pi * frequency) * N / (2 * STEP))[:, None]
    series = np.fft.irfft(np.concatenate([[[0.0]], size * phases]) * np.sqrt(2), N, axis=0) / np.sqrt(2)
    found = allan_deviation(series, STEP)
    middle = (found.tau > 0.2) & (found.tau < 10)
    np.testing.assert_allclose(found.deviation[middle] / FLICKER, 1 / np.sqrt(2), rtol=0.25)


def test_drift_is_the_slope() -> None:
    found = characterise(times(), 1e-6 * white() + np.outer(times(), [1e-3, 0.0, -2e-3]))
    np.testing.assert_allclose(found.drift, [1e-3, 0.0, -2e-3], atol=1e-8)


def test_allan_deviation_is_that_of_the_definition() -> None:
    values = white(4, 300)
    found = allan_deviation(values, STEP)
    for tau, deviation in zip(found.tau, found.deviation, strict=True):
        m = round(tau / STEP)
        means = np.stack([values[k : k + m].mean(axis=0) for k in range(300 - m + 1)])
        np.testing.assert_allclose(deviation, np.sqrt(0.5 * np.mean((means[m:] - means[:-m]) ** 2, axis=0)), rtol=1e-9)


def test_only_the_longest_part_without_gaps_counts() -> None:
    t, values = times(3000), white(5, 3000)
    t[1000:] += 5.0
    values[1200] = np.nan
    found = characterise(t, values)
    assert found.seconds == pytest.approx(STEP * 1798)
    np.testing.assert_allclose(found.mean, values[1201:].mean(axis=0))


def test_readings_that_never_change_have_no_noise() -> None:
    found = characterise(times(1000), np.ones((1000, 3)))
    assert np.isnan(found.noise_density).all()
    np.testing.assert_array_equal(found.variance, 0.0)


@pytest.mark.parametrize("values", [np.ones((50, 3)), np.full((500, 3), np.nan)])
def test_too_little_is_refused(values: Floats) -> None:
    with pytest.raises(CharacteriseError, match="at least 100"):
        characterise(times(len(values)), values)
