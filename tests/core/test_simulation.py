"""A simulated drive is physics one can check: integrate it, weigh it, turn it round."""

import json
from dataclasses import fields, replace

import numpy as np
import pytest
from numpy.typing import NDArray

from core import quaternion
from core.samples import ALTITUDE, COURSE, COURSE_ACCURACY, LATITUDE, LONGITUDE, SPEED, SPEED_ACCURACY, VERTICAL_SPEED
from core.simulation import REMOUNT_SECONDS, Drive, Scenario, simulate
from core.simulation_motion import GRAVITY
from core.simulation_routes import ROUTES
from core.simulation_sensors import EARTH_RADIUS, SENSORS

Floats = NDArray[np.float64]

EXACT = Scenario(seconds=120, ideal=True, vibration=0, gyro=True, latency=0, lever_arm=(0, 0, 0))
HARD = {"constant", "steep", "crawl", "towed", "ferry"}
"""looked at in test_simulation_faults"""
MOVING = sorted(set(ROUTES) - HARD - {"parked", "harsh"})


def in_vehicle(drive: Drive, x_s: Floats) -> Floats:
    return quaternion.rotate(drive.truth.q_vs, x_s)


def level_speed(drive: Drive) -> Floats:
    east, north, _ = drive.truth.v_n.T
    speed: Floats = np.hypot(east, north)
    return speed


def strapdown(drive: Drive) -> tuple[Floats, Floats]:
    """Attitude and velocity at the fixes, from the first one on, integrated by the trapezoidal rule."""
    first = int(drive.samples.fix_row[0])
    t, f_s, w_s = drive.samples.t[first:], drive.samples.f_s[first:], drive.samples.w_s[first:]
    f_v, w_v, dt = in_vehicle(drive, f_s), in_vehicle(drive, w_s), np.diff(t)[:, None]
    turns = quaternion.from_rotation_vector(0.5 * (w_v[1:] + w_v[:-1]) * dt)
    q_nv = np.empty((t.size, 4))
    q_nv[0] = drive.truth.q_nv[0]
    for k, turn in enumerate(turns):
        q_nv[k + 1] = product(q_nv[k], turn)
    a_n = quaternion.rotate(q_nv, f_v) - [0, 0, GRAVITY]
    steps = np.cumsum(0.5 * (a_n[1:] + a_n[:-1]) * dt, axis=0)
    rows = drive.samples.fix_row - first
    return q_nv[rows], drive.truth.v_n[0] + np.vstack([np.zeros(3), steps])[rows]


def product(q: Floats, p: Floats) -> Floats:
    """Hamilton product written out once more, fast for one pair and not the code under test."""
    w, x, y, z = q
    return np.array([[w, -x, -y, -z], [x, w, -z, y], [y, z, w, -x], [z, -y, x, w]]) @ p


@pytest.mark.parametrize("route", sorted(ROUTES))
def test_strapdown_integration_gives_the_motion_back(route: str) -> None:
    drive = simulate(replace(EXACT, route=route, reverse=route == "city"))
    q_nv, v_n = strapdown(drive)
    assert np.max(quaternion.angle_between(q_nv, drive.truth.q_nv)) < np.radians(2e-4)
    assert np.max(np.abs(v_n - drive.truth.v_n)) < 1e-3


def test_a_rough_ride_shakes_the_readings_and_not_the_motion() -> None:
    q_nv, v_n = strapdown(drive := simulate(replace(EXACT, route="hills", seconds=60, vibration=0.5, imu_rate=400)))
    # the bands above 4 Hz are added to the readings, so the bound is what they integrate to
    assert np.max(quaternion.angle_between(q_nv, drive.truth.q_nv)) < np.radians(0.1)
    assert np.max(np.abs(v_n - drive.truth.v_n)) < 0.05


def test_position_is_the_integral_of_the_velocity() -> None:
    drive = simulate(replace(EXACT, route="hills"))
    fix, truth = drive.samples.fix, drive.truth
    east = (fix[:, LONGITUDE] - fix[0, LONGITUDE]) * EARTH_RADIUS * np.cos(fix[0, LATITUDE])
    north = (fix[:, LATITUDE] - fix[0, LATITUDE]) * EARTH_RADIUS
    p_n = np.stack([east, north, fix[:, ALTITUDE] - fix[0, ALTITUDE]], axis=-1)
    steps = 0.5 * (truth.v_n[1:] + truth.v_n[:-1]) * np.diff(truth.t)[:, None]
    assert np.ptp(p_n[:, 2]) > 3
    np.testing.assert_allclose(p_n[1:], np.cumsum(steps, axis=0), atol=0.3)


