"""Stated sigma against true error, from the first estimate on."""

import numpy as np
import pytest

from core.quaternion import conjugate, multiply, rotation_vector
from core.simulation import Scenario, simulate
from tests.core.drives import Floats, run

DRIVES = [
    Scenario(route=route, seconds=120.0, seed=seed, imu_rate=50.0, sensor=sensor)
    for route in ("city", "straight", "motorway", "hills")
    for seed, sensor in ((50, "mems"), (51, "tmd2"), (52, "mems"))
]


def normalised_errors(scenario: Scenario) -> Floats:
    """Normalised error squared of every reported estimate of a drive; 3 on average where the sigmas are right."""
    drive = simulate(scenario)
    _, outcome = run(drive.samples)
    error = rotation_vector(multiply(outcome.estimates.quaternion, conjugate(drive.truth.q_vs)))
    squares: Floats = ((error / outcome.estimates.sigma) ** 2).sum(axis=1)
    return squares


@pytest.mark.compiled
def test_early_estimates_are_as_good_as_they_say() -> None:
    squares = [normalised_errors(scenario) for scenario in DRIVES]
    assert sum(series.size > 0 for series in squares) >= 11
    assert np.mean([series.mean() for series in squares if series.size]) < 2 * 3
    assert max(series.max() for series in squares if series.size) < 7**2
