"""Crashes, manoeuvres and jolts have the truth they say they have."""

import math
from dataclasses import replace

import numpy as np
import pytest

from core import quaternion
from core.samples import SPEED
from core.simulation import Drive, Scenario, simulate
from core.simulation_events import (
    DURATION,
    PEAK,
    SHAPES,
    VELOCITY_CHANGE,
    Crash,
    clipped,
    crash,
    draw_crash,
    manoeuvres,
)
from core.simulation_jolts import AT_REST, ON_THE_ROAD, add, fall, handle
from core.simulation_motion import GRAVITY

STILL = Scenario("parked", 20.0, 3, ideal=True, vibration=0.0, gyro=True, lever_arm=(1.2, 0, 0.3), latency=0.0)


@pytest.fixture(scope="module")
def drive() -> Drive:
    return simulate(STILL)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("direction", [0.0, 2.0, -3.0])
def test_the_pulse_changes_the_velocity_as_said(drive: Drive, shape: str, direction: float) -> None:
    hit = Crash(10.0, direction, 60.0, 0.1, shape, ringing=0.0)
    samples = crash(drive, hit, np.random.default_rng(1))
    f_v = samples.f_s @ quaternion.matrix(drive.truth.q_vs).T
    inside = (samples.t >= 10.0) & (samples.t < 10.0 + hit.duration)
    change = f_v[inside, :2].sum(axis=0) / STILL.imu_rate
    np.testing.assert_allclose(change, hit.velocity_change, atol=0.06 * np.hypot(*hit.velocity_change))
    assert np.hypot(*f_v[inside, :2].T).max() == pytest.approx(hit.peak, rel=0.2)
    assert math.atan2(*-hit.velocity_change[::-1]) == pytest.approx(direction)


def test_the_receiver_tells_of_the_slide(drive: Drive) -> None:
    hit = Crash(10.0, 0.3, 100.0, 0.1, friction=0.5, ringing=0.0)
    samples = crash(drive, hit, np.random.default_rng(1))
    t, speed = samples.t[samples.fix_row], samples.fix[:, SPEED]
    just_after = np.hypot(*hit.velocity_change)
    slid = just_after / (0.5 * GRAVITY)
    for moment in (0.3, 0.8, slid + 0.5):
        wanted = max(just_after - 0.5 * GRAVITY * (moment - hit.duration), 0)
        assert np.interp(10.0 + moment, t, speed) == pytest.approx(wanted, abs=0.5)


def test_a_push_beside_the_centre_spins_the_vehicle(drive: Drive) -> None:
    spins = []
    for offset in (0.4, -0.4, 0.0):
        hit = Crash(10.0, 0.0, 100.0, 0.1, offset=offset, ringing=0.0)
        w_v = crash(drive, hit, np.random.default_rng(1)).w_s @ quaternion.matrix(drive.truth.q_vs).T
        spins.append(w_v[np.searchsorted(drive.samples.t, 10.1), 2])
    assert spins[0] == pytest.approx(-spins[1])
    assert abs(spins[0]) > 0.5
    assert spins[2] == pytest.approx(0.0, abs=1e-9)


def test_before_the_crash_nothing_changes(drive: Drive) -> None:
    samples = crash(drive, Crash(10.0, 0.0, 100.0, 0.1), np.random.default_rng(1))
    before = drive.samples.t < 10.0
    np.testing.assert_array_equal(samples.f_s[before], drive.samples.f_s[before])
    assert not np.allclose(samples.f_s[~before], drive.samples.f_s[~before])


def test_without_a_gyroscope_there_is_none_afterwards() -> None:
    drive = simulate(replace(STILL, gyro=False))
    assert np.isnan(crash(drive, Crash(10.0, 0.0, 100.0, 0.1), np.random.default_rng(1)).w_s).all()


