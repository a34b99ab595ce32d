"""What happened to a vehicle: found under the mounting in force, listed, and told as alerts."""

import math
from collections.abc import Callable
from datetime import datetime, timedelta
from itertools import pairwise

import numpy as np
import pytest
import sqlalchemy as sa

from api.formats.writer import write_native_csv
from api.services import calibration, findings, foresight
from core.motion import events as detector
from core.motion.events import MotionEvent
from core.simulation_events import manoeuvres
from storage import models as tables
from storage.database import Database
from tests.conftest import Clock
from tests.crashes import crashed
from tests.drives import CHUNK_SECONDS, remounted
from tests.service import Api, Device, Json
from tests.watched import the_alert

LITTLE = timedelta(seconds=0.1)
KINDS = ("impact", "harsh_braking", "harsh_acceleration", "harsh_cornering", "pothole")


def play(device: Device, clock: Clock, bodies: tuple[bytes, ...], session: str = "a", start: int = 0) -> None:
    for seq, body in enumerate(bodies, start):
        clock.advance(CHUNK_SECONDS)
        device.send(body, seq, session, expect=200)


def listed(device: Device, **query: object) -> list[Json]:
    found: list[Json] = device.get("events", params=query)["items"]
    return found


def states(database: Database) -> list[bytes | None]:
    with database.read() as tx:
        return tx.all(lambda state: state, sa.select(tables.installations.c.motion))


def test_a_crash_is_told_with_direction_and_size(api: Api, clock: Clock) -> None:
    story, device = crashed(), api.add_device()
    begun = clock.now
    play(device, clock, story.chunks)
    (event,) = listed(device, kind="impact")
    assert event == device.get(f"events/{event['id']}")
    assert event["t"] == pytest.approx(story.hit.t + story.hit.duration / 2, abs=0.03)
    moment = datetime.fromisoformat(event["at"])
    assert moment - begun == pytest.approx(timedelta(seconds=event["t"]), abs=timedelta(seconds=0.1))
    assert datetime.fromisoformat(event["start_at"]) <= moment
    assert event["direction_deg"] == pytest.approx(38.0, abs=6.0)
    change = story.hit.velocity_change
    assert event["speed_change_mps"] == pytest.approx(change.tolist(), abs=0.15 * float(np.hypot(*change)))
    assert event["peak_mps2"] == pytest.approx(story.hit.peak, rel=0.25)
    assert (event["mount"], event["session"], event["kept"]) == (1, "a", True)


def test_events_move_with_what_is_known_of_the_beginning_of_their_session(api: Api, clock: Clock) -> None:
    """As `/motion` tells them; those of another session stay."""
    story, device = crashed(), api.add_device()
    play(device, clock, story.chunks, "before")
    begun = clock.now
    clock.advance(3600.0)
    for seq, body in enumerate(story.chunks):
        device.send(body, seq, "late", expect=200)  # a minute of samples in no time
    new, old = listed(device, kind="impact")
    moment = datetime.fromisoformat(new["at"])
    sent = begun + timedelta(hours=1)
    assert moment == pytest.approx(sent - timedelta(seconds=len(story.chunks) * CHUNK_SECONDS - new["t"]), abs=LITTLE)
    motion = device.get("motion", params={"from": _around(moment, -5), "to": _around(moment, 5)})
    assert min(motion["columns"]["longitudinal_mps2"]) < -0.5 * new["peak_mps2"]
    assert datetime.fromisoformat(old["at"]) < begun
    assert listed(device, kind="impact", to=begun.isoformat()) == [old]


def _around(moment: datetime, seconds: float) -> str:
    return (moment + timedelta(seconds=seconds)).isoformat()


def test_an_impact_is_an_alert_that_stays_open(api: Api, clock: Clock) -> None:
    story, device = crashed(), api.add_device()
    play(device, clock, story.chunks)
    alert, (event,) = the_alert(api, "impact"), listed(device, kind="impact")
    assert (alert["state"], alert["severity"], alert["count"]) == ("open", "critical", 1)
    assert alert["message"].startswith("Impact from the front left (")
    at = datetime.fromisoformat(event["at"])
    assert alert["message"].endswith(f"at {at:%H:%M} UTC.")
    data = alert["data"]
    assert set(findings.DATA) < set(data)
    told = ("direction_deg", "peak_mps2", "duration_s", "speed_change_mps", "speed_mps", "mount", "session", "t")
    assert {name: data[name] for name in told} == {name: event[name] for name in told}
    assert data["event"] == event["id"]
    clock.advance(30 * 86400)
    play(device, clock, story.chunks[:2], "b")
    api.post(f"/devices/{device.id}/installation/restart")
    assert the_alert(api, "impact")["state"] == "open"
    assert api.post(f"/alerts/{alert['id']}/resolve", {"note": "towed"})["state"] == "resolved"


def test_harsh_driving_is_told_when_it_comes_often(api: Api, clock: Clock) -> None:
    device = api.add_device()
    samples = manoeuvres(3, 900.0, 50.0).samples
    bounds = np.searchsorted(samples.t, np.arange(0.0, 901.0, CHUNK_SECONDS))
    chunks = [samples.slice(start, stop) for start, stop in pairwise(bounds.tolist())]
    play(device, clock, tuple(map(write_native_csv, chunks)))
    found = listed(device)
    assert len(found) >= 3
    assert {event["kind"] for event in found} <= set(KINDS[1:])
    alert = the_alert(api, "harsh_driving")
    assert (alert["severity"], alert["state"]) == ("info", "open")
    assert set(alert["data"]) == set(findings.DATA)
    assert (alert["data"]["seen"], alert["data"]["threshold"], alert["data"]["unit"]) == (3.0, 3.0, "events")
    third = sorted(found, key=lambda event: event["at"])[2]
    assert alert["opened_at"] >= third["at"]


