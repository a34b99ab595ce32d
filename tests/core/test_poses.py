import time

import numpy as np
import pytest

from core import Samples
from core._kernel import GRAVITY
from core.poses import angle_between, find_poses, missing
from tests.core.poses import NINE, UPRIGHT, recording

HELD = GRAVITY * NINE


def found(held: np.ndarray, **how: float) -> np.ndarray:
    return np.array([pose.reading for pose in find_poses([recording(held, **how)])])  # type: ignore[arg-type]


@pytest.mark.parametrize("noise", [0.0, 0.003, 0.02, 0.1, 0.25])
def test_poses_are_found_at_any_noise(noise: float) -> None:
    np.testing.assert_allclose(found(HELD, noise=noise), HELD, atol=0.02 + 0.4 * noise)


@pytest.mark.parametrize("rate", [10.0, 37.0, 200.0])
def test_poses_are_found_at_any_rate(rate: float) -> None:
    np.testing.assert_allclose(found(HELD, rate=rate), HELD, atol=0.1)


def test_a_pose_must_be_held_for_a_second() -> None:
    assert len(found(HELD, seconds=0.7)) == 0
    assert len(found(HELD, seconds=1.6)) == 9


def test_coarse_counts_hide_no_pose() -> None:
    count = GRAVITY / 100
    samples = recording(HELD, noise=0.01)
    counted = Samples.make(samples.t, np.round(samples.f_s / count) * count)
    assert len(find_poses([counted])) == 9


def test_a_device_that_never_rests_gives_no_pose() -> None:
    shaken = np.random.default_rng(0).normal(size=(3000, 3)) + np.array([0, 0, GRAVITY])
    assert find_poses([Samples.make(np.arange(3000) / 50, shaken)]) == []
    assert find_poses([Samples.make([], np.empty((0, 3)))]) == []


def test_an_axis_that_reads_nothing_like_gravity_is_no_pose() -> None:
    assert len(found(np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 30.0]]))) == 0


def test_the_same_pose_again_is_averaged_and_a_near_one_says_nothing_new() -> None:
    def tilted(degrees: float) -> np.ndarray:
        return GRAVITY * np.array([np.sin(np.radians(degrees)), 0, np.cos(np.radians(degrees))])

    again = find_poses([recording(np.array([tilted(0), tilted(1)]), noise=0.0)])
    assert len(again) == 1
    assert angle_between(again[0].reading, tilted(0.5)) < np.radians(0.1)
    assert again[0].seconds == pytest.approx(6, abs=1)
    near = found(np.array([tilted(0), tilted(7), tilted(12)]), noise=0.0)
    np.testing.assert_allclose(near, [tilted(0), tilted(12)], atol=0.05)


def test_poses_may_come_from_several_recordings() -> None:
    first, second = recording(HELD[:5]), recording(HELD[3:], seed=1)
    assert len(find_poses([first, second])) == 9


def test_the_stated_sigma_is_that_of_the_mean() -> None:
    errors = [
        (pose.reading - held) / pose.sigma
        for seed in range(20)
        for pose, held in zip(find_poses([recording(HELD, noise=0.1, seed=seed)]), HELD, strict=True)
    ]
    assert np.std(errors) == pytest.approx(1.0, abs=0.15)


def test_a_slow_turn_does_not_make_gravity_shorter() -> None:
    angle = np.linspace(0, np.pi / 2, 6000)  # 90 degrees in two minutes
    f_s = GRAVITY * np.column_stack([np.sin(angle), np.zeros(6000), np.cos(angle)])
    poses = find_poses([Samples.make(np.arange(6000) / 50, f_s)])
    assert 5 <= len(poses) <= 9
    np.testing.assert_allclose([np.linalg.norm(pose.reading) for pose in poses], GRAVITY, atol=0.01)


def test_a_gap_ends_a_pose_and_a_jump_of_the_clock_costs_no_time() -> None:
    samples = recording(HELD[:1], seconds=5, moving=0.02, noise=0.0)
    later = samples.t + np.where(np.arange(len(samples)) < 100, 0, 1e9)
    begun = time.perf_counter()
    poses = find_poses([Samples.make(later, samples.f_s)])
    assert time.perf_counter() - begun < 1
    assert len(poses) == 1
    assert poses[0].seconds < 5


def test_what_is_missing_is_told_in_words() -> None:
    assert missing(HELD) == ()
    assert missing(GRAVITY * UPRIGHT) == (
        "tilted half-way between its x and y axes",
        "tilted half-way between its x and z axes",
        "tilted half-way between its y and z axes",
    )
    assert missing(np.delete(HELD, 5, axis=0)) == ("with its z axis down",)
    assert len(missing(np.empty((0, 3)))) == 9


def test_a_device_held_in_the_hand_does_not_lie_still() -> None:
    table, hand = recording(HELD[:1], noise=0.03), recording(HELD[1:2], noise=0.12, seed=1)
    f_s = np.vstack([table.f_s, hand.f_s])
    poses = find_poses([Samples.make(np.arange(len(f_s)) / 50, f_s)])
    np.testing.assert_allclose([pose.reading for pose in poses], HELD[:1], atol=0.05)


def test_short_looks_with_gaps_between_show_no_rest() -> None:
    """Half a second on record, two seconds not."""
    t = np.concatenate([2.5 * n + np.arange(25) / 50 for n in range(9)])
    assert find_poses([Samples.make(t, np.repeat(HELD, 25, axis=0))]) == []
