from datetime import UTC, datetime, timedelta
from typing import Any

import numpy as np
import pytest
import sqlalchemy as sa

import core
from api.services import alerting, findings
from api.services.findings import Where
from api.services.words import degrees_text
from storage import alerts
from storage import models as tables
from storage.database import Database
from tests.conftest import Clock
from tests.drives import CHUNK_SECONDS, REMOUNTED_AT, remounted
from tests.service import Api, Device

NOW = datetime(2024, 5, 6, 7, 8, 9, tzinfo=UTC)


@pytest.fixture
def moved(api: Api) -> Device:
    device = api.add_device()
    device.send_all(until_moved())
    return device


def until_moved() -> tuple[bytes, ...]:
    return remounted().chunks[: remounted().moved + 1]


def test_a_moved_device_opens_one_alert(moved: Device, api: Api, clock: Clock) -> None:
    (alert,) = api.get("/alerts")["items"]
    assert alert == api.get(f"/alerts/{alert['id']}")
    data = alert.pop("data")
    assert data["angle_deg"] == pytest.approx(60, abs=120)
    assert (data["session"], data["mount"]) == ("a", 1)
    assert REMOUNTED_AT < data["t"] < len(until_moved()) * CHUNK_SECONDS
    assert_says_how_it_moved(data, alert["message"])
    assert alert == {
        "id": alert["id"],
        "device_id": "box-1",
        "kind": "orientation_changed",
        "severity": "warning",
        "state": "open",
        "opened_at": "2024-05-06T07:08:09Z",
        "updated_at": "2024-05-06T07:08:09Z",
        "count": 1,
        "message": alert["message"],
        "acknowledged_at": None,
        "acknowledged_by": None,
        "acknowledge_note": None,
        "resolved_at": None,
        "resolved_by": None,
        "resolve_note": None,
    }
    assert api.get("/devices", params={"has_open_alert": True})["items"][0]["open_alerts"] == 1
    assert api.get("/fleet/summary")["alerts"] == {"orientation_changed": {"warning": 1}}


def assert_says_how_it_moved(data: dict[str, Any], message: str) -> None:
    """Check axis, beginning and evidence where the estimator gives them."""
    assert set(data) == {
        *("session", "t", "at", "since_t", "since", "mount", "quaternion", "sigma_deg"),
        *("angle_deg", "axis", "evidence", "fault", "reason"),
    }
    began = datetime.fromisoformat(data["at"]) - timedelta(seconds=data["t"])
    assert message.startswith("The device ")
    assert message.endswith(": the confirmed mounting no longer holds.")
    assert degrees_text(data["angle_deg"]) in message
    if data["axis"] is not None:
        assert np.linalg.norm(data["axis"]) == pytest.approx(1)
        assert "moved" not in message
    if data["since_t"] is not None:
        assert data["since_t"] <= data["t"]
        since = datetime.fromisoformat(data["since"])
        assert (since - began).total_seconds() == pytest.approx(data["since_t"], abs=0.01)
        assert f"{since:%H:%M} UTC" in message
    if data["evidence"] is not None:
        seen = data["evidence"]
        assert len(seen["t"]) == len(seen["value"])
        assert seen["value"][-1] >= seen["threshold"] > 0


def test_a_newly_confirmed_mounting_resolves_it_and_that_it_is_loose(
    moved: Device, api: Api, clock: Clock, database: Database
) -> None:
    find_fault(database, core.Fault.DEVICE_LOOSE)
    clock.advance(7)
    shown = moved.send_all(remounted().chunks[len(until_moved()) :], start=len(until_moved()))["installation"]
    found = api.get("/alerts")["items"]
    assert [alert["kind"] for alert in found] == ["device_loose", "orientation_changed"]
    assert shown["open_alerts"] == 0
    for alert in found:
        assert (alert["state"], alert["resolved_by"], alert["resolved_at"]) == (
            "resolved",
            "service",
            "2024-05-06T07:08:16Z",
        )
        assert alert["resolve_note"] == "A new mounting was confirmed."


def test_a_restart_resolves_it(moved: Device, api: Api) -> None:
    api.post(f"/devices/{moved.id}/installation/restart")
    assert [alert["state"] for alert in api.get("/alerts")["items"]] == ["resolved"]


