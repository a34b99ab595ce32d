"""The rules by themselves: steps over what is seen of chunks."""

import json
import time
from datetime import UTC, datetime, timedelta
from typing import Any, get_args

import numpy as np
import pytest

import core
from api import schemas
from api.services import rules
from api.services.rules import (
    Limits,
    Seen,
    Watch,
    device_loose,
    device_silent,
    harsh_driving,
    sensor_fault,
    verification_failing,
)
from api.services.rules.seen import see
from api.settings import Settings
from core import EventKind, Fault, Stage
from core.motion.events import EventKind as MotionKind
from core.motion.events import MotionEvent
from tests.watched import drive, parked

NOW = datetime(2024, 5, 6, 7, 8, 9, tzinfo=UTC)
LIMITS = Limits()


def seen(**known: Any) -> Seen:
    """Give a minute of driving."""
    usual = Seen("a", 1, NOW, NOW, 0.0, 60.0, 6000, 0, 0, 60.0, 60.0, 60.0, Stage.SETTLING, ("turn",), (), ())
    return usual._replace(**known)


def event(kind: EventKind, fault: Fault | None = None) -> core.Event:
    return core.Event(1.0, kind, None, None, None, None, None, fault=fault)


def summed(samples: core.Samples) -> Seen:
    state = core.begin_session(core.DEFAULT, core.initial_state(core.DEFAULT))
    outcome = core.advance(core.DEFAULT, state, samples)[1]
    return see((1, "a", NOW), samples, outcome, (), NOW)


def test_a_chunk_summed_up() -> None:
    town = summed(drive("city", 120.0))
    assert town.span == pytest.approx(120, abs=0.1)
    assert town.with_fix == pytest.approx(120, abs=0.5)
    assert 60 < town.driving < 119
    still = summed(parked(7.0))
    assert (still.t_first, still.t_last, still.driving) == (7.0, 66.5, 0.0)
    assert summed(parked(0.0, fix=False)).with_fix == 0


def test_holes_in_a_chunk_are_not_counted() -> None:
    chunk = parked(0.0)
    t = chunk.t + np.where(chunk.t >= 30.0, 5000.0, 0.0)
    holed = core.Samples.make(t, chunk.f_s, None, chunk.fix_row, chunk.fix_valid, chunk.fix)
    assert summed(holed).span == pytest.approx(59.0)
    assert summed(holed).with_fix <= 59.0


def test_a_receiver_without_speed_drives_when_the_estimator_says_so() -> None:
    chunk = parked(0.0)
    fix = chunk.fix.copy()
    fix[:, core.FIX_COLUMNS.index("speed")] = np.nan
    fix[:, 0] = 1e-5 * np.arange(len(fix))  # rad, 64 m/s
    fix[:, 1] = 0.0
    north = core.Samples.make(chunk.t, chunk.f_s, None, chunk.fix_row, chunk.fix_valid, fix)
    assert summed(north).driving == summed(north).with_fix > 50
    fix[:, 0] = 0.0
    assert summed(core.Samples.make(chunk.t, chunk.f_s, None, chunk.fix_row, chunk.fix_valid, fix)).driving == 0


def test_a_loose_device_must_hold_and_starts_over_when_it_moves() -> None:
    memory, verdict = device_loose.step(
        device_loose.Memory(), seen(events=(event(EventKind.FAULT, Fault.DEVICE_LOOSE),)), LIMITS
    )
    assert (memory.told, verdict) == (True, None)
    confirmed = seen(stage=Stage.CONFIRMED)
    for chunk in [*[confirmed] * 29, seen(), *[confirmed] * 29]:
        memory, verdict = device_loose.step(memory, chunk, LIMITS)
        assert verdict is None
    memory, verdict = device_loose.step(memory, confirmed, LIMITS)
    assert (memory, verdict is not None) == (device_loose.Memory(), True)


