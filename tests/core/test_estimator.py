"""The estimator as its callers see it: stages, events, needs, sessions, and the answer turning with the log."""

from dataclasses import replace

import numpy as np
import pytest

from core import (
    DEFAULT,
    THESIS,
    EventKind,
    Needs,
    Samples,
    Stage,
    advance,
    begin_session,
    encode,
    initial_state,
    restart,
    status,
)
from core.quaternion import angle_between, conjugate, from_rotation_vector, multiply, random
from tests.core.drives import drive, remounted, remounted_result, result, run, turned

DEGREE = np.pi / 180


@pytest.mark.parametrize("name", ["city", "city without gyro"])
def test_a_town_drive_ends_confirmed_at_the_true_mounting(name: str) -> None:
    true = drive(name).truth.q_vs
    _, outcome = result(name)
    assert outcome.status.stage is Stage.CONFIRMED
    assert outcome.status.needs == Needs(0)
    mount = outcome.status.mount
    assert mount is not None
    assert not mount.suspect
    assert angle_between(mount.quaternion, true) < 3 * DEGREE
    assert outcome.status.estimate is not None
    assert angle_between(outcome.status.estimate.quaternion, true) < 3 * DEGREE
    kinds = [event.kind for event in outcome.events]
    assert kinds[-3:] == [EventKind.VERIFICATION_STARTED, EventKind.VERIFICATION_PASSED, EventKind.CONFIRMED]
    confirmed = outcome.events[-1]
    assert confirmed.verification is not None
    assert confirmed.verification.elapsed >= 40
    assert confirmed.verification.error < 2.5


def test_stages_follow_each_other_and_progress_does_not_fall() -> None:
    _, outcome = result("city")
    rows = outcome.estimates
    assert np.all(np.diff(rows.t) > 0)
    assert set(rows.stage) == {Stage.SETTLING, Stage.VERIFYING, Stage.CONFIRMED}
    assert np.all(np.diff(rows.stage[rows.stage != Stage.VERIFYING]) >= 0)
    failed = [e.t for e in outcome.events if e.kind is EventKind.VERIFICATION_FAILED]
    drops = rows.t[1:][np.diff(rows.progress) < 0]
    assert len(drops) <= len(failed)
    assert rows.progress[-1] == 1.0
    assert np.all(rows.quaternion[:, 0] >= 0)
    assert np.all(np.diff(rows.sigma[-100:].max(axis=1)) < 0.1 * DEGREE)


@pytest.mark.compiled
@pytest.mark.parametrize("angle", [0.3, 90.0, 179.9, 180.0])
def test_the_answer_turns_with_the_log(angle: float) -> None:
    axis = np.array([0.36, -0.48, 0.8])
    q = from_rotation_vector(np.radians(angle) * axis)
    samples = drive("city").samples
    _, plain = result("city")
    _, moved = run(turned(samples, q))
    assert plain.status.mount is not None
    assert moved.status.mount is not None
    expected = multiply(plain.status.mount.quaternion, conjugate(q))
    assert angle_between(moved.status.mount.quaternion, expected) < 0.05 * DEGREE


def test_a_parked_vehicle_gives_no_estimate_and_needs_motion() -> None:
    _, outcome = result("parked")
    assert outcome.status.stage is Stage.ALIGNING
    assert outcome.status.estimate is None
    assert outcome.estimates.t.size == 0
    assert Needs.MOTION in outcome.status.needs
    assert outcome.status.progress < 0.2


def test_needs_of_a_device_that_never_spoke_and_of_one_without_gps() -> None:
    assert status(DEFAULT, initial_state(DEFAULT)).needs.words == ("data",)
    assert status(DEFAULT, initial_state(DEFAULT)).stage is Stage.WAITING
    samples = drive("short").samples
    _, outcome = run(replace(samples, fix_valid=np.zeros_like(samples.fix_valid)))
    assert outcome.status.needs.words == ("gps_fix",)
    assert outcome.status.stage is Stage.WAITING
    assert outcome.fixes == 0