def test_who_acknowledged_and_resolved_is_recorded(moved: Device, api: Api, clock: Clock) -> None:
    (alert,) = api.get("/alerts")["items"]
    path, revision = f"/alerts/{alert['id']}", moved.installation()["revision"]
    clock.advance(10)
    seen = api.post(f"{path}/acknowledge", {"note": "on my way"})
    assert (seen["state"], seen["acknowledged_by"], seen["acknowledge_note"]) == ("acknowledged", "admin", "on my way")
    assert moved.installation()["open_alerts"] == 1
    assert api.post(f"{path}/acknowledge", {"note": "me too"}) == seen
    over = api.post(f"{path}/resolve", {})
    assert (over["state"], over["resolved_by"], over["resolve_note"]) == ("resolved", "admin", None)
    assert over["acknowledge_note"] == "on my way"
    assert moved.installation()["open_alerts"] == 0
    assert moved.installation()["revision"] > revision
    assert api.post(f"{path}/acknowledge", {}) == over
    assert api.post(f"{path}/resolve", {"note": "again"}) == over
    for action in ("acknowledge", "resolve"):
        api.post(f"/alerts/999/{action}", {}, 404)
    api.get("/alerts/999", 404)
    api.get(f"/alerts/{10**30}", 422)


def test_alerts_are_listed_newest_first_and_filtered(api: Api, clock: Clock) -> None:
    for n in range(3):
        api.add_device(f"box-{n}").send_all(until_moved())
        clock.advance(60)
    page = api.get("/alerts", params={"limit": 2})
    assert devices(page) == ["box-2", "box-1"]
    assert devices(api.get("/alerts", params={"limit": 2, "cursor": page["next_cursor"]})) == ["box-0"]
    api.post(f"/alerts/{page['items'][0]['id']}/resolve", {})
    wanted: dict[str, list[str]] = {
        "state=open": ["box-1", "box-0"],
        "state=resolved": ["box-2"],
        "kind=orientation_changed&device_id=box-1": ["box-1"],
        "kind=gps_lost": [],
        "severity=critical": [],
        "severity=warning&state=open&since=2024-05-06T07:09:00Z": ["box-1"],
        "until=2024-05-06T07:09:09Z": ["box-0"],
        "since=2024-05-06T07:09:09Z": ["box-2", "box-1"],
    }
    for query, found in wanted.items():
        assert devices(api.get(f"/alerts?{query}")) == found, query
    for query in ("kind=x", "state=x", "severity=x", "since=x", "cursor=abc", "cursor=LTE"):
        api.get(f"/alerts?{query}", 422)


def devices(page: dict[str, list[dict[str, Any]]]) -> list[str]:
    return [alert["device_id"] for alert in page["items"]]


def test_a_milder_finding_does_not_hide_a_graver_one(moved: Device, api: Api, database: Database) -> None:
    found = [("critical", "left-handed", 1), ("warning", "saturated", 2), ("critical", "stuck", 3)]
    for severity, message, count in found:
        with database.write() as tx:
            pk = tx.value(sa.select(tables.devices.c.pk))
            alerts.raise_(tx, pk, alerts.Finding("sensor_fault", severity, message, {"n": count}), NOW)
        (alert,) = api.get("/alerts?kind=sensor_fault")["items"]
        assert alert["count"] == count
        assert (alert["severity"], alert["message"]) == ("critical", "stuck" if count == 3 else "left-handed")
        assert alert["data"] == {"n": 3 if count == 3 else 1}


def find_fault(database: Database, fault: core.Fault) -> None:
    event = core.Event(500.0, core.EventKind.FAULT, None, None, None, None, "what is wrong", None, 490.0, None, fault)
    with database.write() as tx:
        pk = tx.value(sa.select(tables.devices.c.pk))
        alerting.raise_for(tx, pk, event, Where("a", NOW, None), NOW)


@pytest.mark.parametrize("fault", core.Fault)
def test_a_fault_lasts_until_a_restart(moved: Device, api: Api, database: Database, fault: core.Fault) -> None:
    find_fault(database, fault)
    kind = findings.ALERTS[fault][0]
    (alert,) = api.get(f"/alerts?kind={kind}")["items"]
    assert (alert["state"], alert["data"]["fault"]) == ("open", fault.value)
    assert alert["data"]["since"] == "2024-05-06T07:16:19.000Z"
    api.post(f"/devices/{moved.id}/installation/restart")
    (alert,) = api.get(f"/alerts?kind={kind}")["items"]
    assert (alert["state"], alert["resolve_note"]) == ("resolved", "The calibration was restarted.")


def test_a_recurrence_raises_the_count(moved: Device, api: Api, database: Database, clock: Clock) -> None:
    (first,) = api.get("/alerts")["items"]
    clock.advance(5)
    finding = alerts.Finding("orientation_changed", "warning", "moved again", {"angle_deg": 3.0})
    with database.write() as tx:
        pk = tx.value(sa.select(tables.devices.c.pk))
        assert alerts.raise_(tx, pk, finding, clock.now) == first["id"]
    (alert,) = api.get("/alerts")["items"]
    assert (alert["count"], alert["message"], alert["state"]) == (2, "moved again", "open")
    assert (alert["opened_at"], alert["updated_at"]) == (first["opened_at"], "2024-05-06T07:08:14Z")
