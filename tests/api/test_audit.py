from datetime import timedelta
from typing import Any

import pytest
import sqlalchemy as sa
from starlette.testclient import TestClient

from api.services import auditing, plain, retention
from api.services.access import Principal, Role
from api.services.context import Context
from storage.database import Database
from tests.conftest import Clock
from tests.drives import chunks, remounted
from tests.service import ADMIN_KEY, Api

NASTY = "Eve\n2024-05-06 admin key.create\x1b[31m\u202e"


def trail(api: Api, **query: Any) -> list[dict[str, Any]]:
    """What the audit trail tells, oldest first, without what the start of the service did."""
    entries: list[dict[str, Any]] = api.get("/audit", params=query)["items"]
    return [entry for entry in reversed(entries) if entry["actor"] != "service"]


def told(api: Api, **query: Any) -> list[tuple[str, str, str | None]]:
    return [(entry["actor"], entry["action"], entry["target"]) for entry in trail(api, **query)]


def test_what_is_done_to_devices_is_told(api: Api, clock: Clock) -> None:
    ida = api.post("/keys", {"role": "installer", "name": "Ida"}, 201)
    installer = api.as_(ida["key"])
    device = installer.add_device("a")
    device.send(chunks()[0], 0, expect=200)
    installer.call("PATCH", "/devices/a", 200, json={"notes": "new"})
    installer.post("/devices/a/installation/restart")
    installer.post("/devices/a/installation/level", expect=409)  # what is refused has not been done
    installer.post("/devices/a/key")
    installer.call("DELETE", "/devices/a", 204)
    installer.call("DELETE", "/devices/a", 404)
    made, *entries = trail(api)
    assert (made["action"], made["target"]) == ("key.create", f"keys/{ida['id']}")
    assert made["detail"] == {"role": "installer", "name": "Ida", "device_id": None}
    verbs = ["device.register", "device.edit", "installation.restart", "device.rotate_key", "device.remove"]
    assert [entry["action"] for entry in entries] == verbs
    for entry in entries:
        assert (entry["actor"], entry["role"], entry["key_id"]) == ("Ida", "installer", ida["id"])
        assert entry["target"] == "devices/a"
        assert entry["at"] == clock().isoformat().replace("+00:00", "Z")
    assert entries[1]["detail"] == {"notes": "new"}


def test_what_is_done_with_keys_and_sign_ins_is_told(api: Api, client: TestClient) -> None:
    pk = api.post("/keys", {"role": "manager", "name": "Max"}, 201)["id"]
    api.call("DELETE", f"/keys/{pk}", 204)
    client.post("/api/v1/session", json={"key": "a-secret-typed-wrongly"})
    client.post("/api/v1/session", json={"key": ADMIN_KEY})
    client.delete("/api/v1/session")
    client.delete("/api/v1/session")
    assert told(api) == [
        ("admin", "key.create", f"keys/{pk}"),
        ("admin", "key.revoke", f"keys/{pk}"),
        ("unknown", "session.refused", None),
        ("admin", "session.sign_in", None),
        ("admin", "session.sign_out", None),
    ]
    refused = trail(api, action="session.refused")[0]
    assert (refused["role"], refused["key_id"], refused["detail"]) == ("none", None, {"address": "testclient"})


def test_what_is_done_with_webhooks_is_told_without_secrets(api: Api, clock: Clock) -> None:
    max_ = api.as_(api.post("/keys", {"role": "manager", "name": "Max"}, 201)["key"])
    hook = {"name": "Desk", "url": "https://203.0.114.1:8443/hook/TOKEN?key=TOKEN"}
    api.post("/webhooks", hook | {"url": "https://127.0.0.1/"}, 422)  # what is refused has not been done
    made = max_.post("/webhooks", hook, 201)
    path = f"/webhooks/{made['webhook']['id']}"
    max_.call("PATCH", path, 200, json={"url": "https://203.0.114.1/TOKEN", "active": False})
    max_.call("PATCH", path, 200, json={"kinds": ["gps_lost"]})
    rotated = max_.post(f"{path}/secret")
    max_.post(f"{path}/redeliver")
    max_.call("DELETE", path, 204)
    max_.call("DELETE", path, 404)
    _, *entries = trail(api)
    assert [(entry["action"], entry["detail"]) for entry in entries] == [
        (
            "webhook.create",
            {"name": "Desk", "url": "https://203.0.114.1:8443", "kinds": None, "severities": None, "active": True},
        ),
        ("webhook.edit", {"url": "https://203.0.114.1", "active": False}),
        ("webhook.edit", {"kinds": ["gps_lost"]}),
        ("webhook.rotate_secret", None),
        ("webhook.redeliver", {"deliveries": 0}),
        ("webhook.remove", None),
    ]
    assert {(entry["actor"], entry["role"], entry["target"]) for entry in entries} == {("Max", "manager", path[1:])}
    whole = str(trail(api))
    assert not any(secret in whole for secret in ("TOKEN", made["secret"], rotated["secret"]))