def test_nothing_is_looked_for_without_a_mounting_in_force(api: Api, clock: Clock, database: Database) -> None:
    story, device = remounted(), api.add_device()
    for number, body in enumerate(story.chunks):
        clock.advance(CHUNK_SECONDS)
        device.send(body, number, expect=200)
        in_force = (device.installation()["mount"] or {"status": ""})["status"] == "in_force"
        assert (states(database) != [None]) == in_force, number
    assert states(database) != [None]
    api.post(f"/devices/{device.id}/installation/restart")
    assert states(database) == [None]


def test_an_event_found_before_the_device_moved_belongs_to_the_former_mounting(
    api: Api, clock: Clock, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One chunk confirms, moves and confirms anew: each event is told with the mounting of its time."""
    story, device = remounted(), api.add_device()
    straight = detector.advance

    def one_each(*given: object) -> tuple[object, tuple[MotionEvent, ...]]:
        state, _ = straight(*given)  # type: ignore[arg-type]
        t = float(given[3].t[-1])  # type: ignore[attr-defined]
        kind = detector.EventKind.HARSH_BRAKING
        return state, (MotionEvent(kind, t, t - 1, 1.0, 4.0, 0.0, (-1.0, 0.0), math.nan),)

    monkeypatch.setattr(detector, "advance", one_each)
    whole = write_native_csv(story.samples)
    clock.advance(float(story.samples.t[-1]))
    device.send(whole, 0, expect=200)
    found = listed(device)
    assert [event["mount"] for event in found] == [2, 1]
    confirmed = [datetime.fromisoformat(mount["confirmed_at"]) for mount in device.get("mounts")["items"]]
    moments = [datetime.fromisoformat(event["at"]) for event in found]
    assert moments[0] > confirmed[0] > moments[1] > confirmed[1]
    assert [event["speed_mps"] for event in found] == [None, None]


@pytest.mark.parametrize("backend", ["sqlite"], indirect=True)
def test_events_are_looked_for_once_and_before_the_lock(
    api: Api, clock: Clock, monkeypatch: pytest.MonkeyPatch
) -> None:
    looks: list[str] = []
    for where in (foresight, calibration):
        monkeypatch.setattr(where, "detect", _noting(foresight.detect, looks, where.__name__))
    story, device = crashed(), api.add_device()
    play(device, clock, story.chunks)
    play(device, clock, story.chunks[:1], "b")
    assert looks == ["api.services.foresight"] * (len(story.chunks) + 1)
    assert len(listed(device, kind="impact")) == 1


def _noting(detect: Callable[..., object], looks: list[str], where: str) -> Callable[..., object]:
    def noting(*given: object) -> object:
        looks.append(where)
        return detect(*given)

    return noting


def test_a_state_that_cannot_be_read_begins_anew(
    api: Api, clock: Clock, database: Database, caplog: pytest.LogCaptureFixture
) -> None:
    story, device = crashed(), api.add_device()
    play(device, clock, story.chunks[: story.struck])
    with database.write() as tx:
        tx.execute(sa.update(tables.installations).values(motion=b"from another version"))
    play(device, clock, story.chunks[story.struck :], start=story.struck)
    assert len(listed(device, kind="impact")) == 1
    assert "starts anew" in caplog.text


def test_lists_are_cut_filtered_and_continued(api: Api, clock: Clock, database: Database) -> None:
    device, other = api.add_device("a"), api.add_device("b")
    play(device, clock, crashed().chunks[:1])
    now = clock.now
    with database.write() as tx:
        session, pk = tx.connection.execute(sa.select(tables.sessions.c.pk, tables.sessions.c.device_pk)).one()
        data = {"start": 1.0, "duration": 1.0, "peak": 5.0, "direction": None, "velocity_change": [0, 0]}
        data |= {"speed": None, "mount": 1}
        row = {"device_pk": pk, "session_pk": session, "seq": 99, "t": 2.0, "data": data}
        rows = [row | {"kind": KINDS[n % 5], "at": now + timedelta(seconds=n // 2)} for n in range(20)]
        tx.connection.execute(sa.insert(tables.motion_events), rows)
    whole = listed(device)
    assert [event["kind"] for event in whole] == [KINDS[n % 5] for n in reversed(range(20))]
    assert not any(event["kept"] for event in whole)
    pages, cursor = [], None
    while True:
        page = device.get("events", params={"limit": 3} | ({"cursor": cursor} if cursor else {}))
        pages += page["items"]
        if (cursor := page["next_cursor"]) is None:
            break
    assert pages == whole
    assert {event["kind"] for event in listed(device, kind="pothole")} == {"pothole"}
    span = {"from": (now + timedelta(seconds=3)).isoformat(), "to": (now + timedelta(seconds=4)).isoformat()}
    assert listed(device, **span) == whole[10:14]
    assert listed(other) == []
    other.get(f"events/{whole[0]['id']}", 404)
    device.get("events", 422, params={"kind": "earthquake"})
    device.get("events", 422, params={"cursor": "???"})
