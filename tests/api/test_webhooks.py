import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from standardwebhooks import Webhook as Library
from standardwebhooks import WebhookVerificationError
from starlette.testclient import TestClient

from api.app import create_app
from api.settings import Settings
from storage import alerts, deliveries, devices
from storage.alerts import Finding
from storage.database import Database
from tests.conftest import Clock
from tests.receiver import Answer, Receiver, running_receiver
from tests.server import ServerProcess, running
from tests.service import Api

DRAFT = {"name": "Desk", "url": "https://203.0.114.1/hook"}


@pytest.fixture
def receiver() -> Iterator[Receiver]:
    with running_receiver() as started:
        yield started


@pytest.fixture
def here(settings: Settings) -> Iterator[Api]:
    """The service on the real clock, which may call 127.0.0.1."""
    chosen = settings.model_copy(update={"webhook_allow_private": True})
    with TestClient(create_app(chosen), raise_server_exceptions=False) as client:
        yield Api(client)


def raise_alert(database: Database, device: str, kind: str = "device_loose") -> None:
    """Open an alert beside the service, with its changes told."""
    from api.services import publishing
    from api.services.context import utc_now

    with database.write() as tx:
        finding = Finding(kind, "critical", "The device is loose.", {})
        pk = alerts.raise_(tx, devices.exists(tx, device) or 0, finding, utc_now())
        publishing.alert_changed(tx, pk, utc_now())


def verified(secret: str, call: Any) -> Any:
    return Library(secret).verify(call.body, call.headers)


def test_make_read_list_edit_remove(api: Api) -> None:
    made = api.post("/webhooks", DRAFT | {"severities": ["critical"]}, 201)
    webhook = made["webhook"]
    assert made["secret"].startswith("whsec_")
    assert webhook == {
        "id": webhook["id"],
        "name": "Desk",
        "url": DRAFT["url"],
        "kinds": None,
        "severities": ["critical"],
        "active": True,
        "created_at": "2024-05-06T07:08:09Z",
        "created_by": "admin",
        "failing_since": None,
        "last_success_at": None,
    }
    path = f"/webhooks/{webhook['id']}"
    assert api.get(path) == webhook
    assert api.get("/webhooks") == {"items": [webhook], "next_cursor": None}
    edited = api.call("PATCH", path, 200, json={"kinds": ["gps_lost"], "active": False}).json()
    assert edited == webhook | {"kinds": ["gps_lost"], "active": False} == api.get(path)
    assert api.call("PATCH", path, 200, json={"kinds": None}).json()["kinds"] is None
    api.call("DELETE", path, 204)
    for method, gone in (("GET", path), ("DELETE", path), ("GET", f"{path}/deliveries"), ("POST", f"{path}/test")):
        api.call(method, gone, 404)
    api.call("PATCH", path, 404, json={"active": True})
    api.call("POST", f"{path}/secret", 404)
    api.call("POST", f"{path}/redeliver", 404)


def test_pages(api: Api) -> None:
    made = [api.post("/webhooks", DRAFT | {"name": f"{n}"}, 201)["webhook"]["name"] for n in range(5)]
    seen: list[str] = []
    cursor: str | None = None
    while cursor or not seen:
        page = api.get("/webhooks", params={"limit": 2} | ({"cursor": cursor} if cursor else {}))
        seen += [webhook["name"] for webhook in page["items"]]
        cursor = page["next_cursor"]
    assert seen == made[::-1]


def test_the_secret_is_shown_once_and_can_be_changed(api: Api) -> None:
    made = api.post("/webhooks", DRAFT, 201)
    path = f"/webhooks/{made['webhook']['id']}"
    changed = api.post(f"{path}/secret")
    assert changed["webhook"] == made["webhook"]
    assert changed["secret"] != made["secret"]
    for shown in (api.call("GET", path).text, api.call("GET", "/webhooks").text):
        assert "whsec" not in shown
        assert "secret" not in shown


@pytest.mark.parametrize("role", ["installer", "device", None])
def test_only_managers(api: Api, database: Database, role: str | None) -> None:
    from api.services import access
    from storage import keys

    key = None if role is None else access.new_key()
    if key is not None and role is not None:
        with database.write() as tx:
            keys.add(tx, access.digest(key), role, "somebody", Clock().now)
    caller, expected = api.as_(key), 401 if key is None else 403
    caller.call("GET", "/webhooks", expected)
    caller.call("POST", "/webhooks", expected, json=DRAFT)
    for method, end in (("GET", ""), ("DELETE", ""), ("POST", "/test"), ("POST", "/secret"), ("GET", "/deliveries")):
        caller.call(method, f"/webhooks/1{end}", expected)


@pytest.mark.parametrize(
    "wrong",
    [
        {"url": "http://203.0.114.1/"},
        {"url": "https://127.0.0.1/"},
        {"url": "https://localhost/"},
        {"url": "https://[::ffff:10.0.0.1]/"},
        {"url": "https://2130706433/"},
        {"url": "https://user:pass@203.0.114.1/"},
        {"url": "https://203.0.114.1/" + "x" * 2048},
        {"url": "https://203.0.114.1/\n"},
        {"url": ""},
        {"url": None},
        {"name": ""},
        {"name": "x" * 129},
        {"kinds": []},
        {"kinds": ["earthquake"]},
        {"severities": ["mild"]},
        {"active": None},
        {"secret": "whsec_mine"},
    ],
)
def test_what_is_refused(api: Api, wrong: dict[str, Any]) -> None:
    api.call("POST", "/webhooks", 422, json=DRAFT | wrong)
    made = api.post("/webhooks", DRAFT, 201)["webhook"]
    api.call("PATCH", f"/webhooks/{made['id']}", 422, json=wrong)
    assert api.get(f"/webhooks/{made['id']}") == made