def test_a_sensor_must_be_sound_and_starts_over_with_every_fault() -> None:
    memory, _ = sensor_fault.step(
        sensor_fault.Memory(), seen(events=(event(EventKind.FAULT, Fault.SATURATED),)), LIMITS
    )
    for chunk in [*[seen()] * 4, seen(faults=(Fault.SATURATED,)), *[seen()] * 4, seen(driving=0.0)]:
        memory, verdict = sensor_fault.step(memory, chunk, LIMITS)
        assert (memory.told, verdict) == (True, None)
    memory, verdict = sensor_fault.step(memory, seen(), LIMITS)
    assert (memory, verdict is not None) == (sensor_fault.Memory(), True)


@pytest.mark.parametrize(
    ("seconds", "words"),
    [
        (18.0, "for 18 seconds."),
        (119.0, "for 119 seconds."),
        (360.0, "for 6 minutes."),
        (7200.0, "for 2 hours."),
        (47 * 3600.0, "for 47 hours."),
        (72 * 3600.0, "for 3 days."),
    ],
)
def test_a_silence_is_told_in_words(seconds: float, words: str) -> None:
    silent = timedelta(seconds=seconds)
    found = device_silent.finding(NOW - silent, NOW, silent)
    assert words in found.message
    assert found.data["seen"] == pytest.approx(seconds / 3600, abs=5e-4)
    assert found.data["threshold"] == seconds / 3600


@pytest.mark.parametrize("kind", ["device_loose", "sensor_fault"])
def test_the_faults_are_not_mixed_up(kind: str) -> None:
    other = Fault.STUCK_AXIS if kind == "device_loose" else Fault.DEVICE_LOOSE
    watch, said = rules.step({}, seen(events=(event(EventKind.FAULT, other),)), LIMITS)
    assert kind not in watch
    assert said == []


def test_each_further_failed_test_counts_and_a_passed_one_in_the_same_chunk_ends_it() -> None:
    failed, passed = event(EventKind.VERIFICATION_FAILED), event(EventKind.CONFIRMED)
    memory, said = verification_failing.Memory(), []
    for events in [(failed,) * 3, (failed,), (failed,), (), (failed, passed), (failed,) * 3]:
        memory, verdict = verification_failing.step(memory, seen(events=events), LIMITS)
        said.append(type(verdict).__name__)
    assert said == ["NoneType", "Finding", "Finding", "NoneType", "Over", "NoneType"]
    assert memory.failed == 3


def test_calibration_stalled_counts_each_further_period() -> None:
    watch: Watch = {}
    raised = []
    for minute in range(1, 70):
        watch, said = rules.step(watch, seen(), LIMITS)
        raised += [minute for kind, _ in said if kind == "calibration_stalled"]
    assert raised == [30, 60]


def harsh(t: float, kind: str = "harsh_braking") -> MotionEvent:
    return MotionEvent(MotionKind(kind), t, t - 1, 1.0, 4.0, 0.0, (-3.0, 0.0), 12.0)


def drive_on(memory: Any, minutes: int, *events: MotionEvent) -> tuple[Any, list[str]]:
    """Let the rule of harsh driving see minutes of driving, the events in the first of them."""
    said = []
    for n in range(minutes):
        memory, verdict = harsh_driving.step(memory, seen(happened=events if n == 0 else ()), LIMITS)
        said += [] if verdict is None else [type(verdict).__name__]
    return memory, said


def test_harsh_driving_needs_three_within_ten_minutes_of_driving() -> None:
    memory, said = drive_on(harsh_driving.Memory(), 4, harsh(30.0))
    memory, more = drive_on(memory, 6, harsh(30.0, "harsh_cornering"))
    memory, last = drive_on(memory, 1, harsh(29.0))  # a second less than ten minutes after the first
    assert (said, more, last) == ([], [], ["Finding"])
    assert memory == harsh_driving.Memory(told=True)
    memory, said = drive_on(harsh_driving.Memory(), 10, harsh(30.0), harsh(31.0))
    assert drive_on(memory, 1, harsh(32.0))[1] == []


