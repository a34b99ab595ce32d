import logging
import threading

import pytest
import sqlalchemy as sa
from pydantic import SecretStr
from starlette.testclient import TestClient

from api.app import create_app
from api.services import access, startup
from api.services.context import Context
from api.settings import Settings
from storage.database import Database
from storage.models import api_keys, meta, sign_ins
from tests.conftest import Clock
from tests.drives import chunks
from tests.service import ADMIN_KEY, Api


def test_a_device_cannot_tell_which_other_devices_exist(api: Api) -> None:
    device = api.add_device("mine")
    api.add_device("other")
    device.send_all(chunks()[:1])
    for path in ("installation", "mount", "estimates", "mounts", "mounts/1"):
        there, missing = (device.api.call("GET", f"/devices/{name}/{path}") for name in ("other", "missing"))
        assert there.status_code == missing.status_code == 403
        assert there.content == missing.content
    assert {
        device.api.call("POST", f"/devices/{name}/chunks", params={"session": "a", "seq": 0}).content
        for name in ("other", "missing")
    } == {there.content}
    assert device.api.get("/fleet/summary")["devices"] == 1


def test_a_key_is_stored_only_as_a_hash(api: Api, database: Database) -> None:
    device = api.add_device()
    with database.read() as tx:
        rows = [str(tuple(row)) for table in (api_keys, meta) for row in tx.connection.execute(sa.select(table))]
        assert tx.value(sa.select(sa.func.count()).select_from(api_keys)) == 2
    for part in (device.key[13:], ADMIN_KEY[1:]):  # 12 characters are kept to tell keys apart, none of a chosen one
        assert not any(part[:8] in row for row in rows)
    assert device.key.startswith("livella_")
    assert len(device.key) == len("livella_") + 43


def test_keys_do_not_reach_the_log(api: Api, caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.DEBUG):
        device = api.add_device()
        device.send(chunks()[0], 0)
        api.as_("some-wrong-key").call("GET", "/devices", 401)
        api.post("/session", {"key": device.key})
    assert not any(key in caplog.text for key in (ADMIN_KEY, device.key, "some-wrong-key"))


def test_a_removed_devices_key_is_dead(api: Api) -> None:
    device = api.add_device()
    api.call("DELETE", f"/devices/{device.id}", 204)
    device.api.call("GET", f"/devices/{device.id}/installation", 401)


# ---------------------------------------------------------------- first start


def test_the_first_start_makes_one_admin_key(settings: Settings, clock: Clock) -> None:
    context = Context.make(settings.model_copy(update={"admin_key": None}), clock)
    made: list[str | None] = []
    starts = [threading.Thread(target=lambda: made.append(startup.prepare(context))) for _ in range(4)]
    for start in starts:
        start.start()
    for start in starts:
        start.join()
    (key,) = [key for key in made if key is not None]
    assert len(made) == 4
    assert access.authenticate(context, key).role == access.Role.ADMIN
    assert startup.prepare(context) is None
    context.database.close()


def test_a_start_without_the_command_line_shows_the_key(
    settings: Settings, clock: Clock, capsys: pytest.CaptureFixture[str]
) -> None:
    unset = settings.model_copy(update={"admin_key": None})
    with TestClient(create_app(unset, clock)) as client:
        key = capsys.readouterr().err.strip().rsplit(" ", 1)[-1]
        Api(client, key).get("/devices")
    with TestClient(create_app(unset, clock)):
        assert capsys.readouterr().err == ""


def test_a_chosen_admin_key_replaces_the_one_chosen_before(settings: Settings, clock: Clock) -> None:
    for chosen, other in (("first-choice-" * 3, None), ("second-choice-" * 3, "first-choice-" * 3)):
        changed = settings.model_copy(update={"admin_key": SecretStr(chosen)})
        with TestClient(create_app(changed, clock)) as client:
            Api(client, chosen).get("/devices")
            if other:
                Api(client, other).call("GET", "/devices", 401)


# ---------------------------------------------------------------- the page's sign-in


def sign_in(client: TestClient, key: str = ADMIN_KEY) -> str:
    response = client.post("/api/v1/session", json={"key": key})
    assert response.status_code == 200, response.text
    return str(response.headers["set-cookie"])