def test_needs_name_the_missing_manoeuvre() -> None:
    """Straight ahead at constant speed shows neither turning nor braking."""
    t = np.arange(0, 60, 0.05)
    row = np.arange(0, t.size, 5)
    fix = np.full((row.size, 8), np.nan)
    fix[:, 3], fix[:, 4] = 15.0, 1.0
    samples = Samples.make(t, np.tile([0.0, 0.0, 9.81], (t.size, 1)), None, row, np.ones(row.size, bool), fix)
    _, outcome = run(samples)
    assert outcome.status.needs.words == ("turn", "accelerate_or_brake")
    assert outcome.status.estimate is None, "yaw cannot be known"


def test_repeated_and_old_samples_are_counted_and_change_nothing() -> None:
    samples = drive("short").samples
    state, first = result("short")
    again, outcome = advance(DEFAULT, state, samples)
    assert outcome.samples == 0
    assert outcome.rejected == {"duplicate_time": 1, "before_previous_sample": len(samples) - 1}
    assert encode(again) == encode(state)
    assert first.rejected == {}


def test_implausible_fixes_are_counted_and_do_no_harm() -> None:
    samples = drive("city").samples
    fix = samples.fix.copy()
    fix[::40, 3] = 300.0
    fix[20::40, 3] = np.nan
    fix[20::40, :2] = np.nan
    _, outcome = run(replace(samples, fix=fix))
    assert set(outcome.rejected) == {"fix_without_velocity", "fix_implausible"}
    assert outcome.status.estimate is not None
    assert angle_between(outcome.status.estimate.quaternion, drive("city").truth.q_vs) < 3 * DEGREE


def test_velocity_is_derived_from_positions_where_the_receiver_gives_none() -> None:
    samples = drive("city").samples
    fix = samples.fix[::4].copy()  # once a second, as such receivers do
    fix[:, 3:5] = np.nan
    samples = replace(samples, fix=fix, fix_row=samples.fix_row[::4], fix_valid=samples.fix_valid[::4])
    _, outcome = run(samples)
    assert outcome.rejected == {"fix_without_velocity": 1}, "the first position has no predecessor"
    assert outcome.status.estimate is not None
    assert angle_between(outcome.status.estimate.quaternion, drive("city").truth.q_vs) < 6 * DEGREE


def test_a_new_session_keeps_the_mounting_and_begins_its_own_time() -> None:
    state, before = result("city")
    state = begin_session(DEFAULT, state)
    assert str(status(DEFAULT, state).mount) == str(before.status.mount)
    _, outcome = advance(DEFAULT, state, drive("city").samples.slice(0, 5000))
    assert outcome.rejected == {}
    assert outcome.status.stage is Stage.CONFIRMED
    assert outcome.estimates.t[0] < 1.0


@pytest.mark.compiled
def test_a_power_cut_in_the_middle_does_not_start_over() -> None:
    samples = drive("city").samples
    half = len(samples) // 2
    state, _ = run(samples.slice(0, half))
    second = samples.slice(half, len(samples))
    second = replace(second, t=second.t - second.t[0])
    _, outcome = advance(DEFAULT, begin_session(DEFAULT, state), second)
    assert outcome.status.stage is Stage.CONFIRMED
    assert outcome.status.mount is not None
    assert angle_between(outcome.status.mount.quaternion, drive("city").truth.q_vs) < 3 * DEGREE


def test_restart_forgets_the_mounting_but_not_the_time() -> None:
    samples = drive("city").samples
    state, _ = result("city")
    fresh = restart(DEFAULT, state)
    assert status(DEFAULT, fresh).mount is None
    assert status(DEFAULT, fresh).stage is Stage.ALIGNING
    _, outcome = advance(DEFAULT, fresh, samples.slice(0, 100))
    assert outcome.rejected == {"before_previous_sample": 100}