def test_only_driving_counts_and_only_harsh_driving() -> None:
    memory, _ = drive_on(harsh_driving.Memory(), 1, harsh(10.0), harsh(20.0))
    for _ in range(100):  # parked, with an engine that runs
        memory, verdict = harsh_driving.step(memory, seen(driving=0.0), LIMITS)
        assert verdict is None
    memory, said = drive_on(memory, 1, harsh(1.0, "pothole"), harsh(2.0, "impact"))
    assert said == []
    assert drive_on(memory, 1, harsh(30.0))[1] == ["Finding"]


def test_harsh_driving_is_over_after_half_an_hour_of_quiet_data() -> None:
    memory, said = drive_on(harsh_driving.Memory(), 29, harsh(1.0), harsh(2.0, "harsh_acceleration"), harsh(3.0))
    assert said == ["Finding"]
    memory, said = drive_on(memory, 30, harsh(1.0))
    assert said == []
    memory, said = drive_on(memory, 1)
    assert (memory, said) == (harsh_driving.Memory(), ["Over"])


def test_each_further_three_count_once_more() -> None:
    _, verdict = harsh_driving.step(
        harsh_driving.Memory(), seen(happened=tuple(harsh(float(n)) for n in range(1, 6))), LIMITS
    )
    assert isinstance(verdict, rules.Finding)
    assert verdict.severity == "info"
    assert "3 events within 10 minutes" in verdict.message
    memory, said = drive_on(harsh_driving.Memory(), 1, *(harsh(float(n)) for n in range(1, 6)))
    assert len(memory.recent) == 2
    assert said + drive_on(memory, 1, harsh(1.0))[1] == ["Finding", "Finding"]


def test_memory_is_strict_json_and_survives_it() -> None:
    direct: Watch = {}
    stored: Watch = {}
    for n in range(80):
        t, at = 60.0 * n, NOW + timedelta(seconds=41.0 * n)
        happened = (harsh(t + 9.0),) if n % 7 == 0 else ()
        chunk = seen(t_first=t, t_last=t + 59.9, received_at=at, with_fix=0.0, events=(), happened=happened)
        direct, said = rules.step(direct, chunk, LIMITS)
        stored, said_too = rules.step(json.loads(json.dumps(stored, allow_nan=False)), chunk, LIMITS)
        assert said == said_too
    assert json.dumps(direct) == json.dumps(stored)


def test_memory_of_another_version_is_understood() -> None:
    watch, _ = rules.step({"gps_lost": {"without": 60.0, "unknown": 1}, "gone": {"x": 1}}, seen(with_fix=0.0), LIMITS)
    assert watch["gps_lost"]["without"] == 120.0
    assert "gone" not in watch


def test_every_kind_is_known_to_the_api_and_has_one_owner() -> None:
    kinds = [rule.kind for rule in rules.RULES]
    assert sorted([*kinds, "orientation_changed", "impact"]) == sorted(get_args(schemas.AlertKind))
    assert rules.forget(rules.opened({}, kinds), kinds) == {}


def test_the_settings_reach_the_limits() -> None:
    changed = Limits.of(
        Settings(alert_stalled_minutes=1, alert_failed_tests=2, alert_gps_lost_minutes=3, alert_silent_hours=4)
    )
    assert (changed.stalled_driving, changed.failed_tests, changed.without_fix) == (60.0, 2, 180.0)
    assert changed.silent == timedelta(hours=4)
    assert Limits.of(Settings()) == LIMITS


def test_the_rules_cost_little() -> None:
    samples = drive("city", 60.0, rate=200.0)
    state = core.begin_session(core.DEFAULT, core.initial_state(core.DEFAULT))
    outcome = core.advance(core.DEFAULT, state, samples)[1]
    best, watch = float("inf"), rules.opened({}, [rule.kind for rule in rules.RULES])
    for _ in range(200):
        begun = time.perf_counter()
        rules.step(watch, see((1, "a", NOW), samples, outcome, (), NOW), LIMITS)
        best = min(best, time.perf_counter() - begun)
    assert best < 0.3e-3, f"{1e3 * best:.3f} ms"
