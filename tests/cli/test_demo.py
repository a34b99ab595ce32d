import signal
import socket
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, get_args

import httpx
import numpy as np
import pytest

import core
from api import schemas
from api.commands.demo_desk import NOTES
from api.commands.demo_fleet import FLEET, ROUND, SET_BACK, SLIPPING, Vehicle
from api.commands.demo_trips import FOREVER, RATE, Recorder, Trip, pieces
from core import DEFAULT, Samples, Stage, quaternion
from tests.cli import livella

STAGES = {stage.word for stage in Stage}
KINDS = set(get_args(schemas.AlertKind))
PROMISED = {(vehicle.device_id, shown) for vehicle in FLEET for shown in vehicle.shows}
TRIPS = [
    pytest.param(vehicle, trip, id=f"{vehicle.device_id}-{when}")
    for vehicle in FLEET
    for when, trip in (("past", vehicle.past), ("now", vehicle.now))
    if trip
]


@pytest.fixture
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder for temporary files of this test's commands alone, because others run beside it."""
    folder = tmp_path / "temporary"
    folder.mkdir()
    monkeypatch.setenv("TMPDIR", str(folder))
    return folder


def seconds_until(condition: Callable[[], bool], most: float) -> float:
    """Wait for a condition; give the time it took, or was waited."""
    began = time.monotonic()
    while not condition() and time.monotonic() < began + most:
        time.sleep(0.2)
    return time.monotonic() - began


@contextmanager
def demo(log: Path) -> Iterator[tuple[livella.Running, httpx.Client]]:
    """The demo from the moment it has printed its address, and whoever signs in with the key beside it."""
    port = livella.free_port()
    url = f"http://127.0.0.1:{port}"
    with livella.running("demo", "--port", port, log=log) as running:
        seconds_until(lambda: livella.KEY.search(running.output()) is not None, livella.TIMEOUT)
        key = livella.KEY.search(running.output())
        assert key, running.output()
        assert url in running.output()
        headers = {"Authorization": f"Bearer {key.group()}"}
        with httpx.Client(base_url=f"{url}/api/v1/", headers=headers, timeout=30.0) as client:
            yield running, client


def items(client: httpx.Client, path: str) -> list[dict[str, Any]]:
    listed: list[dict[str, Any]] = client.get(path, params={"limit": 500}).raise_for_status().json()["items"]
    return listed


@pytest.mark.slow
def test_every_stage_and_every_alert_within_two_minutes(tmp_path: Path, temporary: Path) -> None:
    seen: set[tuple[str, str]] = set()
    acted: set[tuple[str, str, str | None]] = set()
    wanted = {(note.device_id, note.kind, note.text) for note in NOTES}

    with demo(tmp_path / "log") as (running, client):

        def complete() -> bool:
            seen.update((device["id"], device["stage"]) for device in items(client, "devices"))
            for alert in items(client, "alerts"):
                seen.add((alert["device_id"], alert["kind"]))
                acted.add((alert["device_id"], alert["kind"], alert["acknowledge_note"] or alert["resolve_note"]))
            return seen >= PROMISED and acted >= wanted

        took = seconds_until(complete, 120.0)
        print(f"{took:.0f} s until everything was shown")
        assert running.end(signal.SIGINT) == 0, running.output()
    assert {shown for _, shown in seen} == STAGES | KINDS
    assert seen >= PROMISED, PROMISED - seen
    assert acted >= wanted, acted
    assert "Traceback" not in running.output()
    assert not list(temporary.glob("livella-demo-*"))


@pytest.mark.slow
def test_ended_while_the_fleet_sets_off(tmp_path: Path, temporary: Path) -> None:
    with demo(tmp_path / "log") as (running, client):
        seconds_until(lambda: bool(items(client, "devices")), 120.0)
        assert running.end(signal.SIGTERM) == 0, running.output()
    assert "Traceback" not in running.output()
    assert not list(temporary.glob("livella-demo-*"))


