"""Short drives at a low rate, quick enough for the uncompiled kernel, on every path of it."""

from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest

from core.motion import DEFAULT, VEHICLES, Motion, reconstruct
from core.samples import Samples
from core.simulation_handling import HandlingDrive, HandlingScenario, simulate_handling

SLOW = replace(DEFAULT, rate=10.0)


@lru_cache
def drive(reverse: bool = False, device: bool = True) -> HandlingDrive:
    vehicle = replace(VEHICLES["sedan"], device=(0.5, 0.1, 0.3) if device else None)
    scenario = HandlingScenario(vehicle=vehicle, seconds=24.0, seed=3, imu_rate=20.0, reverse=reverse, latency=0.1)
    return simulate_handling(scenario)


def motion_of(it: HandlingDrive, samples: Samples) -> Motion:
    return reconstruct(it.truth.scenario.vehicle, it.truth.q_vs, samples, replace(SLOW, latency=0.1))


def assert_right(it: HandlingDrive, motion: Motion, limit: float = 0.6) -> None:
    """The forward velocity of the last seconds, and that it is known for most of the drive."""
    late = motion.t > 15.0
    truth = it.truth.at(motion.t[late]).velocity_v[:, 0]
    assert np.sqrt(np.mean((motion.velocity_v[late, 0] - truth) ** 2)) < limit
    assert np.isfinite(motion.velocity_v[:, 0]).mean() > 0.5


def with_fix(samples: Samples, **columns: float) -> Samples:
    """The same samples with some columns of the fixes replaced."""
    place, accuracy = slice(0, 3), slice(6, 8)
    names: dict[str, slice | int] = {"position": place, "speed": 3, "course": 4, "vertical": 5, "accuracy": accuracy}
    fix = samples.fix.copy()
    for name, value in columns.items():
        fix[:, names[name]] = value
    return replace(samples, fix=fix)


@pytest.mark.parametrize("device", [True, False])
@pytest.mark.parametrize("steer", [True, False])
def test_with_and_without_steering_and_place(device: bool, steer: bool) -> None:
    it = drive(device=device)
    assert_right(it, motion_of(it, it.samples if steer else replace(it.samples, steer=None)))


def test_receivers_that_tell_more() -> None:
    it = drive()
    samples = with_fix(it.samples, vertical=0.0, accuracy=0.2)
    assert_right(it, motion_of(it, samples))


@pytest.mark.parametrize("columns", [{"position": np.nan}, {"speed": np.nan, "course": np.nan}])
def test_receivers_that_tell_less(columns: dict[str, float]) -> None:
    it = drive()
    assert_right(it, motion_of(it, with_fix(it.samples, **columns)), 1.0)


def test_a_receiver_that_loses_its_course_in_motion() -> None:
    it = drive()
    fix = it.samples.fix.copy()
    fix[it.samples.t[it.samples.fix_row] > 14.0, 4] = np.nan
    assert_right(it, motion_of(it, replace(it.samples, fix=fix)))


def test_without_a_gyroscope() -> None:
    it = drive()
    assert_right(it, motion_of(it, replace(it.samples, w_s=np.full_like(it.samples.w_s, np.nan))), 1.0)


def test_backing_out_first() -> None:
    it = drive(reverse=True)
    motion = motion_of(it, it.samples)
    assert_right(it, motion)
    backwards = it.truth.at(motion.t).velocity_v[:, 0] < -2.3
    assert (motion.velocity_v[backwards & np.isfinite(motion.velocity_v[:, 0]), 0] < 0).all()


def test_fixes_that_contradict_start_it_anew() -> None:
    it = drive()
    fix = it.samples.fix.copy()
    fix[:, :2] = np.nan
    fix[it.samples.t[it.samples.fix_row] > 10.0, 4] += 2.5
    motion = motion_of(it, replace(it.samples, fix=fix))
    lost = np.flatnonzero(np.isnan(motion.velocity_v[:, 0]) & (motion.t > 10.0))
    assert lost.size > 0
    assert np.isfinite(motion.velocity_v[-1]).all()
    assert_right(it, motion, 2.0)


def test_a_jump_of_the_position_is_followed() -> None:
    it = drive()
    fix = it.samples.fix.copy()
    fix[it.samples.t[it.samples.fix_row] > 12.0, 0] += 1000.0 / 6.37e6
    motion = motion_of(it, replace(it.samples, fix=fix))
    north = motion.position_n[-1, 1] - it.truth.at(motion.t[-1:]).position_n[0, 1]
    assert north == pytest.approx(1000.0, abs=30.0)
    assert_right(it, motion, 1.0)