def test_at_rest_the_device_reads_gravity_and_nothing_turns() -> None:
    drive = simulate(replace(EXACT, route="parked", seconds=10, mount=None, seed=4))
    np.testing.assert_allclose(np.linalg.norm(drive.samples.f_s, axis=1), GRAVITY, rtol=1e-9)
    np.testing.assert_allclose(drive.samples.w_s, 0, atol=1e-9)
    up_v = quaternion.rotate(quaternion.conjugate(drive.truth.q_nv[0]), [0, 0, 1])
    np.testing.assert_allclose(in_vehicle(drive, drive.samples.f_s[5]), GRAVITY * up_v, atol=1e-8)
    assert up_v[2] > 0.99


def test_a_left_turn_pushes_to_the_left() -> None:
    drive = simulate(replace(EXACT, route="curves"))
    rows, course = drive.samples.fix_row, np.unwrap(drive.samples.fix[:, COURSE])
    yaw_rate = -np.gradient(course, drive.truth.t)
    lateral = in_vehicle(drive, drive.samples.f_s)[rows, 1]
    expected = yaw_rate * drive.truth.speed
    moving = drive.truth.speed > 2
    assert np.max(expected[moving]) > 1.5
    assert np.min(expected[moving]) < -1.5
    slope, level = np.polyfit(expected[moving], lateral[moving], 1)
    assert slope == pytest.approx(1.05, abs=0.05)  # gravity adds 7 % as the body rolls out of the curve
    assert level == pytest.approx(0, abs=0.4)


def test_braking_pushes_backwards_and_dips_the_nose() -> None:
    drive = simulate(replace(EXACT, route="straight", seconds=300))
    ahead = np.gradient(drive.truth.speed, drive.truth.t)
    f_x = in_vehicle(drive, drive.samples.f_s)[drive.samples.fix_row, 0]
    assert np.polyfit(ahead, f_x, 1)[0] == pytest.approx(1.08, abs=0.04)  # and gravity adds 8.5 % as the nose dips
    pitch = np.array([quaternion.angles(q)[1] for q in drive.truth.q_nv])
    assert np.degrees(-3 * np.polyfit(ahead, pitch, 1)[0]) == pytest.approx(1.5, abs=0.5)


def test_the_nose_points_uphill() -> None:
    drive = simulate(replace(EXACT, route="hills", seconds=300))
    moving = drive.truth.speed > 3
    climb = np.arcsin(drive.truth.v_n[moving, 2] / drive.truth.speed[moving])
    pitch = np.array([quaternion.angles(q)[1] for q in drive.truth.q_nv[moving]])
    assert np.degrees(np.std(climb)) > 1.5
    assert np.polyfit(climb, pitch, 1)[0] == pytest.approx(-1, abs=0.15)


def test_the_nose_points_into_the_curve() -> None:
    drive = simulate(replace(EXACT, route="curves"))
    moving = drive.truth.speed > 2
    ahead_n = quaternion.rotate(drive.truth.q_nv, [1.0, 0.0, 0.0])[moving]
    v_n = drive.truth.v_n[moving]
    slip = (v_n[:, 0] * ahead_n[:, 1] - v_n[:, 1] * ahead_n[:, 0]) / drive.truth.speed[moving]  # left positive
    lateral = in_vehicle(drive, drive.samples.f_s)[drive.samples.fix_row, 1][moving]
    assert np.degrees(np.polyfit(lateral, slip, 1)[0] * GRAVITY) == pytest.approx(2.0, abs=0.3)


