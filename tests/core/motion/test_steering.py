from dataclasses import replace
from math import pi, radians

import numpy as np
import pytest

from core import quaternion
from core.motion import steering_alignment, steering_fusion
from core.motion.steering import DEFAULT, SteeringError, TwoDevices, two_devices
from core.motion.steering_alignment import Pair
from core.motion.steering_clocks import averages
from core.motion.steering_terms import Floats, Steering
from core.motion.steering_zero import find_start, straight_angle
from core.simulation_motion import GRAVITY
from core.simulation_steering import SteeringDrive, SteeringScenario, simulate_steering

DRIVE = simulate_steering(SteeringScenario(route="curves", seed=31, seconds=240.0))
FOUND = two_devices(DRIVE.car, DRIVE.wheel)


def errors(drive: SteeringDrive, found: TwoDevices, angle: Floats) -> Floats:
    return np.asarray(angle - np.interp(found.steering.t, drive.t, drive.angle), np.float64)


def rms(x: Floats) -> float:
    return float(np.sqrt(np.nanmean(x**2)))


def turned(x: Floats) -> Floats:
    """Modulo a turn."""
    return np.asarray((x + pi) % (2 * pi) - pi, np.float64)


def test_the_angle_is_found_and_better_than_by_rates_or_forces_alone() -> None:
    fused = rms(errors(DRIVE, FOUND, FOUND.steering.angle))
    assert fused < radians(1.2)
    assert fused < rms(errors(DRIVE, FOUND, FOUND.by_rates))
    assert fused < rms(turned(errors(DRIVE, FOUND, FOUND.by_forces)))
    assert rms(errors(DRIVE, FOUND, FOUND.steering.angle) / FOUND.steering.sigma) < 2.0


def test_axis_clock_and_attitude() -> None:
    assert np.degrees(np.arccos(FOUND.axis_w @ DRIVE.axis_w)) < 1.5
    there = FOUND.clock.on_car(DRIVE.wheel.t)
    np.testing.assert_allclose(there, DRIVE.clock_offset + (1 + DRIVE.clock_skew) * DRIVE.wheel.t, atol=0.01)
    assert quaternion.angle_between(FOUND.q_cw, DRIVE.q_cw) < radians(5)


def test_devices_at_other_attitudes_give_the_same_angle() -> None:
    q_c, q_w = quaternion.random(np.random.default_rng(1), 2)
    car, wheel = (
        replace(log, f_s=quaternion.rotate(q, log.f_s), w_s=quaternion.rotate(q, log.w_s))
        for log, q in ((DRIVE.car, q_c), (DRIVE.wheel, q_w))
    )
    again = two_devices(car, wheel)
    np.testing.assert_allclose(again.steering.angle, FOUND.steering.angle, atol=radians(0.1))
    np.testing.assert_allclose(quaternion.rotate(q_w, FOUND.axis_w), again.axis_w, atol=1e-6)


def test_where_straight_is_can_be_given_by_time_or_by_attitude() -> None:
    t = 120.0
    at = two_devices(DRIVE.car, DRIVE.wheel, straight=t)
    assert np.interp(t, at.steering.t, at.steering.angle) == pytest.approx(0.0, abs=1e-9)
    by = two_devices(DRIVE.car, DRIVE.wheel, q_cw=-FOUND.q_cw)
    np.testing.assert_allclose(by.steering.angle, FOUND.steering.angle, atol=radians(0.01))


def test_a_gap_of_the_wheels_log_is_not_bridged_and_does_not_spoil_the_rest() -> None:
    kept = (DRIVE.wheel.t < DRIVE.wheel.t[0] + 150) | (DRIVE.wheel.t > DRIVE.wheel.t[0] + 156)
    log = DRIVE.wheel
    found = two_devices(DRIVE.car, replace(log, t=log.t[kept], f_s=log.f_s[kept], w_s=log.w_s[kept]))
    missing = np.isnan(found.steering.angle)
    assert 5.5 < missing.sum() / DEFAULT.rate < 6.5
    assert rms(errors(DRIVE, found, found.steering.angle)) < radians(1.5)


def test_a_wheel_that_lies_flat_is_found_by_rates_and_the_forces_say_they_are_weak() -> None:
    drive = simulate_steering(SteeringScenario(seed=5, seconds=200.0, inclination=radians(80.0)))
    found = two_devices(drive.car, drive.wheel)
    assert np.median(found.steering.sigma) > np.median(FOUND.steering.sigma)
    assert rms(errors(drive, found, found.steering.angle) / found.steering.sigma) < 3.0