def test_drawn_crashes_stay_in_their_limits() -> None:
    rng = np.random.default_rng(4)
    hits = [draw_crash(5.0, rng) for _ in range(300)]
    for low_high, values in (
        (PEAK, [hit.peak for hit in hits]),
        (DURATION, [hit.duration for hit in hits]),
        (VELOCITY_CHANGE, [np.hypot(*hit.velocity_change) for hit in hits]),
        ((-math.pi, math.pi), [hit.direction for hit in hits]),
    ):
        assert low_high[0] <= min(values) <= max(values) <= low_high[1]
    assert {hit.shape for hit in hits} == set(SHAPES)


def test_clipped_readings_end_at_the_range(drive: Drive) -> None:
    samples = clipped(crash(drive, Crash(10.0, 0.0, 300.0, 0.1), np.random.default_rng(1)), 80.0)
    assert np.abs(samples.f_s).max() == 80.0


def test_manoeuvres_are_harsh_and_not() -> None:
    drive = manoeuvres(13, 300.0)
    assert drive.a_v[:, 0].min() < -5
    assert drive.a_v[:, 0].max() > 3.5
    assert 4.5 < np.abs(drive.a_v[:, 1]).max() < 9
    assert 2000 < drive.metres < 6000
    assert np.isnan(manoeuvres(1, 10.0, gyro=False).samples.w_s).all()


def test_what_is_felt_is_the_motion_and_gravity() -> None:
    drive = manoeuvres(2, 120.0)
    f_v = drive.samples.f_s @ quaternion.matrix(drive.q_vs).T
    smooth = [np.convolve(a, np.full(100, 0.01), "same") for a in (*f_v.T[:2], *drive.a_v.T)]
    for felt, true in zip(smooth[:2], smooth[2:], strict=True):
        assert np.corrcoef(felt, true)[0, 1] > 0.95
    assert f_v[:, 2].mean() == pytest.approx(GRAVITY, abs=0.5)


@pytest.mark.parametrize("name", [name for name in ON_THE_ROAD | AT_REST if name != "emergency brakings"])
def test_jolts_hardly_change_the_velocity(name: str) -> None:
    rng = np.random.default_rng(6)
    for _ in range(20):
        jolt = (ON_THE_ROAD | AT_REST)[name](200.0, rng)
        assert jolt.shape[1] == 6
        change = np.hypot(*jolt[:, :2].sum(axis=0)) / 200
        assert change < (4.0 if len(jolt) > 1000 else 2.0)  # noise, for half a minute


def test_jolts_are_added_in_the_sensor_axes(drive: Drive) -> None:
    jolt = np.zeros((10, 6))
    jolt[:, 2] = 5.0
    samples = add(drive.samples, drive.truth.q_vs, [(3.0, jolt), (19.98, jolt)])
    f_v = samples.f_s @ quaternion.matrix(drive.truth.q_vs).T
    row = int(np.searchsorted(samples.t, 3.0))
    level = quaternion.matrix(drive.truth.q_nv[0])[2, 2] * GRAVITY
    np.testing.assert_allclose(f_v[row : row + 10, 2], level + 5.0, atol=1e-6)
    assert len(samples) == len(drive.samples)


def test_a_device_that_fell_lies_otherwise(drive: Drive) -> None:
    samples = fall(drive.samples, 5.0, np.random.default_rng(2))
    size = np.linalg.norm(samples.f_s, axis=1)
    assert size[(samples.t > 5) & (samples.t < 7)].min() < 2.0
    assert size.max() > 30.0
    before, after = samples.f_s[100], samples.f_s[-1]
    assert size[-1] == pytest.approx(GRAVITY, abs=0.1)
    assert before @ after < 0.9 * GRAVITY**2


def test_a_device_put_back_reads_as_before(drive: Drive) -> None:
    samples = handle(drive.samples, 3.0, np.random.default_rng(2))
    np.testing.assert_allclose(samples.f_s[-1], drive.samples.f_s[-1], atol=1e-6)
    assert not np.allclose(samples.f_s[800], drive.samples.f_s[800], atol=1.0)
