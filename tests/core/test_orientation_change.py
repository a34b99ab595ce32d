"""A device that is turned in the vehicle: found once, described rightly, and its new mounting confirmed."""

from dataclasses import replace
from functools import cache
from itertools import cycle

import numpy as np
import pytest

from core import DEFAULT, Event, EventKind, Fault, Outcome, State, advance, begin_session
from core.quaternion import angle_between, from_rotation_vector, multiply, random
from core.simulation import Drive, Scenario, simulate
from core.simulation_faults import Disturbances
from tests.core.drives import Floats, run

pytestmark = pytest.mark.compiled

DEGREE = np.pi / 180
TURNED_AT = 400.0
TOWN = Scenario(route="city", seconds=1000.0, imu_rate=50.0)
TILT, YAW = np.array([0.6, 0.8, 0.0]), np.array([0.0, 0.0, 1.0])
CASES = [
    pytest.param(sensor, seed, angle, axis, id=f"{sensor}-{seed}-{angle:.0f}-{name}")
    for sensor, seed in (("mems", 11), ("mems", 13), ("tmd2", 12), ("tmd2", 13))
    for angle in (12.0, 30.0)
    for name, axis in (("tilt", TILT), ("yaw", YAW), ("yaw back", -YAW))
]


@cache
def turned_drive(sensor: str, seed: int, turn: tuple[float, float, float]) -> tuple[Drive, Outcome]:
    before = random(np.random.default_rng(seed))
    after = multiply(from_rotation_vector(np.array(turn)), before)
    drive = simulate(replace(TOWN, sensor=sensor, seed=seed, mount=before, remount=(TURNED_AT, after)))
    return drive, run(drive.samples)[1]


def result(sensor: str, seed: int, angle: float, axis: Floats) -> tuple[Drive, Outcome, Event]:
    x, y, z = (angle * DEGREE * axis).tolist()
    drive, outcome = turned_drive(sensor, seed, (x, y, z))
    return drive, outcome, changes(outcome)[0]


def changes(outcome: Outcome) -> list[Event]:
    return [event for event in outcome.events if event.kind is EventKind.ORIENTATION_CHANGED]


@pytest.mark.parametrize(("sensor", "seed", "angle", "axis"), CASES)
def test_it_is_found_once_and_described(sensor: str, seed: int, angle: float, axis: Floats) -> None:
    drive, outcome, change = result(sensor, seed, angle, axis)
    assert len(changes(outcome)) == 1
    assert TURNED_AT < change.t < TURNED_AT + 180
    assert change.angle == pytest.approx(angle * DEGREE, abs=4 * DEGREE)
    assert change.axis is not None
    assert np.linalg.norm(change.axis) == pytest.approx(1)
    off = np.arccos(np.clip(change.axis @ axis, -1, 1))
    assert off < np.arctan2(4, angle) + 2 * DEGREE, "an error of 4 deg of the new mounting turns a small change's axis"
    assert change.since is not None
    assert abs(change.since - TURNED_AT) < 120
    assert change.since < change.t
    assert change.quaternion is not None
    assert change.sigma is not None
    assert angle_between(change.quaternion, drive.truth.mount_at(TURNED_AT + 1)) < 4 * DEGREE
    assert np.all((change.sigma > 0.1 * DEGREE) & (change.sigma < 5 * DEGREE))


@pytest.mark.parametrize(("sensor", "seed", "angle", "axis"), CASES)
def test_the_evidence_can_be_drawn(sensor: str, seed: int, angle: float, axis: Floats) -> None:
    evidence = result(sensor, seed, angle, axis)[2].evidence
    assert evidence is not None
    assert evidence.threshold == DEFAULT.change.decision
    assert evidence.t.shape == evidence.value.shape
    assert DEFAULT.change.looks <= evidence.t.size <= 40
    assert np.all(np.isfinite(evidence.t))
    assert np.all(np.isfinite(evidence.value))
    assert np.all(evidence.value >= 0)
    assert np.all(np.diff(evidence.t) > 0)
    assert np.all(evidence.value[-DEFAULT.change.looks :] >= evidence.threshold)
    assert np.median(evidence.value[evidence.t < TURNED_AT]) < DEFAULT.change.innocent


@pytest.mark.parametrize(("sensor", "seed", "angle", "axis"), CASES)
def test_the_new_mounting_is_confirmed(sensor: str, seed: int, angle: float, axis: Floats) -> None:
    drive, outcome, change = result(sensor, seed, angle, axis)
    confirmed = [event for event in outcome.events if event.kind is EventKind.CONFIRMED]
    assert len(confirmed) == 2
    assert confirmed[0].t < TURNED_AT < change.t < confirmed[1].t < change.t + 300
    for event in confirmed:
        assert event.quaternion is not None
        assert angle_between(event.quaternion, drive.truth.mount_at(event.t)) < 4 * DEGREE
    assert outcome.status.mount is not None
    assert not outcome.status.mount.suspect
    assert outcome.status.mount.t == confirmed[1].t


