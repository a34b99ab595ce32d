"""Hard drives: each fault does what it says and nothing else, and drives without faults are what they always were."""

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from core import quaternion
from core.samples import ALTITUDE, COURSE, SPEED, Samples
from core.simulation import Drive, Scenario, simulate, simulate_sessions
from core.simulation_faults import JUMP_SPEED, LONGEST_GAP, Disturbances
from core.simulation_motion import GRAVITY

Floats = NDArray[np.float64]

TOWN = Scenario(seconds=60, seed=5, imu_rate=50)
QUIET = replace(TOWN, ideal=True, vibration=0, latency=0, lever_arm=(0, 0, 0), gyro=True)


def with_faults(scenario: Scenario = TOWN, **faults: Any) -> Samples:
    return simulate(replace(scenario, disturbances=Disturbances(**faults))).samples


def same(one: Samples, other: Samples, *names: str) -> bool:
    return all(np.array_equal(getattr(one, n), getattr(other, n), equal_nan=True) for n in names)


@pytest.mark.parametrize(
    ("scenario", "golden"),
    [
        (
            Scenario(seconds=30, seed=5),
            [1.5179748710357077, -7.9798151191225815, 5.500778891545034, 7.541920506079885, 4.601168929405193],
        ),
        (
            Scenario("hills", 40, 7, sensor="tmd2", jitter=1e-3, outages=((5, 9),), reverse=True),
            [7.5599464850001885, -4.403860057187538, 4.155065346687546, 5.3909080649693335, 3.9194150718772085],
        ),
        (
            Scenario("motorway", 30, 9, gyro=False, imu_rate=97.3, gps_rate=1),
            [2.8208312485458786, 1.1724885487606584, -9.440120945027873, 7.4842291038125985, 2.6159924410153668],
        ),
        (
            Scenario("roundabout", 60, 3, remount=(20.0, (1, 0, 0, 0))),
            [0.6811453626126549, -1.495641982267341, 9.482105225250548, 13.067821255956165, 4.750030318337843],
        ),
    ],
)
def test_drives_without_faults_stay_the_drives_they_were(scenario: Scenario, golden: list[float]) -> None:
    samples = simulate(scenario).samples
    means = [*samples.f_s.mean(axis=0), np.nanmean(samples.fix[:, SPEED]), np.nanmean(samples.fix[:, COURSE])]
    np.testing.assert_allclose(means, golden, rtol=1e-12)


@pytest.mark.parametrize(
    ("faults", "untouched"),
    [
        ({"bias_drift": 0.1}, ("t", "fix_row", "fix")),
        ({"knocks": ((20, (0.0, 0.0, 0.5)),)}, ("t", "fix_row", "fix")),
        ({"signs": (-1, -1, -1)}, ("t", "w_s", "fix_row", "fix")),
        ({"gyro_signs": (-1, 1, 1)}, ("t", "f_s", "fix_row", "fix")),
        ({"full_scale": 8.0}, ("t", "w_s", "fix_row", "fix")),
        ({"stuck": (1, 20.0)}, ("t", "w_s", "fix_row", "fix")),
        ({"multipath": 3.0}, ("t", "f_s", "w_s", "fix_row")),
        ({"jumps": 3}, ("t", "f_s", "w_s", "fix_row")),
        ({"frozen_course": ((20, 30),)}, ("t", "f_s", "w_s", "fix_row")),
        ({"no_altitude": True}, ("t", "f_s", "w_s", "fix_row")),
        ({"altitude_noise": 5.0}, ("t", "f_s", "w_s", "fix_row")),
        ({"dropped": 0.1}, ("fix", "fix_valid")),
        ({"duplicated": 0.1}, ("fix", "fix_valid")),
        ({"clock_steps": ((20, 5),)}, ("f_s", "w_s", "fix", "fix_row")),
    ],
)
def test_a_fault_changes_what_it_is_about_and_only_that(faults: dict[str, Any], untouched: tuple[str, ...]) -> None:
    plain, spoilt, again = simulate(TOWN).samples, with_faults(TOWN, **faults), with_faults(TOWN, **faults)
    assert same(plain, spoilt, *untouched)
    assert not same(plain, spoilt, "t", "f_s", "w_s", "fix")
    assert same(spoilt, again, "t", "f_s", "w_s", "fix_row", "fix_valid", "fix")


def test_faults_are_drawn_apart() -> None:
    alone, together = with_faults(multipath=3.0), with_faults(multipath=3.0, dropped=0.2, bias_drift=0.1)
    assert same(alone, together, "fix")