@pytest.mark.parametrize("q_vs", [[1, 0, 0, 0], [0, 1, 0, 0], [0.5, 0.5, 0.5, 0.5], [0.9, 0.1, -0.3, 0.2]])
def test_mounting_turns_readings_into_vehicle_axes(q_vs: list[float]) -> None:
    reference = simulate(replace(EXACT, mount=[1, 0, 0, 0], seconds=60)).samples
    turned = simulate(replace(EXACT, mount=q_vs, seconds=60))
    np.testing.assert_allclose(turned.truth.q_vs, quaternion.normalise(q_vs))
    np.testing.assert_allclose(in_vehicle(turned, turned.samples.f_s), reference.f_s, atol=1e-9)
    np.testing.assert_allclose(in_vehicle(turned, turned.samples.w_s), reference.w_s, atol=1e-9)
    assert in_vehicle(turned, turned.samples.f_s)[:, 2].mean() == pytest.approx(GRAVITY, abs=0.1)


def test_device_away_from_the_turning_point_feels_the_turning() -> None:
    arm = np.array([1.2, 0.4, 0.3])
    here, there = (simulate(replace(EXACT, route="curves", imu_rate=400, lever_arm=a)) for a in ((0, 0, 0), arm))
    w_v = in_vehicle(here, here.samples.w_s)
    dw_v = np.gradient(w_v, here.samples.t, axis=0)
    extra = in_vehicle(there, there.samples.f_s) - in_vehicle(here, here.samples.f_s)
    rivals = np.cross(dw_v, arm) + np.cross(w_v, np.cross(w_v, arm))
    assert np.max(np.abs(extra)) > 0.2
    np.testing.assert_allclose(extra[1:-1], rivals[1:-1], atol=1e-3)
    np.testing.assert_array_equal(there.truth.lever_arm, arm)
    np.testing.assert_array_equal(there.truth.antenna_arm, arm)


def test_antenna_moves_with_the_device_unless_it_is_placed_elsewhere() -> None:
    inside = simulate(replace(EXACT, route="curves", lever_arm=(1.5, 0, 0)))
    apart = simulate(replace(EXACT, route="curves", lever_arm=(1.5, 0, 0), antenna_arm=(0, 0, 0)))
    np.testing.assert_allclose(apart.samples.fix[:, SPEED], level_speed(apart), atol=1e-9)
    moving = inside.truth.speed > 3
    swing = np.angle(np.exp(1j * (apart.samples.fix[:, COURSE] - inside.samples.fix[:, COURSE])))[moving]
    w_z = in_vehicle(inside, inside.samples.w_s)[inside.samples.fix_row, 2][moving]
    np.testing.assert_allclose(swing, np.arctan(1.5 * w_z / inside.truth.speed[moving]), atol=0.02)


def test_fixes_come_late_by_the_latency() -> None:
    prompt, late = (simulate(replace(EXACT, seconds=60, latency=x)) for x in (0.0, 0.4))
    then = np.interp(late.truth.t - 0.4, prompt.truth.t, prompt.samples.fix[:, SPEED])
    moving = late.truth.t > 3
    np.testing.assert_allclose(late.samples.fix[moving, SPEED], then[moving], atol=0.03)
    np.testing.assert_allclose(late.truth.speed, prompt.truth.speed)
    assert late.truth.latency == pytest.approx(0.4)


def test_a_seed_makes_the_same_drive_again_and_another_seed_another() -> None:
    first, again, other = (simulate(Scenario(seconds=20, seed=s)) for s in (5, 5, 6))
    for column in fields(first.samples):
        np.testing.assert_array_equal(getattr(first.samples, column.name), getattr(again.samples, column.name))
    assert quaternion.angle_between(first.truth.q_vs, other.truth.q_vs) > 0.01
    assert first.truth.latency != other.truth.latency


def test_choosing_one_thing_changes_nothing_else() -> None:
    scenario = Scenario(seconds=20, seed=5, route="straight")
    base, chosen = simulate(scenario), simulate(replace(scenario, mount=[1, 0, 0, 0], latency=0.0, sensor="calibrated"))
    np.testing.assert_array_equal(chosen.truth.v_n, base.truth.v_n)
    np.testing.assert_array_equal(chosen.truth.lever_arm, base.truth.lever_arm)
    np.testing.assert_allclose(chosen.truth.bias, base.truth.bias * SENSORS["calibrated"].bias / SENSORS["mems"].bias)


def test_tmd2_reads_whole_percents_of_g_and_has_no_gyroscope() -> None:
    samples = simulate(Scenario(seconds=10, sensor="tmd2")).samples
    counts = samples.f_s / (0.01 * GRAVITY)
    np.testing.assert_allclose(counts, np.round(counts), atol=1e-9)
    assert np.all(np.isnan(samples.w_s))