@pytest.mark.slow
def test_a_port_that_is_taken(temporary: Path) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        done = livella.run("demo", "--port", taken.getsockname()[1])
    assert done.status != 0
    assert "address already in use" in done.err.lower()
    assert not list(temporary.glob("livella-demo-*"))


def test_the_fleet_is_here_for_every_stage_and_every_alert() -> None:
    assert {shown for _, shown in PROMISED} == STAGES | KINDS
    assert len({vehicle.device_id for vehicle in FLEET}) == len(FLEET)
    assert {(note.device_id, note.kind) for note in NOTES} <= PROMISED


@pytest.mark.parametrize(("vehicle", "trip"), TRIPS)
def test_each_vehicle_drives_as_it_should(vehicle: Vehicle, trip: Trip) -> None:
    samples = Recorder(vehicle.seed).record(trip)
    fixes = samples.t[samples.fix_row]
    assert len(samples) == pytest.approx(trip.seconds * trip.rate, abs=2)
    assert np.array_equal(samples.fix_valid, fixes < trip.no_fix_from)
    moving = samples.fix[samples.fix_valid, 3] > 1.5
    assert np.any(moving) == (trip.route != "parked" and trip.no_fix_from > 0)


def test_one_of_the_fitters_is_always_in_the_drive_test() -> None:
    """From the second round on; a round that goes on is seen as a row for each second of it."""
    seconds = 5 * int(ROUND.seconds)
    testing = np.zeros(seconds + 1, np.bool_)
    for vehicle in FLEET:
        if vehicle.fitted_at is None:
            continue
        recorder = Recorder(vehicle.seed)
        for start in np.arange(vehicle.fitted_at, seconds, ROUND.seconds):
            outcome = core.advance(DEFAULT, core.initial_state(DEFAULT), recorder.record(ROUND))[1]
            tested = outcome.estimates.t[outcome.estimates.stage == Stage.VERIFYING]
            testing[np.minimum(start + tested, seconds).astype(int)] = True
            recorder.refit()
    assert testing[int(ROUND.seconds) :].mean() > 0.95


def gravity(samples: Samples, when: Any) -> Any:
    mean = samples.f_s[when].mean(axis=0)
    return mean / np.linalg.norm(mean)


def test_a_knocked_device_stays_so_in_the_next_trip() -> None:
    recorder = Recorder(3)
    first, second = recorder.record(SLIPPING), recorder.record(SLIPPING)
    knock, last = SLIPPING.knocked_at[0], SLIPPING.knocked_at[-1]
    before, after = gravity(first, first.t < knock), gravity(first, first.t > last)
    then = gravity(second, second.t < knock)
    assert np.degrees(np.arccos(before @ after)) > 5
    assert np.degrees(np.arccos(then @ after)) < 5


def test_a_refitted_device_is_mounted_otherwise_and_driven_the_same_round() -> None:
    recorder = Recorder(3)
    mount, first = recorder.mount, recorder.record(ROUND)
    other = recorder.record(ROUND)
    recorder.refit()
    again = recorder.record(ROUND)
    assert quaternion.angle_between(mount, recorder.mount) > 0.1
    np.testing.assert_array_equal(again.fix, first.fix)
    assert not np.array_equal(other.fix, first.fix)


@pytest.mark.parametrize("seconds", [7.0, FOREVER])
def test_pieces_are_the_trip(seconds: float) -> None:
    samples = Recorder(1).record(ROUND)
    cut = list(pieces(samples, ROUND, seconds))
    np.testing.assert_array_equal(np.concatenate([piece.t for piece in cut]), samples.t)
    assert all(piece.t[-1] - piece.t[0] < seconds for piece in cut)


def test_what_goes_wrong_begins_a_piece() -> None:
    when, by = SET_BACK.set_back
    before, after = pieces(Recorder(1).record(SET_BACK), SET_BACK, FOREVER)
    assert before.t[-1] == pytest.approx(when - 1 / RATE)
    assert after.t[0] == pytest.approx(when - by)
    assert after.t[-1] == pytest.approx(SET_BACK.seconds - by - 1 / RATE)