def test_the_old_mounting_is_suspect_until_the_new_one_is_confirmed() -> None:
    drive, outcome, change = result("mems", 11, 30.0, TILT)
    confirmed = [event.t for event in outcome.events if event.kind is EventKind.CONFIRMED]
    samples = drive.samples
    state: State | None = None
    last = 0
    for t, suspect in (
        (change.t - 1, False),
        (change.t + 1, True),
        (confirmed[1] - 1, True),
        (confirmed[1] + 1, False),
    ):
        row = int(np.searchsorted(samples.t, t))
        piece = samples.slice(last, row)
        state, so_far = run(piece) if state is None else advance(DEFAULT, state, piece)
        last = row
        mount = so_far.status.mount
        assert mount is not None
        assert mount.suspect is suspect
        assert angle_between(mount.quaternion, drive.truth.mount_at(0 if t < confirmed[1] else t)) < 4 * DEGREE


def test_a_change_in_a_later_session_is_told_in_its_time() -> None:
    """The clock begins anew with a session, and so do since and evidence."""
    before = random(np.random.default_rng(11))
    after = multiply(from_rotation_vector(20 * DEGREE * TILT), before)
    scenario = replace(TOWN, seed=11, mount=before)
    state, _ = run(simulate(replace(scenario, seconds=900.0)).samples)
    second = simulate(replace(scenario, session=1, remount=(TURNED_AT, after)))
    _, outcome = advance(DEFAULT, begin_session(DEFAULT, state), second.samples)
    assert len(changes(outcome)) == 1
    change = changes(outcome)[0]
    assert change.since is not None
    assert abs(change.since - TURNED_AT) < 120
    assert change.evidence is not None
    assert np.all(np.diff(change.evidence.t) > 0)
    assert change.evidence.t[-1] == pytest.approx(change.t, abs=1)


def test_a_device_turned_while_switched_off_is_found() -> None:
    before = random(np.random.default_rng(13))
    after = multiply(from_rotation_vector(20 * DEGREE * TILT), before)
    scenario = replace(TOWN, seed=13, seconds=600.0)
    state, _ = run(simulate(replace(scenario, mount=before)).samples)
    _, outcome = advance(
        DEFAULT, begin_session(DEFAULT, state), simulate(replace(scenario, mount=after, session=1)).samples
    )
    assert len(changes(outcome)) == 1
    assert outcome.status.mount is not None
    assert not outcome.status.mount.suspect
    assert angle_between(outcome.status.mount.quaternion, after) < 4 * DEGREE


def to_and_fro(*times: float) -> Disturbances:
    """Turn the device by 25 deg, about an axis of its own, and back, at the times."""
    x, y, z = 25 * DEGREE * np.array([0.48, -0.6, 0.64])
    turns = ((x, y, z), (-x, -y, -z))
    return Disturbances(knocks=tuple(zip(times, cycle(turns), strict=False)))


@pytest.mark.parametrize("sensor", ["mems", "tmd2"])
def test_a_device_that_keeps_turning_is_loose(sensor: str) -> None:
    times = (400.0, 1000.0, 1600.0)
    drive = simulate(replace(TOWN, seconds=2400.0, seed=14, sensor=sensor, disturbances=to_and_fro(*times)))
    _, outcome = run(drive.samples)
    assert len(changes(outcome)) == len(times)
    loose = [event for event in outcome.events if event.fault is Fault.DEVICE_LOOSE]
    assert len(loose) == 1
    assert times[-1] < loose[0].t < times[-1] + 180
    assert loose[0].reason is not None
    assert loose[0].since is not None
    evidence = loose[0].evidence
    assert evidence is not None
    assert 1 <= evidence.t.size <= 40
    assert np.all(np.isfinite(evidence.value))
    assert np.all(np.diff(evidence.t) > 0)


@pytest.mark.parametrize("sensor", ["mems", "tmd2"])
def test_two_turns_do_not_make_a_device_loose(sensor: str) -> None:
    drive = simulate(replace(TOWN, seconds=1800.0, seed=15, sensor=sensor, disturbances=to_and_fro(400.0, 1000.0)))
    _, outcome = run(drive.samples)
    assert len(changes(outcome)) == 2
    assert Fault.DEVICE_LOOSE not in [event.fault for event in outcome.events]
    assert outcome.status.mount is not None
    assert angle_between(outcome.status.mount.quaternion, drive.truth.q_vs) < 4 * DEGREE


@pytest.mark.parametrize("seed", [21, 22])
@pytest.mark.parametrize("sensor", ["mems", "tmd2"])
@pytest.mark.parametrize("route", ["city", "hills"])
def test_an_hour_of_untouched_driving_reports_no_change(route: str, sensor: str, seed: int) -> None:
    drive = simulate(Scenario(route, 3600.0, seed, sensor=sensor, imu_rate=20.0))
    _, outcome = run(drive.samples)
    assert outcome.status.mount is not None
    assert not outcome.status.mount.suspect
    kinds = [event.kind for event in outcome.events]
    assert EventKind.ORIENTATION_CHANGED not in kinds
    assert EventKind.FAULT not in kinds
    assert kinds.count(EventKind.CONFIRMED) == 1