@pytest.mark.parametrize(
    ("sensor", "gyro", "given"), [("tmd2", True, True), ("mems", None, True), ("mems", False, False)]
)
def test_gyroscope_is_there_when_asked_for(sensor: str, gyro: bool | None, given: bool) -> None:
    samples = simulate(Scenario(seconds=5, sensor=sensor, gyro=gyro)).samples
    assert np.all(np.isfinite(samples.w_s)) == given


@pytest.mark.parametrize("sensor", sorted(SENSORS))
def test_sensor_errors_are_of_the_size_of_their_class(sensor: str) -> None:
    drives = [simulate(Scenario(route="parked", seconds=2, seed=s, sensor=sensor)) for s in range(30)]
    bias = np.concatenate([d.truth.bias for d in drives])
    assert np.std(bias) == pytest.approx(SENSORS[sensor].bias, rel=0.25)
    residual = [  # gravity along the true vertical is left after taking away what the truth tells
        d.samples.f_s.mean(axis=0) - d.truth.bias - (1 + d.truth.scale) * gravity_in_sensor(d) for d in drives
    ]
    assert np.max(np.abs(residual)) < 0.06
    scale, gyro_bias = (np.std([getattr(d.truth, name) for d in drives]) for name in ("scale", "gyro_bias"))
    assert scale == pytest.approx(SENSORS[sensor].scale, rel=0.25)
    assert gyro_bias == pytest.approx(SENSORS[sensor].gyro_bias, rel=0.25)


def test_gyroscope_at_rest_reads_its_bias() -> None:
    drive = simulate(Scenario(route="parked", seconds=20))
    np.testing.assert_allclose(drive.samples.w_s.mean(axis=0), drive.truth.gyro_bias, atol=3e-4)
    assert np.max(np.abs(drive.truth.gyro_bias)) > 2e-3


def gravity_in_sensor(drive: Drive) -> Floats:
    q_ns = quaternion.multiply(drive.truth.q_nv[0], drive.truth.q_vs)
    return quaternion.rotate(quaternion.conjugate(q_ns), [0, 0, GRAVITY])


def test_speed_and_course_are_noisy_and_course_freezes_at_standstill() -> None:
    drive = simulate(replace(EXACT, seconds=600, ideal=False, accuracy=True))
    fix, speed = drive.samples.fix, drive.truth.speed
    error = fix[:, SPEED] - level_speed(drive)
    fast, slow = speed > 8, (speed > 1) & (speed < 3)
    assert 0.1 < np.std(error[fast]) < 0.2
    assert 0.2 < np.corrcoef(error[fast][1:], error[fast][:-1])[0, 1] < 0.8
    true_course = np.arctan2(drive.truth.v_n[:, 0], drive.truth.v_n[:, 1])
    swing = np.abs(np.angle(np.exp(1j * (fix[:, COURSE] - true_course))))
    assert swing[slow].mean() > 2 * swing[fast].mean()
    assert np.all((fix[:, COURSE] >= 0) & (fix[:, COURSE] < 2 * np.pi))
    still = fix[:, SPEED] < 0.5
    assert np.sum(still) > 50
    held = still[1:] & still[:-1]
    np.testing.assert_array_equal(np.diff(fix[:, COURSE])[held], 0)
    assert np.mean(np.abs(error[fast]) < 2 * fix[fast, SPEED_ACCURACY]) > 0.8
    assert np.all(fix[slow, COURSE_ACCURACY] > fix[fast, COURSE_ACCURACY].max())


def test_altitude_error_drifts_slowly() -> None:
    errors = []
    for seed in range(8):
        drive = simulate(replace(EXACT, route="parked", seconds=600, ideal=False, seed=seed))
        errors.append(drive.samples.fix[:, ALTITUDE])
    assert 1.5 < np.std([e[::1200] for e in errors]) < 5
    assert max(np.std(np.diff(e)) for e in errors) < 0.6


