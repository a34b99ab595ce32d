import threading
from contextlib import suppress
from datetime import datetime, timedelta
from typing import Any

import pytest
from starlette.testclient import TestClient

from api.app import create_app
from api.services import housekeeping, sign_ins, startup
from api.services.access import Principal, Role, authenticate
from api.services.context import Context
from api.services.errors import LastAdminError, UnauthenticatedError
from api.services.keyring import Wanted, create, revoke
from api.services.uses import AT_ONCE
from api.settings import Settings
from storage import keys
from storage.database import Database
from tests.conftest import Clock
from tests.drives import chunks
from tests.service import Api, Device

BY = Principal(1, Role.ADMIN, "admin")


def make(api: Api, role: str, name: str = "x", **more: Any) -> Any:
    return api.post("/keys", {"role": role, "name": name} | more, 201)


def listed(api: Api) -> dict[str, Any]:
    return {key["name"]: key for key in api.get("/keys")["items"]}


@pytest.mark.parametrize("role", ["installer", "manager", "admin"])
def test_a_key_is_shown_once_and_opens_the_service_until_it_is_revoked(api: Api, role: str, clock: Clock) -> None:
    made = make(api, role, " Ida ")
    key = made.pop("key")
    assert made | {"id": 0} == {
        "id": 0,
        "prefix": key[:12],
        "role": role,
        "name": "Ida",
        "device_id": None,
        "created_at": clock().isoformat().replace("+00:00", "Z"),
        "created_by": "admin",
        "last_used_at": None,
        "expires_at": None,
    }
    assert listed(api)["Ida"] == made
    assert key[12:] not in api.call("GET", "/keys").text
    api.as_(key).get("/devices")
    assert api.call("DELETE", f"/keys/{made['id']}").status_code == 204
    api.as_(key).call("GET", "/devices", 401)
    api.call("DELETE", f"/keys/{made['id']}", 404)


def test_a_key_for_a_device(api: Api) -> None:
    device = api.add_device()
    key = make(api, "device", device_id=device.id)["key"]
    api.as_(key).get(f"/devices/{device.id}/installation")
    assert [k["device_id"] for k in api.get("/keys")["items"]] == [None, device.id, device.id]
    make_nothing: list[tuple[dict[str, Any], int]] = [
        ({"role": "device", "name": "x"}, 422),
        ({"role": "admin", "name": "x", "device_id": device.id}, 422),
        ({"role": "device", "name": "x", "device_id": "nobody"}, 404),
        ({"role": "king", "name": "x"}, 422),
        ({"role": "admin", "name": " "}, 422),
        ({"role": "admin", "name": "x", "expires_at": "2024-05-06T07:08:09Z"}, 422),
        ({"role": "admin", "name": "x", "expires_at": "2034-05-06T07:08:09"}, 422),
    ]
    for draft, status in make_nothing:
        assert "livella_" not in api.call("POST", "/keys", status, json=draft).text
    assert len(api.get("/keys")["items"]) == 3


def test_the_list_is_found_page_by_page(api: Api) -> None:
    for n in range(5):
        make(api, "installer", f"k{n}")
    first = api.get("/keys", params={"limit": 4})
    second = api.get("/keys", params={"limit": 4, "cursor": first["next_cursor"]})
    assert [k["name"] for k in first["items"] + second["items"]] == ["admin", "k0", "k1", "k2", "k3", "k4"]
    assert second["next_cursor"] is None


def test_the_last_admin_key_cannot_be_revoked(api: Api, clock: Clock) -> None:
    (admin,) = api.get("/keys")["items"]
    ends = (clock() + timedelta(days=1)).isoformat()
    second = make(api, "admin", "second", expires_at=ends)
    clock.advance(86400)  # an expired one is none
    problem = api.call("DELETE", f"/keys/{admin['id']}", 409).json()
    assert problem["type"] == "urn:livella:problem:last-admin-key"
    api.call("DELETE", f"/keys/{second['id']}", 204)
    third = make(api, "admin", "third")
    api.as_(third["key"]).call("DELETE", f"/keys/{admin['id']}", 204)
    api.call("GET", "/keys", 401)
    api.as_(third["key"]).call("DELETE", f"/keys/{third['id']}", 409)


