"""Position and velocity through GPS outages, and how honestly their uncertainty grows."""

from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest

from core.motion import VEHICLES, Motion, reconstruct
from core.simulation_handling import HandlingDrive, HandlingScenario, simulate_handling

pytestmark = pytest.mark.compiled

OUTAGE = (45.0, 75.0)


@lru_cache
def bridged(manoeuvre: str, seed: int) -> tuple[HandlingDrive, Motion]:
    scenario = HandlingScenario(manoeuvre, "nonlinear", 0.4, seconds=85.0, seed=seed, outages=(OUTAGE,))
    drive = simulate_handling(scenario)
    vehicle = replace(VEHICLES["sedan"], device=drive.truth.device)
    return drive, reconstruct(vehicle, drive.truth.q_vs, drive.samples)


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("manoeuvre", ["double_lane_change", "constant_radius", "slalom"])
def test_errors_stay_within_three_sigma(manoeuvre: str, seed: int) -> None:
    drive, motion = bridged(manoeuvre, seed)
    truth, known = drive.truth.at(motion.t), np.isfinite(motion.position_sigma)
    position = np.abs(motion.position_n - truth.position_n)[known, :2] / motion.position_sigma[known, None]
    outage = (motion.t > OUTAGE[0]) & (motion.t < OUTAGE[1])
    velocity = np.abs(motion.velocity_v - truth.velocity_v[:, :2])[outage] / motion.velocity_sigma[outage]
    slip = np.abs(motion.sideslip - truth.sideslip)[outage] / motion.sideslip_sigma[outage]
    assert position.max() < 3.0
    assert velocity.max() < 3.5
    assert slip.max() < 3.5


def test_uncertainty_grows_and_shrinks_again() -> None:
    _, motion = bridged("slalom", 1)
    before, during, after = (float(motion.position_sigma[np.searchsorted(motion.t, t)]) for t in (44.0, 74.0, 84.0))
    assert during > 1.3 * before
    assert after < during
    outage = (motion.t > OUTAGE[0] + 1) & (motion.t < OUTAGE[1])
    assert (np.diff(motion.position_sigma[outage][::250]) > 0.0).all()


def test_rows_say_that_they_are_dead_reckoned() -> None:
    _, motion = bridged("slalom", 1)
    outage = (motion.t > OUTAGE[0] + 0.5) & (motion.t < OUTAGE[1] - 0.1)
    assert motion.dead_reckoned[outage].all()
    assert not motion.dead_reckoned[(motion.t > 10) & (motion.t < OUTAGE[0])].any()
    assert not motion.dead_reckoned[motion.t > OUTAGE[1] + 0.5].any()


def test_half_a_minute_costs_few_metres() -> None:
    """480 m are driven; a constant velocity would miss the slalom's end by more than that of its last direction."""
    drive, motion = bridged("slalom", 2)
    end = np.searchsorted(motion.t, OUTAGE[1] - 0.1)
    error = motion.position_n[end] - drive.truth.at(motion.t[end : end + 1]).position_n[0]
    assert np.hypot(*error[:2]) < 20.0