@pytest.mark.parametrize("angle", [0.0, 0.7, -2.5, pi - 1e-3, 9.0])
def test_forces_show_the_rotation_about_the_axis_only(angle: float) -> None:
    rng = np.random.default_rng(3)
    axis, q_cw = np.array([0.48, -0.6, 0.64]), quaternion.random(rng)
    f_c = np.array([0.3, 1.0, GRAVITY]) + rng.normal(0, 1.0, (100, 3))
    turn = quaternion.from_rotation_vector(-angle * axis)
    f_w = quaternion.rotate(turn, quaternion.rotate(quaternion.conjugate(q_cw), f_c)) + 3.0 * axis  # along: no matter
    pair = Pair(np.arange(100) / 50, f_c, np.zeros((100, 3)), f_w, np.zeros((100, 3)))
    compared = steering_fusion.compare_forces(pair, axis, q_cw, np.zeros(100), DEFAULT)
    np.testing.assert_allclose(np.exp(1j * compared.angle), np.exp(1j * angle), atol=1e-9)
    again = steering_fusion.compare_forces(pair, axis, q_cw, np.full(100, 1.3), DEFAULT)
    assert np.isfinite(again.angle).all()


def test_forces_along_the_axis_say_nothing() -> None:
    axis = np.array([0.0, 0.0, 1.0])
    f = np.tile([0.0, 0.0, GRAVITY], (50, 1))
    pair = Pair(np.arange(50) / 50, f, np.zeros_like(f), f, np.zeros_like(f))
    compared = steering_fusion.compare_forces(pair, axis, np.array([1.0, 0, 0, 0]), np.zeros(50), DEFAULT)
    assert (compared.sigma > 3.0).all()


def test_the_plane_turns_as_complex_numbers_do() -> None:
    axis, v = np.array([0.36, 0.48, 0.8]), np.array([1.0, -2.0, 0.5])
    across = steering_alignment.plane(axis)
    turned = quaternion.rotate(quaternion.from_rotation_vector(0.8 * axis), v)
    assert turned @ across == pytest.approx((v @ across) * np.exp(0.8j))
    assert abs(axis @ across) < 1e-12


def test_averages_are_those_of_the_cells_whatever_the_sampling() -> None:
    rng = np.random.default_rng(0)
    t = np.sort(rng.uniform(0, 10, 20000))
    raster = np.arange(20, 180) / 20
    got = averages(t, np.stack([np.sin(t), 3 * t], axis=-1), raster)
    exact = (np.cos(raster - 0.025) - np.cos(raster + 0.025)) / 0.05
    np.testing.assert_allclose(got[:, 0], exact, atol=2e-4)
    np.testing.assert_allclose(got[:, 1], 3 * raster, atol=2e-4)
    assert np.isnan(averages(np.delete(t, slice(5000, 7000)), t[:-2000, None], raster)).any()


def test_straight_is_where_the_vehicle_goes_straight_on() -> None:
    rng = np.random.default_rng(2)
    speed, yaw = rng.uniform(8, 25, 4000), rng.uniform(-0.2, 0.2, 4000)
    angle = 0.1 + 40 * yaw / speed + 0.04 * yaw * speed + rng.normal(0, 0.01, 4000)
    zero, sigma = straight_angle(angle, yaw, speed, 0.02, 6.0) or (np.nan, np.nan)
    assert abs(zero - 0.1) < min(3 * sigma, 0.01)
    assert straight_angle(angle, yaw, np.full(4000, 2.0), 0.02, 6.0) is None


def test_when_a_film_began_is_found_from_the_yaw_rate() -> None:
    during = (FOUND.steering.t > 100.0) & (FOUND.steering.t < 180.0)
    part = Steering(*(x[during] for x in FOUND.steering))
    assert find_start(DRIVE.car, part._replace(t=part.t - part.t[0])) == pytest.approx(part.t[0], abs=0.5)
    with pytest.raises(SteeringError, match="--video-start"):
        find_start(DRIVE.car, part._replace(angle=np.sin(9.0 * part.t)))


def test_what_is_missing_is_said() -> None:
    drive = simulate_steering(SteeringScenario(seed=2, seconds=90.0, parked_turns=0.0))
    with pytest.raises(SteeringError, match="turn it by a quarter turn"):
        two_devices(drive.car, drive.wheel)
    with pytest.raises(SteeringError, match="on the steering wheel has no gyroscope"):
        two_devices(DRIVE.car, replace(DRIVE.wheel, w_s=np.full_like(DRIVE.wheel.w_s, np.nan)))
    other = simulate_steering(SteeringScenario(seed=77, seconds=90.0, route="motorway"))
    with pytest.raises(SteeringError):
        two_devices(drive.car, other.wheel)
    with pytest.raises(SteeringError, match="20 s"):
        two_devices(DRIVE.car.slice(0, 500), DRIVE.wheel)
