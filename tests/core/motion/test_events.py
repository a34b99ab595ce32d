"""Impacts, harsh driving and potholes on simulated drives whose truth is known."""

import math
from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

from core import SnapshotError, quaternion, thresholds
from core.motion.events import (
    DEFAULT,
    EventKind,
    MotionEvent,
    State,
    advance,
    begin_session,
    decode,
    encode,
    initial_state,
)
from core.samples import Samples
from core.simulation import Drive, Scenario, simulate
from core.simulation_events import Crash, clipped, crash, manoeuvres
from core.simulation_jolts import AT_REST, ON_THE_ROAD, Jolt, add, fall, handle, pothole
from core.simulation_motion import GRAVITY
from tests.core.drives import UNCOMPILED

Floats = NDArray[np.float64]

SECONDS = 20.0
SIDES = {"front": 0.0, "left": math.pi / 2, "rear": math.pi, "right": -math.pi / 2, "front left": math.pi / 4}
HIT = Crash(12.3, 0.0, 10 * GRAVITY, 0.1)


@cache
def drive(route: str = "city", rate: float = 200.0, gyro: bool = True, seed: int = 11) -> Drive:
    return simulate(Scenario(route, SECONDS, seed, imu_rate=rate, gyro=gyro))


def crashed(hit: Crash, route: str = "city", rate: float = 200.0) -> tuple[Samples, Floats]:
    there = drive(route, rate)
    return crash(there, hit, np.random.default_rng(1)), there.truth.q_vs


def told(samples: Samples, q_vs: Floats, kind: EventKind | None = None) -> list[MotionEvent]:
    _, events = advance(DEFAULT, initial_state(), q_vs, samples)
    return [event for event in events if kind in (None, event.kind)]


def angle(one: float, other: float) -> float:
    return math.degrees(abs((one - other + math.pi) % (2 * math.pi) - math.pi))


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("route", ["city", "parked"])
def test_an_impact_is_told_with_its_direction(side: str, route: str) -> None:
    samples, q_vs = crashed(HIT._replace(direction=SIDES[side]), route=route)
    (event,) = told(samples, q_vs, EventKind.IMPACT)
    assert angle(event.direction, SIDES[side]) < 8
    assert event.t == pytest.approx(HIT.t + HIT.duration / 2, abs=0.04)
    assert event.start == pytest.approx(HIT.t, abs=0.03)
    assert event.peak == pytest.approx(HIT.peak, rel=0.35)
    assert event.duration == pytest.approx(HIT.duration, rel=0.5)
    wanted = HIT._replace(direction=SIDES[side]).velocity_change
    np.testing.assert_allclose(event.velocity_change, wanted, atol=0.15 * np.hypot(*wanted))


def test_the_speed_before_an_impact_is_told() -> None:
    samples, q_vs = crashed(HIT)
    (event,) = told(samples, q_vs, EventKind.IMPACT)
    truth = drive().truth
    assert event.speed == pytest.approx(np.interp(HIT.t, truth.t, truth.speed), abs=2)
    silent = replace(samples, fix_valid=np.zeros_like(samples.fix_valid))
    assert math.isnan(told(silent, q_vs, EventKind.IMPACT)[0].speed)


@pytest.mark.parametrize("rate", [50.0, 100.0, 400.0])
def test_impacts_are_told_at_any_rate_that_shows_them(rate: float) -> None:
    samples, q_vs = crashed(HIT, rate=rate)
    (event,) = told(samples, q_vs, EventKind.IMPACT)
    assert angle(event.direction, 0.0) < 8


