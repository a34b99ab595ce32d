"""What the installer is told: which manoeuvre is missing, and how far along it is."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from core import DEFAULT, Event, EventKind, Needs, Outcome, Samples, Stage, advance, initial_state, restart, status
from core.simulation import Scenario, simulate
from tests.core.drives import drive, remounted_result, result, run

pytestmark = pytest.mark.compiled

RESETS = (EventKind.VERIFICATION_FAILED, EventKind.ORIENTATION_CHANGED)
SEEDS = range(41, 47)


@cache
def driven(route: str, sensor: str, seed: int) -> Outcome:
    return run(simulate(Scenario(route, 600.0, seed, sensor=sensor, imu_rate=50.0)).samples)[1]


def straight_on(speed: list[tuple[float, float]], bend_after: float = np.inf) -> Samples:
    """A perfectly smooth straight road, speeds linear between (s, m/s), an S-bend every half a minute later on."""
    t = np.arange(0.0, speed[-1][0], 0.02)
    v = np.interp(t, *np.array(speed).T)
    yaw_rate = np.where(t > bend_after, 0.3 * np.sin(2 * np.pi * t / 10) * np.clip(v / 5, 0, 1), 0.0)
    yaw = np.cumsum(yaw_rate) * 0.02
    rng = np.random.default_rng(5)
    noise = 0.05 * rng.normal(size=(t.size, 3))
    f = np.stack([np.gradient(v, t), v * yaw_rate, np.full(t.size, 9.80665)], axis=-1) + noise
    w = np.stack([0 * t, 0 * t, yaw_rate], axis=-1) + 1e-3 * rng.normal(size=(t.size, 3))
    row = np.arange(12, t.size, 12)
    fix = np.full((row.size, 8), np.nan)
    fix[:, 2] = 100 + 0.1 * rng.normal(size=row.size)
    fix[:, 3] = np.abs(v[row] + 0.05 * rng.normal(size=row.size))
    fix[:, 4] = (1.0 - yaw[row] + 0.05 * rng.normal(size=row.size) / np.maximum(v[row], 1)) % (2 * np.pi)
    return Samples.make(t, f, w, row, np.ones(row.size, bool), fix)


def stop_and_go(seconds: float) -> list[tuple[float, float]]:
    knots = [(0.0, 0.0), (5.0, 0.0)]
    while knots[-1][0] < seconds:
        t = knots[-1][0]
        knots += [(t + 8, 13.0), (t + 14, 13.0), (t + 22, 0.0), (t + 26, 0.0)]
    return knots


def changes(outcome: Outcome) -> int:
    """How often what is needed changes, as an installer sees it."""
    return int(np.count_nonzero(np.diff(outcome.estimates.needs)))


def resets(outcome: Outcome) -> list[Event]:
    return [event for event in outcome.events if event.kind in RESETS]


def test_at_constant_speed_straight_on_both_manoeuvres_are_missing() -> None:
    _, outcome = run(straight_on([(0.0, 20.0), (120.0, 20.0)]))
    assert outcome.status.needs == Needs.TURN | Needs.ACCELERATE_OR_BRAKE
    assert outcome.status.mount is None


def test_braking_alone_leaves_the_turn_missing() -> None:
    """Straight on, the axes could be a mirror image, however well yaw is known."""
    _, outcome = run(straight_on(stop_and_go(300.0)))
    assert outcome.status.needs == Needs.TURN
    assert outcome.status.mount is None
    assert outcome.status.estimate is not None
    assert outcome.status.progress < 1


def test_bends_supply_what_was_missing() -> None:
    _, outcome = run(straight_on(stop_and_go(420.0), bend_after=200.0))
    rows = outcome.estimates
    assert np.all(rows.needs[rows.t < 200] == Needs.TURN)
    assert Needs.TURN not in Needs(int(rows.needs[rows.t > 260][0]))
    assert outcome.status.stage is Stage.CONFIRMED
    assert outcome.status.needs == Needs(0)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("sensor", ["mems", "tmd2"])
@pytest.mark.parametrize("route", ["city", "hills"])
def test_needs_do_not_flicker(route: str, sensor: str, seed: int) -> None:
    outcome = driven(route, sensor, seed)
    assert changes(outcome) <= 6
    rows = outcome.estimates
    assert Needs(int(rows.needs[0])) & Needs.TURN
    just_before = int(rows.needs[rows.stage == Stage.VERIFYING][-1])
    assert just_before == Needs.TIME, "nothing but the test's time is missing before it is passed"
    assert np.all(rows.needs[rows.stage == Stage.CONFIRMED] == 0)
    assert outcome.status.stage is Stage.CONFIRMED
    assert outcome.status.needs == Needs(0)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("sensor", ["mems", "tmd2"])
@pytest.mark.parametrize("route", ["city", "hills", "straight", "constant"])
def test_progress_falls_only_when_something_failed(route: str, sensor: str, seed: int) -> None:
    outcome = driven(route, sensor, seed)
    rows = outcome.estimates
    assert np.all((rows.progress >= 0) & (rows.progress <= 1))
    falls = rows.t[1:][np.diff(rows.progress) < 0]
    failed = np.array([event.t for event in resets(outcome)])
    for fall in falls:
        assert np.any(np.abs(failed - fall) <= 1.0)
    assert np.all(rows.progress[rows.stage == Stage.CONFIRMED] == 1)
    assert np.all(np.diff(rows.progress) < 0.95), "it does not leap from nothing to done"


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("sensor", ["mems", "tmd2"])
@pytest.mark.parametrize("route", ["city", "straight", "constant"])
def test_it_is_done_when_it_is_confirmed_and_not_before(route: str, sensor: str, seed: int) -> None:
    rows = driven(route, sensor, seed).estimates
    assert np.all(rows.needs[rows.stage != Stage.CONFIRMED] != 0)
    assert np.all(rows.needs[rows.stage == Stage.CONFIRMED] == 0)


def test_an_orientation_change_takes_the_progress_back() -> None:
    _, outcome = remounted_result()
    rows = outcome.estimates
    falls = rows.t[1:][np.diff(rows.progress) < 0]
    told = np.array([event.t for event in resets(outcome)])
    assert all(np.any(np.abs(told - fall) <= 1.0) for fall in falls)
    change = next(event.t for event in outcome.events if event.kind is EventKind.ORIENTATION_CHANGED)
    assert np.any(np.abs(falls - change) <= 1.0)
    assert rows.needs[np.searchsorted(rows.t, change + 2)] != 0
    assert rows.progress[-1] == 1


def test_a_restart_begins_at_nothing() -> None:
    state, outcome = result("city")
    assert outcome.status.progress == 1
    fresh = status(DEFAULT, restart(DEFAULT, state))
    assert fresh.progress < 0.1
    assert fresh.needs != Needs(0)


def test_standing_for_long_asks_for_motion() -> None:
    until = drive("short").samples
    t = np.arange(1, 900) * 0.05 + until.t[-1]
    row = np.arange(0, t.size, 5)
    fix = np.tile(until.fix[-1], (row.size, 1))
    fix[:, 3] = 0.0
    standing = Samples.make(t, np.tile(until.f_s[-1], (t.size, 1)), None, row, np.ones(row.size, bool), fix)
    state, _ = run(until)
    _, outcome = advance(DEFAULT, state, standing)
    assert Needs.MOTION in outcome.status.needs


def test_losing_the_receiver_asks_for_a_fix() -> None:
    samples = drive("short").samples
    half = len(samples) // 2
    state, _ = advance(DEFAULT, initial_state(DEFAULT), samples.slice(0, half))
    rest = samples.slice(half, len(samples))
    _, outcome = advance(DEFAULT, state, replace(rest, fix_valid=np.zeros_like(rest.fix_valid)))
    assert outcome.status.needs == Needs.GPS_FIX
