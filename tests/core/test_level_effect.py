"""What a level start is good for: roll and pitch are known before the drive has shown them."""

from dataclasses import replace
from functools import cache
from typing import NamedTuple

import numpy as np
import pytest

from core import DEFAULT, Estimates, State, advance, begin_session, calibrated, initial_state, level_start, status
from core.quaternion import conjugate, multiply, rotation_vector
from core.simulation import Drive, Scenario, simulate, simulate_sessions
from tests.core.drives import Floats

pytestmark = pytest.mark.compiled

DEGREE = np.pi / 180
PARAMS = calibrated(DEFAULT)
SEEDS = [31, 32, 33, 35, 36, 38]


def scenario(seed: int, route: str = "city", seconds: float = 400.0, mount: Floats | None = None) -> Scenario:
    return Scenario(route, seconds, seed, mount, sensor="calibrated", imu_rate=50.0, relief=0.0)


def tilt_error(quaternion: Floats, truth: Floats) -> Floats:
    """rad, roll and pitch together."""
    error = rotation_vector(multiply(quaternion, conjugate(truth)))
    size: Floats = np.linalg.norm(error[..., :2], axis=-1)
    return size


class Pair(NamedTuple):
    drive: Drive
    told: Estimates
    """with a level start"""
    untold: Estimates


@cache
def parked_then_driven(seed: int) -> Pair:
    drive = simulate(scenario(seed))
    parked = simulate(scenario(seed, "parked", 20.0, drive.truth.q_vs))
    late = replace(drive.samples, t=drive.samples.t + 20.02)
    state, _ = advance(PARAMS, initial_state(PARAMS), parked.samples)
    return Pair(
        drive,
        advance(PARAMS, level_start(PARAMS, state), late)[1].estimates,
        advance(PARAMS, state, late)[1].estimates,
    )


@pytest.mark.parametrize("seed", SEEDS)
def test_tilt_is_right_as_soon_as_yaw_is_known(seed: int) -> None:
    drive, told, _ = parked_then_driven(seed)
    assert tilt_error(told.quaternion, drive.truth.q_vs).max() < 1.0 * DEGREE


def test_the_first_estimates_are_better_than_without() -> None:
    told, untold = [], []
    for seed in SEEDS:
        drive, with_it, without = parked_then_driven(seed)
        told.append(tilt_error(with_it.quaternion[0], drive.truth.q_vs))
        untold.append(tilt_error(without.quaternion[0], drive.truth.q_vs))
    assert np.mean(told) < 0.5 * np.mean(untold)


@pytest.mark.parametrize("seed", SEEDS)
def test_tilt_is_stated_surer_and_an_estimate_comes_no_later(seed: int) -> None:
    _, told, untold = parked_then_driven(seed)
    assert told.t[0] <= untold.t[0]
    _, in_told, in_untold = np.intersect1d(told.t, untold.t, return_indices=True)
    soon = slice(0, 10)
    assert np.all(told.sigma[in_told[soon], :2] <= untold.sigma[in_untold[soon], :2])
    assert np.all(told.sigma[0, :2] < 1.2 * DEGREE)


@pytest.mark.parametrize("seed", SEEDS)
def test_the_stated_tilt_covers_the_error(seed: int) -> None:
    drive, told, _ = parked_then_driven(seed)
    error = rotation_vector(multiply(told.quaternion, conjugate(drive.truth.q_vs)))
    assert np.mean(np.abs(error) < 3 * told.sigma) > 0.97


@cache
def stopped_on_the_way(seed: int) -> tuple[Drive, State, int]:
    """A drive until the end of a stop, with the filter running, and the row after it."""
    drive = simulate(scenario(seed))
    t = drive.samples.t[drive.samples.fix_row]
    standing = np.flatnonzero((np.abs(drive.truth.speed) < 0.02) & (t > 30) & (t < 200))
    stop = max(np.split(standing, np.flatnonzero(np.diff(standing) > 1) + 1), key=len)
    row = int(drive.samples.fix_row[stop[-1]]) + 1
    state, _ = advance(PARAMS, initial_state(PARAMS), drive.samples.slice(0, row))
    return drive, state, row


@pytest.mark.parametrize("seed", SEEDS)
def test_a_running_filter_takes_it_too(seed: int) -> None:
    drive, state, row = stopped_on_the_way(seed)
    assert state.filter[0]["running"]
    before, after = status(PARAMS, state).estimate, status(PARAMS, level_start(PARAMS, state)).estimate
    assert before is not None
    assert after is not None
    true = drive.truth.q_vs
    assert tilt_error(after.quaternion, true) < tilt_error(before.quaternion, true) + 0.1 * DEGREE
    assert np.all(after.sigma <= before.sigma + 1e-12)
    assert after.sigma[0] < 0.9 * before.sigma[0], "roll is what driving shows least"
    rest = drive.samples.slice(row, len(drive.samples))
    _, told = advance(PARAMS, level_start(PARAMS, state), rest)
    _, untold = advance(PARAMS, state, rest)
    assert told.status.mount is not None
    assert np.all(told.estimates.sigma[:60, :2] <= 1.02 * untold.estimates.sigma[:60, :2])
    worse = tilt_error(told.estimates.quaternion, true) - tilt_error(untold.estimates.quaternion, true)
    assert worse.max() < 0.25 * DEGREE


def test_in_a_later_session_it_keeps_what_is_confirmed() -> None:
    """The vehicle is switched on, said to stand level before it moves, and driven."""
    first, second = simulate_sessions(scenario(36), 2)
    state, before = advance(PARAMS, initial_state(PARAMS), first.samples)
    assert before.status.mount is not None
    parked = simulate(scenario(36, "parked", 20.0, first.truth.q_vs)).samples
    state, _ = advance(PARAMS, begin_session(PARAMS, state), parked)
    state = level_start(PARAMS, state)
    assert str(status(PARAMS, state).mount) == str(before.status.mount)
    _, after = advance(PARAMS, state, replace(second.samples, t=second.samples.t + 20.02))
    assert after.events == ()
    assert str(after.status.mount) == str(before.status.mount)
    assert after.status.estimate is not None
    assert tilt_error(after.status.estimate.quaternion, first.truth.q_vs) < 1.0 * DEGREE