def test_arguments_are_left_alone() -> None:
    samples = drive("short").samples
    state = initial_state(DEFAULT)
    before = encode(state)
    advance(DEFAULT, state, samples)
    begin_session(DEFAULT, state)
    status(DEFAULT, state)
    assert encode(state) == before


def test_no_samples_are_no_event() -> None:
    state, _ = result("short")
    again, outcome = advance(DEFAULT, state, drive("short").samples.slice(0, 0))
    assert encode(again) == encode(state)
    assert outcome.samples == outcome.fixes == 0


@pytest.mark.compiled
def test_an_outage_of_the_gps_is_survived() -> None:
    samples = drive("city").samples
    t = samples.t[samples.fix_row]
    _, outcome = run(replace(samples, fix_valid=samples.fix_valid & ~((t > 100) & (t < 130))))
    assert outcome.status.estimate is not None
    assert angle_between(outcome.status.estimate.quaternion, drive("city").truth.q_vs) < 3 * DEGREE


def test_a_gap_in_the_samples_is_survived() -> None:
    samples = drive("city").samples
    first, second = samples.slice(0, 5000), samples.slice(5400, len(samples))
    state, _ = run(first)
    _, outcome = advance(DEFAULT, state, second)
    assert outcome.status.estimate is not None
    assert angle_between(outcome.status.estimate.quaternion, drive("city").truth.q_vs) < 3 * DEGREE


@pytest.mark.compiled
def test_report_interval() -> None:
    samples = drive("city").samples
    _, every = result("city")
    _, coarse = run(samples, replace(DEFAULT, report_interval=10.0))
    assert 9 < every.estimates.t.size / coarse.estimates.t.size < 11
    np.testing.assert_allclose(coarse.estimates.t[1:] % 10.0, 0.0, atol=0.03)


def test_thesis_preset_reaches_a_verdict() -> None:
    _, outcome = run(drive("city without gyro").samples, THESIS)
    assert outcome.status.estimate is not None
    assert EventKind.VERIFICATION_STARTED in [event.kind for event in outcome.events]


def test_an_orientation_change_is_found_and_the_new_mounting_confirmed() -> None:
    truth = remounted().truth
    _, outcome = remounted_result()
    changes = [e for e in outcome.events if e.kind is EventKind.ORIENTATION_CHANGED]
    confirmed = [e for e in outcome.events if e.kind is EventKind.CONFIRMED]
    assert len(changes) == 1
    assert 400 < changes[0].t < 580
    assert changes[0].angle == pytest.approx(25 * DEGREE, abs=4 * DEGREE)
    assert len(confirmed) == 2
    assert confirmed[0].quaternion is not None
    assert angle_between(confirmed[0].quaternion, truth.q_vs) < 3 * DEGREE
    assert outcome.status.mount is not None
    assert not outcome.status.mount.suspect
    assert angle_between(outcome.status.mount.quaternion, truth.mount_at(500.0)) < 3 * DEGREE


@pytest.mark.compiled
def test_the_old_mounting_stays_readable_while_suspect() -> None:
    samples = remounted().samples
    change = next(e for e in remounted_result()[1].events if e.kind is EventKind.ORIENTATION_CHANGED)
    _, outcome = run(samples.slice(0, int(np.searchsorted(samples.t, change.t + 1))))
    assert outcome.status.mount is not None
    assert outcome.status.mount.suspect
    assert outcome.status.stage is Stage.SETTLING, "what showed the change goes on as the new estimate"
    assert outcome.status.progress < 0.6


@pytest.mark.compiled
def test_random_orientations_near_half_turns() -> None:
    """The mirror of method 1: no mounting may end 180 deg wrong."""
    samples = drive("short").samples
    for seed in range(3):
        q = random(np.random.default_rng(seed))
        _, outcome = run(turned(samples, q))
        assert outcome.status.estimate is not None
        expected = multiply(drive("short").truth.q_vs, conjugate(q))
        assert angle_between(outcome.status.estimate.quaternion, expected) < 12 * DEGREE