def test_two_admins_cannot_revoke_each_other_at_once(settings: Settings, clock: Clock) -> None:
    context = Context.make(settings, clock)
    startup.prepare(context)
    survivor = 1
    for _ in range(10):
        pair = (survivor, create(context, BY, Wanted("admin", "x")).id)
        threads = [threading.Thread(target=_revoke, args=(context, pk)) for pk in pair]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        with context.database.read() as tx:
            (survivor,) = keys.valid_of_role(tx, "admin", clock())
    context.database.close()


def _revoke(context: Context, pk: int) -> None:
    with suppress(LastAdminError):
        revoke(context, BY, pk)


# ---------------------------------------------------------------- expiry


def test_an_expired_key_opens_nothing(api: Api, client: TestClient, clock: Clock) -> None:
    ends = clock() + timedelta(hours=1)
    key = make(api, "manager", "Max", expires_at=ends.isoformat())["key"]
    assert client.post("/api/v1/session", json={"key": key}).status_code == 200
    context: Context = client.app_state["context"]
    direct, by_cookie = authenticate(context, key), sign_ins.recognise(context, client.cookies["livella_session"])
    clock.advance(3599)
    api.as_(key).get("/alerts")
    assert client.get("/api/v1/alerts").status_code == 200
    assert sign_ins.is_valid(context, direct)
    assert sign_ins.is_valid(context, by_cookie)
    clock.advance(1)
    assert api.as_(key).call("GET", "/alerts", 401).json() == api.as_("livella_x").call("GET", "/alerts", 401).json()
    assert client.get("/api/v1/alerts").status_code == 401
    assert not sign_ins.is_valid(context, direct)  # what an open stream asks
    assert not sign_ins.is_valid(context, by_cookie)
    assert datetime.fromisoformat(listed(api)["Max"]["expires_at"]) == ends


@pytest.mark.parametrize("end", ["expiry", "revocation", "sign-out"])
def test_an_open_stream_ends_with_what_opened_it(
    api: Api, client: TestClient, clock: Clock, monkeypatch: pytest.MonkeyPatch, end: str
) -> None:
    monkeypatch.setattr("api.routes.stream.CHECK_INTERVAL", 0.0)
    monkeypatch.setattr("api.live.IDLE_INTERVAL", 0.02)
    made = make(api, "installer", expires_at=(clock() + timedelta(hours=1)).isoformat())
    client.post("/api/v1/session", json={"key": made["key"]})
    headers = {} if end == "sign-out" else {"Authorization": f"Bearer {made['key']}"}
    stream = threading.Thread(target=client.get, args=("/api/v1/stream",), kwargs={"headers": headers})
    stream.start()
    stream.join(0.3)
    assert stream.is_alive()
    if end == "expiry":
        clock.advance(3600)
    elif end == "revocation":
        api.call("DELETE", f"/keys/{made['id']}", 204)
    else:
        client.delete("/api/v1/session")
    stream.join(10)
    assert not stream.is_alive()


def test_a_start_with_expired_admin_keys_only_makes_another(settings: Settings, clock: Clock) -> None:
    context = Context.make(settings.model_copy(update={"admin_key": None}), clock)
    first = startup.prepare(context)
    assert first is not None
    create(context, BY, Wanted("admin", "x", expires_at=clock() + timedelta(days=1)))
    with context.database.write() as tx:
        keys.remove(tx, 1)
    assert startup.prepare(context) is None
    clock.advance(86400)
    second = startup.prepare(context)
    assert second is not None
    assert authenticate(context, second).role == Role.ADMIN
    with pytest.raises(UnauthenticatedError):
        authenticate(context, first)
    context.database.close()


