"""The server's clock is set back by an hour in the middle: nothing is lost, and everything is in order."""

from datetime import timedelta

import pytest
import sqlalchemy as sa

from api.services import housekeeping, ingest, retention, startup
from api.services.context import Context
from api.services.leading import LEASE, Leadership
from api.settings import Settings
from storage.database import Database
from storage.models import chunks as receipts
from storage.models import estimates
from tests.conftest import Clock
from tests.drives import chunks, remounted
from tests.service import Api, Device

HOUR = 3600.0


def drive(device: Device, clock: Clock, bodies: tuple[bytes, ...], session: str, start: int = 0) -> None:
    for seq, body in enumerate(bodies, start):
        clock.advance(30)
        device.send(body, seq, session, expect=200)


def test_a_drive_goes_on(api: Api, clock: Clock, database: Database) -> None:
    """With the same estimates, mountings and alerts as if the clock had been left alone."""
    story = remounted()
    calm, disturbed = api.add_device("calm"), api.add_device("disturbed")
    drive(calm, clock, story.chunks, "a")
    middle = story.moved - 1
    drive(disturbed, clock, story.chunks[:middle], "a")
    clock.advance(-HOUR)
    drive(disturbed, clock, story.chunks[middle:], "a", middle)
    for column in ("t", "quaternion", "stage"):
        assert disturbed.get("estimates")[column] == calm.get("estimates")[column]
    assert len(disturbed.get("mounts")["items"]) == len(calm.get("mounts")["items"]) == 2
    with database.read() as tx:
        assert tx.value(sa.select(sa.func.count()).where(receipts.c.state != "applied")) == 0
    shown = [api.get("/alerts", params={"device_id": device.id})["items"] for device in (calm, disturbed)]
    kinds = [[alert["kind"] for alert in alerts] for alerts in shown]
    assert kinds[0] == kinds[1]
    for alert in shown[1]:
        assert alert["opened_at"] <= alert["updated_at"]


def test_history_and_alerts_stay_in_order(api: Api, clock: Clock) -> None:
    device, bodies = api.add_device(), chunks()
    drive(device, clock, bodies[:4], "a")
    clock.advance(-HOUR)
    drive(device, clock, bodies[:4], "b")
    told = device.get("estimates")
    assert told["time"] == sorted(told["time"])
    assert set(told["session"]) == {"a", "b"}
    window = device.get("estimates", params={"from": told["time"][0], "to": told["time"][-1]})
    assert window == told
    early = [moment for moment, session in zip(told["time"], told["session"], strict=True) if session == "b"]
    part = device.get("estimates", params={"from": early[0], "to": early[-1]})
    assert set(early) <= set(part["time"])


def test_an_alert_opened_before_is_acknowledged_and_resolved_after(api: Api, clock: Clock) -> None:
    story, device = remounted(), api.add_device()
    drive(device, clock, story.chunks[: story.moved + 1], "a")
    (alert,) = api.get("/alerts", params={"kind": "orientation_changed"})["items"]
    clock.advance(-HOUR)
    for action in ("acknowledge", "resolve"):
        after = api.post(f"/alerts/{alert['id']}/{action}", {"note": "seen"})
        assert after["opened_at"] <= after["updated_at"]
    assert after["state"] == "resolved"
    drive(device, clock, story.chunks[story.moved + 1 :], "a", story.moved + 1)
    assert device.installation()["mount"]["status"] == "in_force"


def test_a_gap_is_still_declared_ten_minutes_later(
    api: Api, clock: Clock, settings: Settings, database: Database
) -> None:
    device, bodies = api.add_device(), chunks()
    drive(device, clock, bodies[:1], "a")
    device.send(bodies[2], 2, expect=202)
    other = Context.make(settings, clock)
    clock.advance(-HOUR)
    ingest.close_gaps(other)
    clock.advance(settings.gap_timeout - 1)
    ingest.close_gaps(other)
    assert device.send(bodies[2], 2, expect=202).json()["chunk"]["state"] == "waiting"
    clock.advance(2)
    ingest.close_gaps(other)
    other.database.close()
    assert device.send(bodies[2], 2, expect=200).json()["chunk"]["state"] == "applied"
    device.send(bodies[1], 1, expect=409)


def test_the_leader_goes_on_and_history_ages_later(settings: Settings, clock: Clock, api: Api) -> None:
    device, bodies = api.add_device(), chunks()
    drive(device, clock, bodies[:2], "a")
    context = Context.make(settings, clock)
    startup.prepare(context)
    leadership = Leadership(context)
    clock.advance(2 * HOUR + LEASE.total_seconds())
    coarsen = next(job for job in housekeeping.JOBS if job.work is retention.coarsen)
    assert leadership.held()
    clock.advance(-HOUR)
    assert housekeeping.do(coarsen, context, leadership) is False
    assert leadership.held()
    clock.advance(15 * 24 * HOUR)
    while housekeeping.do(coarsen, context, leadership):
        clock.advance(-HOUR / 60)
    with context.database.read() as tx:
        assert tx.value(sa.select(sa.func.count()).select_from(estimates)) == 0
    context.database.close()
    assert 1 <= len(device.get("estimates")["time"]) <= 4


@pytest.mark.parametrize("ahead", [HOUR, 400 * 24 * HOUR])
def test_a_clock_that_was_ahead_loses_no_history_of_the_right_time(
    api: Api, clock: Clock, settings: Settings, ahead: float
) -> None:
    """What came in while it was ahead is kept by the time it was given."""
    device, bodies = api.add_device(), chunks()
    clock.advance(ahead)
    drive(device, clock, bodies[:2], "a")
    clock.advance(-ahead)
    drive(device, clock, bodies[:2], "b")
    told = device.get("estimates")
    assert told["time"] == sorted(told["time"])
    recent = device.get("estimates", params={"to": (clock() + timedelta(minutes=1)).isoformat()})
    assert set(recent["session"]) == {"b"}
    with_context = Context.make(settings, clock)
    assert retention.coarsen(with_context) is False
    with_context.database.close()