def test_multipath_comes_in_bursts_of_several_metres_per_second() -> None:
    scenario = replace(QUIET, seconds=600, route="constant")
    error = with_faults(scenario, multipath=3.0).fix[:, SPEED] - simulate(scenario).samples.fix[:, SPEED]
    hit = np.abs(error) > 1e-9
    assert 0.1 < hit.mean() < 0.6
    assert 1.5 < np.std(error[hit]) < 5
    assert np.corrcoef(error[hit][1:], error[hit][:-1])[0, 1] > 0.9


def test_jumps_are_single_wild_fixes() -> None:
    error = with_faults(QUIET, jumps=4).fix[:, SPEED] - simulate(QUIET).samples.fix[:, SPEED]
    assert np.sum(np.abs(error) > JUMP_SPEED[0]) == 4
    assert np.sum(np.abs(error) > 0) == 4


def test_a_frozen_course_repeats_itself() -> None:
    samples = with_faults(frozen_course=((20, 30),))
    t = samples.t[samples.fix_row]
    assert np.ptp(samples.fix[(t >= 20) & (t < 30), COURSE]) == 0
    assert np.ptp(samples.fix[t >= 30, COURSE]) > 0


def test_altitude_can_be_missing_or_poor() -> None:
    assert np.all(np.isnan(with_faults(no_altitude=True).fix[:, ALTITUDE]))
    still = replace(TOWN, route="parked", seconds=300)
    fine, poor = (np.ptp(with_faults(still, altitude_noise=x).fix[:, ALTITUDE]) for x in (1.0, 5.0))
    assert poor == pytest.approx(5 * fine, rel=0.1)


def test_a_saturated_axis_rests_at_its_end_and_a_stuck_one_at_its_value() -> None:
    assert np.max(np.abs(with_faults(full_scale=8.0).f_s)) == 8.0
    stuck = with_faults(stuck=(1, 20.0))
    assert np.ptp(stuck.f_s[stuck.t >= 20, 1]) == 0
    assert np.ptp(stuck.f_s[stuck.t < 20, 1]) > 0


def test_a_sensor_can_be_left_handed() -> None:
    plain = simulate(TOWN).samples
    np.testing.assert_array_equal(with_faults(signs=(-1, -1, -1)).f_s, -plain.f_s)
    np.testing.assert_array_equal(with_faults(gyro_signs=(1, -1, 1)).w_s, plain.w_s * [1, -1, 1])


def test_lost_rows_leave_gaps_and_every_fix_its_sample() -> None:
    plain, spoilt = simulate(TOWN).samples, with_faults(dropped=0.1)
    assert 0.03 < 1 - len(spoilt) / len(plain) < 0.2
    assert np.diff(spoilt.t).max() <= (LONGEST_GAP + 1) / TOWN.imu_rate + 1e-9
    np.testing.assert_array_equal(spoilt.t[spoilt.fix_row], plain.t[plain.fix_row])


def test_rows_logged_twice_have_the_same_time() -> None:
    plain, spoilt = simulate(TOWN).samples, with_faults(duplicated=0.1)
    twice = np.diff(spoilt.t) == 0
    assert np.sum(twice) == len(spoilt) - len(plain) > 0
    np.testing.assert_array_equal(spoilt.f_s[1:][twice], spoilt.f_s[:-1][twice])
    np.testing.assert_array_equal(spoilt.t[spoilt.fix_row], plain.t[plain.fix_row])


def test_the_clock_steps_forward_and_the_truth_with_it() -> None:
    drive = simulate(replace(TOWN, disturbances=Disturbances(clock_steps=((20, 5), (40, 60)))))
    steps = np.diff(drive.samples.t)
    np.testing.assert_allclose(np.sort(steps)[-2:], [5.02, 60.02])
    np.testing.assert_array_equal(drive.truth.t, drive.samples.t[drive.samples.fix_row])


def test_the_bias_drifts_through_a_night() -> None:
    night = Scenario(
        "parked", 3 * 3600, imu_rate=1, gps_rate=0.1, vibration=0, disturbances=Disturbances(bias_drift=0.1)
    )
    f_s = simulate(night).samples.f_s
    first, last = f_s[:200].mean(axis=0), f_s[5000:5200].mean(axis=0)
    assert 0.02 < np.linalg.norm(last - first) < 0.4


def test_a_bias_can_drift_quickly() -> None:
    still = replace(QUIET, route="parked", seconds=120)
    drift = with_faults(still, bias_drift=0.5, drift_period=30.0).f_s - simulate(still).samples.f_s
    assert np.all(np.ptp(drift, axis=0) == pytest.approx(1.0, abs=0.01))
    period = int(30 * TOWN.imu_rate)
    np.testing.assert_allclose(drift[:-period], drift[period:], atol=1e-9)