def test_a_sign_in_is_a_cookie_no_script_and_no_other_site_can_use(api: Api, client: TestClient) -> None:
    cookie = sign_in(client)
    assert "HttpOnly" in cookie
    assert "samesite=strict" in cookie.lower()
    assert "Path=/api" in cookie
    assert "Secure" not in cookie
    assert ADMIN_KEY not in cookie
    assert client.get("/api/v1/session").json() == {"role": "admin", "name": "admin", "device_id": None}
    assert client.get("/api/v1/devices").status_code == 200
    secure = client.post("https://testserver/api/v1/session", json={"key": ADMIN_KEY})
    assert "Secure" in secure.headers["set-cookie"]


def test_signing_in_needs_a_valid_key(api: Api, client: TestClient) -> None:
    assert client.post("/api/v1/session", json={"key": "wrong"}).status_code == 401
    assert client.post("/api/v1/session", json={}).status_code == 422
    assert "set-cookie" not in client.post("/api/v1/session", json={"key": "wrong"}).headers


ORIGINS = [
    ({}, 403),
    ({"Origin": "http://testserver"}, 201),
    ({"Origin": "http://evil.example"}, 403),
    ({"Origin": "null"}, 403),
    ({"Origin": "http://testserver.evil.example"}, 403),
    ({"Sec-Fetch-Site": "same-origin"}, 201),
    ({"Sec-Fetch-Site": "same-site"}, 403),
    ({"Sec-Fetch-Site": "cross-site", "Origin": "http://testserver"}, 403),
    ({"Sec-Fetch-Site": "none"}, 403),
]


@pytest.mark.parametrize(("headers", "status"), ORIGINS)
def test_a_change_by_cookie_must_come_from_the_page(
    api: Api, client: TestClient, headers: dict[str, str], status: int
) -> None:
    sign_in(client)
    made = client.post("/api/v1/devices", json={"name": "x"}, headers=headers)
    assert made.status_code == status
    assert len(api.get("/devices")["items"]) == (status == 201)


@pytest.mark.parametrize("headers", [{"Origin": "http://evil.example"}, {"Sec-Fetch-Site": "cross-site"}])
def test_another_site_cannot_sign_somebody_in(api: Api, client: TestClient, headers: dict[str, str]) -> None:
    assert client.post("/api/v1/session", json={"key": ADMIN_KEY}, headers=headers).status_code == 403


def test_a_key_in_the_header_needs_no_origin(api: Api, client: TestClient) -> None:
    sign_in(client)
    api.add_device()


def test_signing_out_ends_the_sign_in_and_no_other(api: Api, client: TestClient, database: Database) -> None:
    sign_in(client)
    stolen = client.cookies["livella_session"]
    client.cookies.clear()
    sign_in(client)
    kept = client.cookies["livella_session"]
    client.cookies.set("livella_session", stolen)
    assert client.delete("/api/v1/session").status_code == 204
    assert [signed_in(client, cookie) for cookie in (stolen, kept)] == [401, 200]
    client.cookies.clear()
    assert client.delete("/api/v1/session").status_code == 204
    with database.read() as tx:
        stored = list(tx.connection.execute(sa.select(sign_ins.c.digest)).scalars())
    assert stored == [access.digest(kept)]


def signed_in(client: TestClient, cookie: str) -> int:
    client.cookies.clear()
    client.cookies.set("livella_session", cookie)
    return client.get("/api/v1/session").status_code


def test_revoking_a_key_ends_its_sign_in(api: Api, client: TestClient) -> None:
    device = api.add_device()
    sign_in(client, device.key)
    assert client.get("/api/v1/session").json()["device_id"] == device.id
    assert client.get("/api/v1/devices").status_code == 403
    api.call("DELETE", f"/devices/{device.id}", 204)
    assert client.get("/api/v1/session").status_code == 401


@pytest.mark.parametrize("cookie", ["x", "MQ.aaaa.bbbb", "1"])
def test_a_forged_cookie_is_refused(api: Api, client: TestClient, cookie: str) -> None:
    client.cookies.set("livella_session", cookie)
    assert client.get("/api/v1/session").status_code == 401


def test_a_sign_in_ends(settings: Settings, clock: Clock, client: TestClient) -> None:
    sign_in(client)
    clock.advance(settings.session_hours * 3600 - 1)
    assert client.get("/api/v1/session").status_code == 200
    clock.advance(1)
    assert client.get("/api/v1/session").status_code == 401