def test_an_alert_is_sent_and_verified_by_the_library(here: Api, database: Database, receiver: Receiver) -> None:
    made = here.post("/webhooks", {"name": "Desk", "url": receiver.url}, 201)
    here.add_device()
    raise_alert(database, "box-1")
    (call,) = receiver.wait_for(1)
    told = verified(made["secret"], call)
    assert told["type"] == "alert.opened"
    (alert,) = here.get("/alerts")["items"]
    assert told["data"] == alert
    with pytest.raises(WebhookVerificationError):
        Library(here.post(f"/webhooks/{made['webhook']['id']}/secret")["secret"]).verify(call.body, call.headers)
    here.post(f"/alerts/{alert['id']}/acknowledge", {"note": "seen"})
    here.post(f"/alerts/{alert['id']}/resolve", {})
    assert [c.json["type"] for c in receiver.wait_for(3)[1:]] == ["alert.acknowledged", "alert.resolved"]


def test_deliveries_are_listed(here: Api, database: Database, receiver: Receiver) -> None:
    path = f"/webhooks/{here.post('/webhooks', {'name': 'Desk', 'url': receiver.url}, 201)['webhook']['id']}"
    here.add_device()
    for _ in range(3):
        raise_alert(database, "box-1")
    receiver.wait_for(3)
    shown = settled(here, path)
    first = here.get(f"{path}/deliveries", params={"limit": 2})
    second = here.get(f"{path}/deliveries", params={"limit": 2, "cursor": first["next_cursor"]})
    assert first["items"] + second["items"] == shown
    assert second["next_cursor"] is None
    assert [delivery["type"] for delivery in shown] == ["alert.updated", "alert.updated", "alert.opened"]
    assert [delivery["message_id"] for delivery in shown[::-1]] == [call.id for call in receiver.calls]
    assert {(d["state"], d["attempts"], d["device_id"], d["last_status"]) for d in shown} == {
        ("delivered", 1, "box-1", 204)
    }
    assert here.get(path)["last_success_at"] is not None


def settled(api: Api, path: str) -> list[Any]:
    """Give the deliveries once none waits."""
    deadline = time.monotonic() + 20
    while True:
        shown: list[Any] = api.get(f"{path}/deliveries")["items"]
        if all(delivery["state"] != "pending" for delivery in shown):
            return shown
        assert time.monotonic() < deadline
        time.sleep(0.02)


def test_a_test_call_answers_how_it_went(here: Api, receiver: Receiver) -> None:
    made = here.post("/webhooks", {"name": "Desk", "url": receiver.url, "active": False}, 201)
    path = f"/webhooks/{made['webhook']['id']}"
    result = here.post(f"{path}/test")
    assert result == {"delivered": True, "status": 204, "error": None, "duration_ms": result["duration_ms"]}
    (call,) = receiver.calls
    assert verified(made["secret"], call)["type"] == "test"
    receiver.answer = Answer(500)
    failed = here.post(f"{path}/test")
    assert (failed["delivered"], failed["status"], failed["error"]) == (False, 500, "the receiver answered 500")
    shown = here.get(f"{path}/deliveries")["items"]
    assert [(d["type"], d["state"], d["attempts"]) for d in shown] == [("test", "failed", 1), ("test", "delivered", 1)]
    assert here.post(f"{path}/redeliver") == {"deliveries": 0}
    told = here.get("/audit", params={"action": "webhook.test"})["items"]
    assert [entry["detail"] for entry in told] == [{"delivered": False}, {"delivered": True}]


def test_a_url_that_became_private_is_not_called(api: Api, database: Database, receiver: Receiver) -> None:
    """The check when the webhook was made is a courtesy; the one that holds is made when the call is."""
    import sqlalchemy as sa

    from storage.models import webhooks

    made = api.post("/webhooks", DRAFT, 201)["webhook"]
    with database.write() as tx:
        tx.execute(sa.update(webhooks).values(url=receiver.url))
    result = api.post(f"/webhooks/{made['id']}/test")
    assert (result["delivered"], result["error"]) == (False, "the address is not one of the public internet")
    assert receiver.calls == []


def test_not_more_than_can_be_looked_at(api: Api, monkeypatch: pytest.MonkeyPatch) -> None:
    from api.services import webhooks

    monkeypatch.setattr(webhooks, "MOST", 1)
    api.post("/webhooks", DRAFT, 201)
    refused = api.call("POST", "/webhooks", 409, json=DRAFT).json()
    assert refused["detail"] == "There are 1 webhooks, which is as many as there may be."
    assert len(api.get("/webhooks")["items"]) == 1


@pytest.mark.slow
def test_a_killed_server_goes_on_where_it_was(
    database_url: str, database: Database, tmp_path: Path, receiver: Receiver
) -> None:
    receiver.answer = Answer(500)
    server = ServerProcess(database_url, tmp_path, webhook_allow_private="true")
    with running(server) as api:
        made = api.post("/webhooks", {"name": "Desk", "url": receiver.url}, 201)
        api.add_device()
        for _ in range(20):
            raise_alert(database, "box-1")
        receiver.wait_for(1)
        receiver.answer = Answer()
        receiver.wait_for(8)
        server.kill()
        server.start()
        server.wait_until_ready()
        with database.write() as tx:  # the claim of the killed server has run out
            tx.connection.exec_driver_sql("UPDATE webhook_deliveries SET claimed_until = NULL")
        shown = settled(api, f"/webhooks/{made['webhook']['id']}")
    came = list(dict.fromkeys(call.id for call in receiver.calls))
    assert came == [delivery["message_id"] for delivery in shown[::-1]]
    with database.read() as tx:
        assert deliveries.backlog(tx) == 0