def test_a_device_that_was_knocked_reads_as_one_mounted_so() -> None:
    first, second = np.array([0.3, -0.2, 0.5]), np.array([-0.1, 0.4, 0.2])
    knocked = with_faults(QUIET, knocks=((20.0, tuple(first)), (40.0, tuple(second))))
    mount = simulate(QUIET).truth.q_vs
    for start, turn in ((0.0, None), (20.0, first), (40.0, second)):
        if turn is not None:
            mount = quaternion.multiply(mount, quaternion.from_rotation_vector(turn))
        mounted = simulate(replace(QUIET, mount=mount)).samples
        now = (knocked.t >= start) & (knocked.t < start + 20.0)
        np.testing.assert_allclose(knocked.f_s[now], mounted.f_s[now], atol=1e-9)
        np.testing.assert_allclose(knocked.w_s[now], mounted.w_s[now], atol=1e-9)


def attitudes(drive: Drive) -> tuple[Floats, Floats, Floats]:
    """Roll, pitch, yaw, degrees."""
    roll, pitch, yaw = np.degrees([quaternion.angles(q) for q in drive.truth.q_nv]).T
    return roll, pitch, yaw


def test_on_a_ferry_the_car_rolls_and_does_not_look_where_it_goes() -> None:
    between = []
    for seed in range(3):
        drive = simulate(replace(QUIET, route="ferry", seconds=600, seed=seed))
        roll, pitch, yaw = attitudes(drive)
        under_way = drive.truth.speed > 6
        assert 6 < drive.truth.speed[under_way].mean() < 9.5
        assert 0.8 < np.std(roll) < 2.5
        assert 0.8 < np.std(pitch) < 2.5
        upward = np.sum((roll[1:] > 0) & (roll[:-1] <= 0))
        assert 6 < 600 / upward < 12
        drift = np.radians(yaw) - np.arctan2(drive.truth.v_n[:, 1], drive.truth.v_n[:, 0])
        assert np.std(np.angle(np.exp(1j * (drift - drift[-1])))[under_way]) < 0.05
        between.append(np.degrees(np.angle(np.exp(1j * drift[-1]))))
    assert np.ptp(between) > 10


def test_steep_hills_are_steep() -> None:
    truth = simulate(replace(QUIET, route="steep", seconds=600)).truth
    grade = np.abs(np.tan(np.arcsin(truth.v_n[:, 2] / np.maximum(truth.speed, 3))))
    assert 0.15 < grade.max() < 0.21


def test_at_constant_speed_nothing_happens_to_speed_or_course() -> None:
    truth = simulate(replace(QUIET, route="constant", seconds=300)).truth
    cruising = truth.t > 100
    assert truth.speed[cruising].mean() > 20
    assert np.std(truth.speed[cruising]) < 0.2
    course = np.unwrap(np.arctan2(truth.v_n[cruising, 0], truth.v_n[cruising, 1]))
    assert np.degrees(np.ptp(course)) < 5


def test_crawling_is_walking_pace_stop_and_go() -> None:
    speed = simulate(replace(QUIET, route="crawl", seconds=300)).truth.speed
    assert 1 < speed.max() < 2.2
    assert 0.1 < np.mean(speed < 0.1) < 0.8


def test_a_towed_car_has_its_nose_up() -> None:
    assert np.mean(attitudes(simulate(replace(QUIET, route="towed")))[1]) == pytest.approx(-8, abs=0.7)


def test_sessions_keep_the_device_and_change_the_drive() -> None:
    drives = simulate_sessions(TOWN, 3)
    assert same(drives[0].samples, simulate(TOWN).samples, "t", "f_s", "fix")
    for drive in drives[1:]:
        for name in ("q_vs", "bias", "scale", "gyro_bias", "lever_arm"):
            np.testing.assert_array_equal(getattr(drive.truth, name), getattr(drives[0].truth, name))
        assert drive.samples.t[0] == 0
    assert not np.allclose(drives[1].truth.speed, drives[2].truth.speed)


def test_faults_go_into_json() -> None:
    faults = Disturbances(full_scale=2 * GRAVITY, frozen_course=((1, 2),), stuck=(0, 3.0))
    told = json.loads(json.dumps(simulate(Scenario(seconds=5, disturbances=faults)).truth.as_dict()))
    assert told["scenario"]["disturbances"]["full_scale"] == 2 * GRAVITY
    assert told["scenario"]["disturbances"]["frozen_course"] == [[1, 2]]