def test_impacts_are_not_told_at_a_rate_that_does_not_show_them() -> None:
    samples, q_vs = crashed(HIT, rate=25.0)
    assert not told(samples, q_vs, EventKind.IMPACT)


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("direction", [0.5, -2.4])
def test_a_clipped_impact_keeps_its_direction(seed: int, direction: float) -> None:
    hit = Crash(12.3, direction, 25 * GRAVITY, 0.1, ringing=0.1)
    there = drive(seed=seed)  # the seed chooses the mounting, and with it which axes are at their end
    samples = clipped(crash(there, hit, np.random.default_rng(seed)), 8 * GRAVITY)
    (event,) = told(samples, there.truth.q_vs, EventKind.IMPACT)
    assert angle(event.direction, direction) < 20
    assert event.peak < hit.peak


def test_the_sign_of_the_quaternion_does_not_matter() -> None:
    samples, q_vs = crashed(HIT)
    assert told(samples, q_vs) == told(samples, -q_vs)


@pytest.mark.compiled
@pytest.mark.parametrize("name", ["potholes", "kerbs", "speed humps", "rough stretches", "knocks at the device"])
@pytest.mark.parametrize("gyro", [True, False])
def test_roads_and_knocks_are_no_impacts(name: str, gyro: bool) -> None:
    assert not _impacts_of(ON_THE_ROAD[name], drive("city", gyro=gyro), 40)


@pytest.mark.compiled
@pytest.mark.parametrize("name", AT_REST)
def test_doors_and_water_are_no_impacts(name: str) -> None:
    assert not _impacts_of(AT_REST[name], drive("parked"), 40)


def test_emergency_braking_is_harsh_and_no_impact() -> None:
    there, rng = drive("motorway"), np.random.default_rng(5)
    for _ in range(10):
        jolts = [(rng.uniform(8, 14), ON_THE_ROAD["emergency brakings"](200.0, rng))]
        events = told(add(there.samples, there.truth.q_vs, jolts), there.truth.q_vs)
        assert [event.kind for event in events] == [EventKind.HARSH_BRAKING]
        assert angle(events[0].direction, 0.0) < 15