def test_vertical_speed_is_given_when_asked_for() -> None:
    scenario = replace(EXACT, route="hills")
    assert np.all(np.isnan(simulate(scenario).samples.fix[:, VERTICAL_SPEED]))
    drive = simulate(replace(scenario, vertical_speed=True))
    np.testing.assert_allclose(drive.samples.fix[:, VERTICAL_SPEED], drive.truth.v_n[:, 2], atol=1e-9)


def test_reversing_turns_the_course_about_and_keeps_the_heading() -> None:
    drive = simulate(replace(EXACT, reverse=True, seconds=40))
    back = drive.truth.speed < -0.8
    assert 5 < np.sum(back) < 60
    forward_n = quaternion.rotate(drive.truth.q_nv, [1.0, 0.0, 0.0])[back, :2]
    course = drive.samples.fix[back, COURSE]
    along = forward_n[:, 0] * np.sin(course) + forward_n[:, 1] * np.cos(course)
    assert np.all(along < -0.98)


def test_outages_are_reported_as_invalid_fixes() -> None:
    drive = simulate(Scenario(seconds=30, outages=((5, 10), (20, 21))))
    t, samples = drive.truth.t, drive.samples
    lost = ((t >= 5) & (t < 10)) | ((t >= 20) & (t < 21))
    np.testing.assert_array_equal(samples.fix_valid, ~lost)
    assert np.all(np.isnan(samples.fix[lost]))
    assert np.all(np.isfinite(samples.fix[~lost, SPEED]))


def test_remounting_turns_the_device_within_a_second() -> None:
    after = quaternion.from_angles(0.3, -0.2, 2.0)
    drive = simulate(replace(EXACT, route="straight", seconds=40, mount=[1, 0, 0, 0], remount=(20.0, after)))
    plain = simulate(replace(EXACT, route="straight", seconds=40, mount=[1, 0, 0, 0]))
    t, f_s, w_s = drive.samples.t, drive.samples.f_s, drive.samples.w_s
    before, later = t <= 20, t >= 20 + REMOUNT_SECONDS
    np.testing.assert_allclose(f_s[before], plain.samples.f_s[before], atol=1e-9)
    np.testing.assert_allclose(quaternion.rotate(after, f_s[later]), plain.samples.f_s[later], atol=1e-9)
    turned = np.array([1.0, 0, 0, 0])
    for w in w_s[~before & ~later] - plain.samples.w_s[~before & ~later]:
        turned = product(turned, quaternion.from_rotation_vector(w / 200))
    assert quaternion.angle_between(turned, after) < np.radians(1.0)
    np.testing.assert_allclose(drive.truth.mount_at(19.9), [1, 0, 0, 0])
    np.testing.assert_allclose(drive.truth.mount_at(20.0), after)


@pytest.mark.parametrize(("imu_rate", "gps_rate"), [(10, 1), (50, 20), (97.3, 0.5), (400, 10), (5, 10)])
def test_any_rates(imu_rate: float, gps_rate: float) -> None:
    drive = simulate(Scenario(seconds=20, imu_rate=imu_rate, gps_rate=gps_rate))
    assert len(drive.samples) == pytest.approx(20 * imu_rate, abs=1)
    assert drive.samples.fix_row.size == pytest.approx(20 * min(gps_rate, imu_rate), abs=2)
    np.testing.assert_array_equal(drive.truth.t, drive.samples.t[drive.samples.fix_row])


def test_jitter_moves_the_sampling_times_but_keeps_their_order() -> None:
    t = simulate(Scenario(seconds=20, jitter=2e-3)).samples.t
    assert 1e-3 < np.std(np.diff(t)) < 4e-3
    assert np.all(np.diff(t) > 0)


@pytest.mark.parametrize("route", MOVING)
def test_routes_are_driven_as_people_drive(route: str) -> None:
    drives = [simulate(replace(EXACT, route=route, seconds=400, imu_rate=50, seed=s)) for s in range(3)]
    for drive in drives:
        truth = drive.truth
        w_z = in_vehicle(drive, drive.samples.w_s)[drive.samples.fix_row, 2]
        ahead = np.gradient(truth.speed, truth.t)
        assert np.max(np.abs(ahead)) < 3.2
        assert np.max(np.abs(w_z * truth.speed)) < 4.0
        assert np.min(truth.speed) > -0.01
        roll, pitch, _ = np.degrees([quaternion.angles(q) for q in truth.q_nv]).T
        assert np.max(np.abs(roll)) < 9
        assert np.max(np.abs(pitch)) < 9