def test_what_is_done_about_alerts_is_told(api: Api) -> None:
    story = remounted()
    api.add_device("moved").send_all(story.chunks[: story.moved + 1])
    (alert,) = api.get("/alerts")["items"]
    for verb, note in (("acknowledge", "I go"), ("acknowledge", "again"), ("resolve", None)):
        api.post(f"/alerts/{alert['id']}/{verb}", {"note": note})
    entries = trail(api, target=f"alerts/{alert['id']}")
    assert [(entry["action"], entry["detail"]) for entry in entries] == [
        ("alert.acknowledge", {"device_id": "moved", "note": "I go"}),
        ("alert.resolve", {"device_id": "moved", "note": None}),
    ]


def test_the_trail_is_searched_and_read_page_by_page(api: Api, clock: Clock) -> None:
    for device_id in ("a", "b", "c"):
        api.add_device(device_id)
        clock.advance(60)
    api.call("DELETE", "/devices/b", 204)
    assert [target for _, _, target in told(api, target="devices/b")] == ["devices/b", "devices/b"]
    assert len(told(api, action="device.register")) == 3
    assert told(api, actor="nobody") == []
    since, until = clock() - timedelta(seconds=120), clock()
    assert [target for _, _, target in told(api, since=since.isoformat(), until=until.isoformat())] == [
        "devices/b",
        "devices/c",
    ]
    first = api.get("/audit", params={"limit": 3})
    second = api.get("/audit", params={"limit": 3, "cursor": first["next_cursor"]})
    numbers = [entry["id"] for entry in first["items"] + second["items"]]
    assert numbers == sorted(numbers, reverse=True)
    assert len(numbers) == 5
    assert second["next_cursor"] is None


def test_no_secret_is_in_the_trail(api: Api, client: TestClient, database: Database) -> None:
    device = api.add_device("a")
    keys = [
        device.key,
        api.post("/devices/a/key")["key"],
        api.post("/keys", {"role": "admin", "name": "x"}, 201)["key"],
    ]
    for key in (*keys, "a-wrong-secret", ADMIN_KEY):
        client.post("/api/v1/session", json={"key": key})
    with database.read() as tx:
        everything = str(list(tx.connection.execute(sa.text("SELECT * FROM audit"))))
    for secret in (*(key[8:] for key in keys), "a-wrong-secret", ADMIN_KEY, client.cookies["livella_session"]):
        assert secret not in everything


def test_an_entry_is_undone_with_what_it_tells(api: Api, client: TestClient, clock: Clock) -> None:
    context: Context = client.app_state["context"]

    def fail() -> None:
        with context.database.write() as tx:
            auditing.record(tx, Principal(1, Role.ADMIN, "admin"), "device.edit", "devices/a", None, clock())
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        fail()
    assert told(api) == []


def test_a_name_cannot_forge_an_entry(api: Api) -> None:
    eve = api.as_(api.post("/keys", {"role": "installer", "name": NASTY}, 201)["key"])
    eve.add_device("a")
    actor, action, _ = told(api)[-1]
    assert action == "device.register"
    assert actor == r"Eve\n2024-05-06 admin key.create\x1b[31m\u202e"
    assert told(api, actor=actor) == told(api)[-1:]


def test_texts_are_put_on_one_line() -> None:
    assert plain.one_line("Zoë's van 7") == "Zoë's van 7"
    assert plain.one_line("a\r\nb\tc\x00\u2028") == r"a\r\nb\tc\x00\u2028"
    assert plain.one_line("\n" * 100, 128) == r"\n" * 64


def test_an_entry_tells_the_request_of_which_the_log_tells_too(api: Api) -> None:
    api.call("POST", "/devices", 201, json={"id": "box", "name": "Box"}, headers={"X-Request-ID": "from-the-workshop"})
    assert [entry["request_id"] for entry in trail(api)] == ["from-the-workshop"]


def test_the_trail_is_kept_as_long_as_the_setting_says(api: Api, client: TestClient, clock: Clock) -> None:
    context: Context = client.app_state["context"]
    api.add_device("old")
    clock.advance(context.settings.audit_days * 86400)
    api.add_device("new")
    retention.tidy(context)
    assert len(told(api)) == 2
    clock.advance(1)
    retention.tidy(context)
    assert [target for _, _, target in told(api)] == ["devices/new"]
