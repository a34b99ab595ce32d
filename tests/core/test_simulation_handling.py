"""The handling simulation against what theory says, so that it may judge the reconstruction."""

from dataclasses import replace

import numpy as np
import pytest

from core import quaternion
from core.motion import VEHICLES
from core.simulation_handling import MANOEUVRES, MANOEUVRES_BEGIN, HandlingScenario, simulate_handling
from core.simulation_handling_models import MODELS, Planar, steady_steer, step

SEDAN = VEHICLES["sedan"]
STILL = replace(SEDAN, device=(0.0, 0.0, 0.0))


def settled(model: str, u: float, ay: float) -> Planar:
    """State after 6 s with the steering of a steady turn, at constant speed."""
    state = Planar(0.0, 0.0, 0.0, u, 0.0, 0.0)
    wheel = steady_steer(SEDAN, u, ay)
    for _ in range(600):
        state = step(MODELS[model], SEDAN, state, wheel, 0.8 * (u - state.u) - state.v * state.r, 0.0, 0.01)
    return state


@pytest.mark.parametrize("model", MODELS)
def test_a_gentle_steady_turn_is_that_of_the_textbook(model: str) -> None:
    u, ay = 20.0, 1.0
    state = settled(model, u, ay)
    slip = SEDAN.a2 / u - SEDAN.mass * SEDAN.a1 * u / (SEDAN.cornering_stiffness_2 * SEDAN.wheelbase)
    assert state.u * state.r == pytest.approx(ay, rel=0.03)
    assert state.v / state.u == pytest.approx(slip * state.r, abs=2e-4)


def test_tyres_saturate_where_the_linear_ones_do_not() -> None:
    reached = {model: settled(model, 20.0, 9.0) for model in MODELS}
    lateral = {model: state.u * state.r for model, state in reached.items()}
    assert lateral["two_track"] < lateral["nonlinear"] < 0.9 * 9.81 < lateral["linear"] + 0.5


@pytest.mark.parametrize("manoeuvre", MANOEUVRES)
def test_the_level_is_reached(manoeuvre: str) -> None:
    drive = simulate_handling(HandlingScenario(manoeuvre, "nonlinear", 0.5, STILL, seconds=60.0, relief=0.0))
    t = np.arange(MANOEUVRES_BEGIN, 60.0, 0.02)
    assert np.abs(drive.truth.at(t).a_v[:, 1]).max() == pytest.approx(0.5 * 9.81, rel=0.2)


def test_readings_integrate_to_the_true_motion() -> None:
    """Specific force and rates without errors give the velocity back."""
    scenario = HandlingScenario("slalom", "two_track", 0.7, STILL, seconds=60.0)
    trajectory = simulate_handling(scenario).truth.trajectory
    t = np.arange(40.0, 59.0, 0.002)
    motion = trajectory.at(t)
    a_n = np.einsum("nij,nj->ni", motion.r_nv(), motion.specific_force(np.zeros(3))) - [0.0, 0.0, 9.80665]
    change = np.cumsum(0.5 * (a_n[1:] + a_n[:-1]) * 0.002, axis=0)
    np.testing.assert_allclose(motion.v_n[0] + change, motion.v_n[1:], atol=5e-3)


def test_it_stands_still_until_it_sets_off() -> None:
    drive = simulate_handling(HandlingScenario(seconds=45.0, seed=2))
    truth = drive.truth.at(np.arange(0.0, 3.9, 0.1))
    np.testing.assert_allclose(truth.velocity_v, 0.0, atol=1e-6)
    np.testing.assert_allclose(truth.w_v, 0.0, atol=1e-6)


def test_seeds_and_what_is_left_out() -> None:
    one, same, other = (simulate_handling(HandlingScenario(seconds=8.0, seed=seed)) for seed in (1, 1, 2))
    np.testing.assert_array_equal(one.samples.f_s, same.samples.f_s)
    assert quaternion.angle_between(one.truth.q_vs, other.truth.q_vs) > 0.01
    bare = simulate_handling(HandlingScenario(seconds=8.0, steer=False, gyro=False, outages=((2.0, 5.0),))).samples
    assert bare.steer is None
    assert np.isnan(bare.w_s).all()
    t = bare.t[bare.fix_row]
    np.testing.assert_array_equal(bare.fix_valid, (t < 1.99) | (t > 4.99))


def test_reversing() -> None:
    drive = simulate_handling(HandlingScenario(seconds=20.0, reverse=True))
    assert drive.truth.at(np.array([8.0])).velocity_v[0, 0] < -1.0