# ---------------------------------------------------------------- rotation


def test_a_devices_new_key_takes_the_place_of_the_old_ones(api: Api) -> None:
    device, other = api.add_device("a"), api.add_device("b")
    more = make(api, "device", device_id="a")["key"]
    installer = api.as_(make(api, "installer")["key"])
    made = installer.post("/devices/a/key")
    assert made["device"]["id"] == "a"
    for former in (device.key, more):
        api.as_(former).call("GET", "/devices/a/installation", 401)
    renewed = Device(api, "a", made["key"])
    renewed.send(chunks()[0], 0, expect=200)
    renewed.api.call("GET", "/devices/b/installation", 403)
    other.installation()
    installer.call("POST", "/devices/c/key", 404)
    assert [k["created_by"] for k in api.get("/keys")["items"] if k["device_id"] == "a"] == ["x"]


# ---------------------------------------------------------------- last use


@pytest.fixture
def uses_left_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """Keep a service that starts after this from writing uses by itself."""
    jobs = tuple(job for job in housekeeping.JOBS if job.work is not housekeeping.write_uses)
    assert len(jobs) == len(housekeeping.JOBS) - 1
    monkeypatch.setattr(housekeeping, "JOBS", jobs)


@pytest.mark.usefixtures("uses_left_alone")  # which come before the client
def test_last_use_is_written_now_and_then_and_never_by_a_request(
    api: Api, client: TestClient, clock: Clock, database: Database
) -> None:
    context: Context = client.app_state["context"]
    device = api.add_device("a")
    device.send(chunks()[0], 0, expect=200)
    sent_at = clock()
    assert last_used(database, "a") is None
    housekeeping.write_uses(context)
    assert last_used(database, "a") == sent_at
    clock.advance(59)
    device.installation()
    housekeeping.write_uses(context)
    assert last_used(database, "a") == sent_at  # not twice a minute, whichever process writes
    clock.advance(1)
    device.installation()
    housekeeping.write_uses(context)
    assert last_used(database, "a") == clock()
    housekeeping.write_uses(context)
    assert listed(api)["a"]["last_used_at"] is not None


def last_used(database: Database, name: str) -> datetime | None:
    with database.read() as tx:
        return next(key.last_used_at for key in keys.every(tx) if key.name == name)


def test_last_use_is_written_at_the_end(settings: Settings, clock: Clock, database: Database) -> None:
    with TestClient(create_app(settings, clock)) as client:
        Api(client).get("/devices")
    assert last_used(database, "admin") == clock()


def test_many_uses_are_written_in_small_transactions(settings: Settings, clock: Clock, database: Database) -> None:
    context = Context.make(settings, clock)  # of no service, whose housekeeping would write some of them
    startup.prepare(context)
    admin = last_key(database)
    for key_pk in (*range(10_000, 10_000 + 2 * AT_ONCE), admin):
        context.uses.mark(key_pk, clock())
    assert housekeeping.write_uses(context)
    assert housekeeping.write_uses(context)
    assert last_used(database, "admin") is None
    assert not housekeeping.write_uses(context)
    assert last_used(database, "admin") == clock()
    context.database.close()


def last_key(database: Database) -> int:
    with database.read() as tx:
        return max(key.pk for key in keys.every(tx))


@pytest.mark.parametrize("backend", ["sqlite"], indirect=True)
def test_uses_that_cannot_be_written_are_written_later(settings: Settings, clock: Clock) -> None:
    context = Context.make(settings, clock)
    context.uses.mark(1, clock())
    with pytest.raises(Exception, match="api_keys"):  # no tables yet
        housekeeping.write_uses(context)
    housekeeping.finish(context)
    startup.prepare(context)
    context.uses.mark(999, clock())  # revoked meanwhile
    housekeeping.write_uses(context)
    assert last_used(context.database, "admin") == clock()
    context.database.close()
