from math import pi, radians

import numpy as np
import pytest

from core.motion.steering_figure import Pose, fit_pose, search
from core.motion.steering_markers import from_markers
from core.motion.steering_rectification import NONE, rectified, rotation_between
from core.motion.steering_terms import Complexes, Floats, SteeringError

PLACES = np.radians([0.0, 47.0, 112.0, 171.0, 238.0, 297.0])
FIGURE = np.asarray(0.13 * np.array([0.9, 1.0, 0.85, 0.95, 0.8, 1.0]) * np.exp(1j * PLACES), np.complex128)
LAMP = np.array([[150.0, 150.0]])
"""px, something of the markers' colour that does not turn"""


def seen(plane: Complexes, tilt: float) -> Floats:
    """Pixels of points of the wheel's plane, the camera 0.7 m away."""
    depth = 0.7 + plane.imag * np.sin(tilt)
    return np.stack([320 + 900 * plane.real / depth, 240 - 900 * plane.imag * np.cos(tilt) / depth], axis=-1)


def film(
    seed: int, tilt: float = radians(30), hidden: float = 0.12, false: float = 0.5, shake: float = 4.0
) -> tuple[Floats, Floats, list[Floats]]:
    """Times, angles, and the points of each frame in any order."""
    rng = np.random.default_rng(seed)
    t = np.arange(500) / 30
    angle = radians(220) * np.sin(0.7 * t) * np.clip((t - 1) / 3, 0, 1)
    frames = []
    for a in angle:
        points = seen(FIGURE * np.exp(1j * (a + 0.3)), tilt) + rng.normal(0, 0.3, (6, 2)) + rng.normal(0, shake, 2)
        wrong = rng.uniform([0, 0], [640, 480], (rng.poisson(false), 2))
        frames.append(rng.permutation(np.concatenate([points[rng.random(6) > hidden], LAMP, wrong])))
    return t, angle, frames


def rms(x: Floats) -> float:
    return float(np.sqrt(np.nanmean(x**2)))


@pytest.mark.parametrize("seed", range(4))
def test_the_angle_is_found_among_hidden_and_false_markers_seen_askew_by_a_shaken_camera(seed: int) -> None:
    t, angle, frames = film(seed)
    found = from_markers(t, frames)
    assert rms(found.steering.angle - angle) < radians(0.5)
    assert np.isfinite(found.steering.angle).mean() > 0.9
    assert found.figure.size == 6


def test_matching_one_figure_does_not_drift_as_adding_up_does() -> None:
    t, angle, frames = film(1)
    found = from_markers(t, frames)
    assert rms(found.steering.angle - angle) < 0.5 * rms(found.by_increments - angle)


def test_the_view_is_learned_and_matters() -> None:
    t, _, frames = film(0, tilt=radians(35))
    found = from_markers(t, frames)
    assert np.abs(found.view).max() > 0.05
    circle = np.asarray(np.exp(1j * np.arange(8)), np.complex128)
    np.testing.assert_array_equal(rectified(NONE, circle), circle)
    assert np.ptp(np.abs(rectified(found.view, circle))) > 0.05
    straight_ahead = from_markers(*film(0, tilt=0.0)[::2])
    np.testing.assert_allclose(straight_ahead.view, NONE, atol=0.02)


def test_from_behind_left_is_right() -> None:
    t, _, frames = film(2)
    there, behind = from_markers(t, frames), from_markers(t, frames, from_behind=True)
    np.testing.assert_array_equal(there.steering.angle, -behind.steering.angle)


def test_a_moment_at_which_the_wheel_is_straight() -> None:
    t, angle, frames = film(2)
    found = from_markers(t, frames, straight=6.73)
    near = np.abs(t - 6.73) < 0.2
    assert abs(np.nanmedian(found.steering.angle[near])) < radians(2)
    offset = found.steering.angle - angle
    assert np.nanstd(offset) < radians(0.5)


def test_what_happens_while_no_marker_is_seen_is_not_known_and_the_angle_comes_back() -> None:
    t, angle, frames = film(3)
    gap = (t > 7.0) & (t < 8.2)
    found = from_markers(t, [z[:0] if g else z for z, g in zip(frames, gap, strict=True)])
    assert np.isnan(found.steering.angle[gap]).all()
    assert rms(found.steering.angle - angle) < radians(0.5)


def test_a_lamp_is_no_marker_even_if_the_wheel_is_hardly_turned() -> None:
    t, _, _ = film(0)
    rng = np.random.default_rng(8)
    angle = radians(20) * np.sin(0.9 * t) * (t > 1)
    noise = rng.normal(0, 0.3, (t.size, 6, 2)) + rng.normal(0, 3.0, (t.size, 1, 2))
    frames = [np.vstack([seen(FIGURE * np.exp(1j * a), 0.4) + n, LAMP]) for a, n in zip(angle, noise, strict=True)]
    found = from_markers(t, frames)
    assert found.figure.size == 6
    assert rms(found.steering.angle - angle) < radians(0.5)


def test_an_order_of_the_points_means_nothing() -> None:
    t, _, frames = film(0)
    first, again = from_markers(t, frames), from_markers(t, [z[::-1] for z in frames])
    np.testing.assert_allclose(first.steering.angle, again.steering.angle, atol=radians(0.05))


@pytest.mark.parametrize("angle", [-3.1, -0.5, 0.0, 1e-6, 2.0, pi])
def test_the_rotation_between_two_figures(angle: float) -> None:
    moved = FIGURE * np.exp(1j * angle) + (3 - 2j)
    assert np.exp(1j * rotation_between(FIGURE, moved)) == pytest.approx(np.exp(1j * angle))
    # the best one, not merely a good one
    noisy = moved + 0.02 * np.array([1, -1j, 1j, -1, 0.5, 0.3j])
    best = rotation_between(FIGURE, noisy)
    misses = [
        np.linalg.norm(noisy - noisy.mean() - np.exp(1j * a) * (FIGURE - FIGURE.mean()))
        for a in (best, best - 1e-3, best + 1e-3)
    ]
    assert misses[0] < min(misses[1:])


@pytest.mark.parametrize("turns", [-2, 0, 1])
def test_a_pose_keeps_the_turn_it_is_in(turns: int) -> None:
    rotation = 2 * pi * turns + 0.4
    pose = fit_pose(FIGURE, FIGURE * np.exp(1j * rotation) + 1j, rotation + 2.5)
    assert pose.rotation == pytest.approx(rotation)
    np.testing.assert_allclose(pose.taken_back(pose.placed(FIGURE)), FIGURE, atol=1e-12)


def test_the_whole_circle_is_searched() -> None:
    figure = FIGURE / 0.12
    there = Pose(2.6, 0.4 - 0.1j)
    points = np.append(there.placed(figure)[[0, 2, 3, 5]], [1.4 + 1.2j, -1.7 + 0.2j])
    found = search(figure, points, 0.0, 0.05)
    assert found is not None
    assert found.rotation == pytest.approx(2.6, abs=1e-6)
    assert search(figure, points[:1], 0.0, 0.05) is None


def test_films_that_show_nothing() -> None:
    t = np.arange(60) / 30
    with pytest.raises(SteeringError, match="No frame shows 3 markers"):
        from_markers(t, [np.zeros((2, 2))] * 60)
    rng = np.random.default_rng(0)
    with pytest.raises(SteeringError, match="fixed to the wheel"):
        from_markers(t, [rng.uniform(0, 600, (3, 2)) for _ in t])