def _impacts_of(jolt: Jolt, there: Drive, count: int) -> list[MotionEvent]:
    rng, found = np.random.default_rng(3), list[MotionEvent]()
    for _ in range(count // 4):
        jolts = [(t + rng.uniform(0, 1), jolt(200.0, rng)) for t in (2.0, 6.0, 10.0, 14.0)]
        found += told(add(there.samples, there.truth.q_vs, jolts), there.truth.q_vs, EventKind.IMPACT)
    return found


@pytest.mark.compiled
@pytest.mark.parametrize("gyro", [True, False])
def test_a_device_that_falls_off_is_no_impact(gyro: bool) -> None:
    there = drive("parked", gyro=gyro)
    for seed in range(20):
        samples = fall(there.samples, 8.0, np.random.default_rng(seed))
        assert not told(samples, there.truth.q_vs, EventKind.IMPACT)


@pytest.mark.compiled
def test_a_device_turned_in_hand_tells_nothing() -> None:
    there, q_vs = drive("parked"), drive("parked").truth.q_vs
    silent = sum(not told(handle(there.samples, 8.0, np.random.default_rng(seed)), q_vs) for seed in range(20))
    assert silent >= 19


def test_a_jolt_along_the_vertical_is_a_pothole() -> None:
    there = drive("motorway")
    jolt = np.zeros((60, 6))
    jolt[:8, 2] = -20 * np.sin(np.pi * np.arange(8) / 8)
    jolt[8:16, 2] = 30 * np.sin(np.pi * np.arange(8) / 8)
    (event,) = told(add(there.samples, there.truth.q_vs, [(12.0, jolt)]), there.truth.q_vs)
    assert event.kind == EventKind.POTHOLE
    assert event.t == pytest.approx(12.0, abs=0.1)
    assert math.isnan(event.direction)
    assert not told(add(there.samples, there.truth.q_vs, [(1.0, jolt)]), there.truth.q_vs)  # it still stands


def test_manoeuvres_are_told_where_they_are_harsh() -> None:
    drive_ = manoeuvres(13, 300.0)
    events = told(drive_.samples, drive_.q_vs)
    forward, left = (np.convolve(a, np.full(40, 1 / 40), "same") for a in drive_.a_v.T)
    signal = {
        EventKind.HARSH_BRAKING: (-forward, DEFAULT.harsh_braking),
        EventKind.HARSH_ACCELERATION: (forward, DEFAULT.harsh_acceleration),
        EventKind.HARSH_CORNERING: (np.abs(left), DEFAULT.harsh_cornering),
    }
    assert {event.kind for event in events} == set(signal)
    assert min(event.start for event in events) > DEFAULT.harsh_settling
    for event in events:
        values, threshold = signal[event.kind]
        there = values[(drive_.t > event.start - 0.3) & (drive_.t < event.start + event.duration + 0.3)]
        assert there.max() > 0.9 * threshold
        assert event.peak == pytest.approx(there.max(), rel=0.15)
    for kind, (values, threshold) in signal.items():
        times = [(e.start - 0.3, e.start + e.duration + 0.3) for e in events if e.kind == kind]
        inside = np.any([(drive_.t > a) & (drive_.t < b) for a, b in times], axis=0)
        assert values[~inside].max() < 1.15 * threshold


def test_bends_push_from_the_other_side() -> None:
    drive_ = manoeuvres(13, 300.0)
    for event in told(drive_.samples, drive_.q_vs, EventKind.HARSH_CORNERING):
        left = drive_.a_v[np.searchsorted(drive_.t, event.t), 1]
        assert math.copysign(1, math.sin(event.direction)) == -math.copysign(1, left)


def _in_pieces(samples: Samples, q_vs: Floats, cuts: list[int]) -> tuple[State, list[MotionEvent]]:
    state, events, ends = initial_state(), list[MotionEvent](), [0, *cuts, len(samples)]
    for first, last in pairwise(ends):
        state, more = advance(DEFAULT, decode(encode(state)), q_vs, samples.slice(first, last))
        events += more
    return state, events


def test_pieces_tell_what_the_whole_tells() -> None:
    drive_ = manoeuvres(4, 40.0 if UNCOMPILED else 200.0)
    rng = np.random.default_rng(2)
    jolts = [(float(t), pothole(100.0, rng)) for t in np.arange(12, 190, 9.7)]
    samples = add(drive_.samples, drive_.q_vs, jolts)
    state, whole = advance(DEFAULT, initial_state(), drive_.q_vs, samples)
    assert len(whole) > 1
    for count in (1, 7, 300):
        cuts = sorted(rng.choice(len(samples), count, replace=False).tolist())
        there, pieces = _in_pieces(samples, drive_.q_vs, cuts)
        assert [repr(event) for event in pieces] == [repr(event) for event in whole]
        assert encode(there) == encode(state)


def test_no_event_is_lost_when_there_are_many(monkeypatch: pytest.MonkeyPatch) -> None:
    drive_, rng = manoeuvres(13, 100.0), np.random.default_rng(2)
    samples = add(drive_.samples, drive_.q_vs, [(float(t), pothole(100.0, rng)) for t in np.arange(12, 95, 3.1)])
    whole = told(samples, drive_.q_vs)
    monkeypatch.setattr("core.motion.events.ROWS", 8)
    assert len(whole) > 8
    assert [repr(event) for event in told(samples, drive_.q_vs)] == [repr(event) for event in whole]


def test_samples_that_come_late_are_left_out() -> None:
    samples, q_vs = crashed(HIT)
    state, _ = advance(DEFAULT, initial_state(), q_vs, samples)
    again, events = advance(DEFAULT, state, q_vs, samples.slice(0, 3000))
    assert not events
    assert again["t"] == state["t"]
    assert again["offset"].tolist() == state["offset"].tolist()


@pytest.mark.parametrize("milliseconds", [60, 90, 150, 400, 1500])
def test_an_impact_at_the_end_of_the_samples_is_told_at_once_and_once(milliseconds: int) -> None:
    samples, q_vs = crashed(HIT)
    (whole,) = told(samples, q_vs, EventKind.IMPACT)
    cut = int(np.searchsorted(samples.t, HIT.t + milliseconds / 1000))
    before = told(samples.slice(0, cut), q_vs, EventKind.IMPACT)
    _, both = _in_pieces(samples, q_vs, [cut])
    (event,) = [event for event in both if event.kind == EventKind.IMPACT]
    assert [event] == before
    assert angle(event.direction, whole.direction) < 15
    assert milliseconds < 150 or event == whole


def test_samples_one_by_one_tell_an_impact_once() -> None:
    samples, q_vs = crashed(HIT, rate=100.0)
    _, events = _in_pieces(samples, q_vs, list(range(1, len(samples))))
    assert sum(event.kind == EventKind.IMPACT for event in events) == 1


def test_a_gap_ends_what_was_going_on() -> None:
    samples, q_vs = crashed(HIT)
    cut = int(np.searchsorted(samples.t, HIT.t + 0.15))
    later = replace(samples, t=np.where(np.arange(len(samples)) < cut, samples.t, samples.t + 30.0))
    (event,) = told(later, q_vs, EventKind.IMPACT)
    assert event.t < HIT.t + 0.15


def test_repeated_rows_change_nothing() -> None:
    samples, q_vs = crashed(HIT)
    twice = Samples.make(*(np.repeat(a, 2, axis=0) for a in (samples.t, samples.f_s, samples.w_s)))
    once = Samples.make(samples.t, samples.f_s, samples.w_s)
    assert [repr(e) for e in told(twice, q_vs)] == [repr(e) for e in told(once, q_vs)]


def test_a_new_session_forgets_the_clock() -> None:
    samples, q_vs = crashed(HIT)
    state, first = advance(DEFAULT, initial_state(), q_vs, samples)
    before = encode(state)
    _, second = advance(DEFAULT, begin_session(state), q_vs, samples)
    assert [event.kind for event in second] == [event.kind for event in first]
    assert second[0].t == pytest.approx(first[0].t, abs=0.02)
    assert encode(state) == before


def test_snapshots() -> None:
    data = encode(initial_state())
    assert len(data) < 1000
    assert encode(decode(data)) == data
    spoilt = {
        b"": "not a snapshot",
        b"LVLA" + data[4:]: "not a snapshot",
        data[:4] + b"\xff\x00" + data[6:]: "version 255",
        data[:6] + b"otherlay" + data[14:]: "cannot be read",
        data[:-1]: "expected",
    }
    for other, message in spoilt.items():
        with pytest.raises(SnapshotError, match=message):
            decode(other)


def test_thresholds_can_be_listed() -> None:
    listed = {threshold.name: threshold for threshold in thresholds(DEFAULT)}
    assert listed["impact_peak"].unit == "m/s2"
    assert listed["harsh_braking"].value == DEFAULT.harsh_braking


def test_the_mounting_is_used() -> None:
    samples, q_vs = crashed(HIT)
    turned = quaternion.multiply(quaternion.from_rotation_vector(np.array([0, 0, math.pi / 2])), q_vs)
    (right,), (wrong,) = (told(samples, q, EventKind.IMPACT) for q in (q_vs, turned))
    assert angle(wrong.direction, right.direction + math.pi / 2) < 1


def test_nothing_harsh_is_told_before_the_slope_is_known() -> None:
    there = drive("city")
    push = np.zeros((200, 6))
    push[:, 0] = 6.0
    early, late = (add(there.samples, there.truth.q_vs, [(t, push)]) for t in (1.0, 14.0))
    kinds = [[event.kind for event in told(samples, there.truth.q_vs)] for samples in (early, late)]
    assert kinds == [[], [EventKind.HARSH_ACCELERATION]]