def statistics(route: str) -> dict[str, float]:
    """What tells routes apart, over a few drives."""
    drives = [simulate(replace(EXACT, route=route, seconds=600, imu_rate=20, seed=s)) for s in range(3)]
    speed = np.concatenate([d.truth.speed for d in drives])
    w_z = np.concatenate([in_vehicle(d, d.samples.w_s)[d.samples.fix_row, 2] for d in drives])
    up = np.concatenate([d.truth.v_n[:, 2] for d in drives])
    return {
        "mean": float(speed.mean()),
        "still": float(np.mean(speed < 0.1)),
        "turning": float(np.mean(np.abs(w_z) > 0.1)),
        "grade": float(np.sqrt(np.mean((up / np.maximum(speed, 1))[speed > 3] ** 2))),
    }


def test_routes_differ_as_their_names_say() -> None:
    of = {route: statistics(route) for route in MOVING}
    assert 4 < of["city"]["mean"] < 10
    assert 0.08 < of["city"]["still"] < 0.4
    assert of["city"]["turning"] > 0.05
    assert of["straight"]["turning"] < 0.001
    assert of["straight"]["still"] > 0.1
    assert of["motorway"]["mean"] > 25
    assert of["motorway"]["still"] < 0.03
    assert of["curves"]["turning"] > 0.35
    assert 0.008 < of["city"]["grade"] < 0.025
    assert 0.03 < of["hills"]["grade"] < 0.1


def test_the_roundabout_comes_after_a_straight() -> None:
    drive = simulate(replace(EXACT, route="roundabout", seconds=200))
    w_z = in_vehicle(drive, drive.samples.w_s)[drive.samples.fix_row, 2]
    t = drive.truth.t
    assert np.max(np.abs(w_z[t < 80])) < 0.05
    assert np.max(np.abs(w_z)) > 0.3


def test_without_relief_the_road_is_flat() -> None:
    drive = simulate(replace(EXACT, route="hills", relief=0.0))
    np.testing.assert_allclose(drive.truth.v_n[:, 2], 0, atol=1e-9)
    steady = np.abs(np.gradient(drive.truth.speed, drive.truth.t)) < 0.05
    pitch = np.array([quaternion.angles(q)[1] for q in drive.truth.q_nv])
    assert np.degrees(np.max(np.abs(pitch[steady]))) < 0.6


def test_vibration_grows_with_speed() -> None:
    drive = simulate(Scenario(route="straight", seconds=300, sensor="calibrated"))
    f_z = in_vehicle(drive, drive.samples.f_s)[:, 2]
    speed = np.interp(drive.samples.t, drive.truth.t, drive.truth.speed)
    shaking = np.abs(f_z - np.convolve(f_z, np.ones(200) / 200, "same"))
    still, fast = shaking[speed < 0.05].mean(), shaking[speed > 12].mean()
    assert 0.01 < still < 0.15
    assert 0.3 < fast < 1.2


def test_truth_goes_into_json() -> None:
    mount = np.array([1.0, 0, 0, 0])
    truth = simulate(Scenario(seconds=5, mount=mount, remount=(3.0, mount), outages=((1, 2),))).truth
    told = json.loads(json.dumps(truth.as_dict()))
    assert told["q_vs"] == [1, 0, 0, 0]
    assert told["remounted"] == {"t": 3.0, "q_vs": [1, 0, 0, 0]}
    assert told["scenario"]["outages"] == [[1, 2]]
    assert told["scenario"]["mount"] == [1, 0, 0, 0]
    assert told["latency"] == truth.latency
    np.testing.assert_allclose(told["lever_arm"], truth.lever_arm)


@pytest.mark.parametrize(
    ("scenario", "message"),
    [
        (Scenario(route="moon"), "no route 'moon'"),
        (Scenario(sensor="toy"), "no sensor 'toy'"),
        (Scenario(seconds=0), "seconds must be positive"),
        (Scenario(imu_rate=-1), "imu_rate must be positive"),
        (Scenario(gps_rate=float("nan")), "gps_rate must be positive"),
    ],
)
def test_what_cannot_be_simulated_is_refused(scenario: Scenario, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        simulate(scenario)
