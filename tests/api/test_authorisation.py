"""Every endpoint of the API's description by everybody who may call it."""

from collections.abc import Iterator
from datetime import timedelta
from itertools import count
from pathlib import Path
from typing import NamedTuple

import pytest
from pydantic import SecretStr
from starlette.testclient import TestClient

from api.app import create_app
from api.services import access
from api.settings import Settings
from storage import keys
from storage.database import Database
from tests.conftest import Clock
from tests.service import ADMIN_KEY, NO_LIMITS, Api, Device, Response

CALLERS = ("nobody", "wrong key", "expired key", "own device", "other device", "installer", "manager", "admin")

PUBLIC = ("ok", "ok", "ok", "ok", "ok", "ok", "ok", "ok")
ANY = (401, 401, 401, "ok", "ok", "ok", "ok", "ok")
OWN = (401, 401, 401, "ok", 403, "ok", "ok", "ok")
INSTALLER = (401, 401, 401, 403, 403, "ok", "ok", "ok")
MANAGER = (401, 401, 401, 403, 403, 403, "ok", "ok")
ADMIN = (401, 401, 401, 403, 403, 403, 403, "ok")

TABLE = {
    "GET /healthz": PUBLIC,
    "GET /readyz": PUBLIC,
    "POST /api/v1/session": PUBLIC,
    "GET /api/v1/session": ANY,
    "DELETE /api/v1/session": PUBLIC,
    "POST /api/v1/devices": INSTALLER,
    "GET /api/v1/devices": INSTALLER,
    "GET /api/v1/devices/{device_id}": INSTALLER,
    "PATCH /api/v1/devices/{device_id}": INSTALLER,
    "DELETE /api/v1/devices/{device_id}": INSTALLER,
    "POST /api/v1/devices/{device_id}/key": INSTALLER,
    "POST /api/v1/devices/{device_id}/chunks": OWN,
    "GET /api/v1/devices/{device_id}/installation": OWN,
    "POST /api/v1/devices/{device_id}/installation/restart": INSTALLER,
    "POST /api/v1/devices/{device_id}/installation/level": INSTALLER,
    "GET /api/v1/devices/{device_id}/estimates": OWN,
    "GET /api/v1/devices/{device_id}/health": OWN,
    "GET /api/v1/devices/{device_id}/mounts": OWN,
    "GET /api/v1/devices/{device_id}/mounts/{n}": OWN,
    "GET /api/v1/devices/{device_id}/mount": OWN,
    "GET /api/v1/devices/{device_id}/events": OWN,
    "GET /api/v1/devices/{device_id}/events/{event_id}": OWN,
    "GET /api/v1/devices/{device_id}/motion": OWN,
    "GET /api/v1/devices/{device_id}/raw": OWN,
    "GET /api/v1/alerts": MANAGER,
    "GET /api/v1/alerts/{alert_id}": MANAGER,
    "POST /api/v1/alerts/{alert_id}/acknowledge": MANAGER,
    "POST /api/v1/alerts/{alert_id}/resolve": MANAGER,
    "GET /api/v1/webhooks": MANAGER,
    "POST /api/v1/webhooks": MANAGER,
    "GET /api/v1/webhooks/{webhook_id}": MANAGER,
    "PATCH /api/v1/webhooks/{webhook_id}": MANAGER,
    "DELETE /api/v1/webhooks/{webhook_id}": MANAGER,
    "POST /api/v1/webhooks/{webhook_id}/secret": MANAGER,
    "GET /api/v1/webhooks/{webhook_id}/deliveries": MANAGER,
    "POST /api/v1/webhooks/{webhook_id}/redeliver": MANAGER,
    "POST /api/v1/webhooks/{webhook_id}/test": MANAGER,
    "GET /api/v1/fleet/summary": ANY,
    "GET /api/v1/thresholds": MANAGER,
    "GET /api/v1/stream": ANY,
    "GET /api/v1/keys": ADMIN,
    "POST /api/v1/keys": ADMIN,
    "DELETE /api/v1/keys/{key_id}": ADMIN,
    "GET /api/v1/audit": ADMIN,
}
OF_A_DEVICE = [endpoint for endpoint in TABLE if "{device_id}" in endpoint]
NO_NUMBER = "999999"
"""of an alert, a key, a webhook, a mounting"""
BODY = {"requestBody": "of no endpoint"}
ODD_IDS = ("nobody", "%2e%2e", "a%00b", "a%20b", "x" * 65)


class Service(NamedTuple):
    admin: Api
    keys: dict[str, str | None]
    numbers: Iterator[int]

    def devices(self) -> tuple[Device, Device]:
        """Two devices that no other test has touched."""
        number = next(self.numbers)
        return self.admin.add_device(f"mine-{number}"), self.admin.add_device(f"other-{number}")

    def call(self, key: str | None, endpoint: str, device_id: str) -> Response:
        method, template = endpoint.split(" ")
        path = template.replace("{device_id}", device_id)
        for name in ("{n}", "{alert_id}", "{event_id}", "{key_id}", "{webhook_id}"):
            path = path.replace(name, NO_NUMBER)
        return self.admin.as_(key).call(method, path, json=None if method == "GET" else BODY)


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    directory: Path = tmp_path_factory.mktemp("service")
    url = f"sqlite:///{directory / 'livella.db'}"
    settings = Settings(database_url=SecretStr(url), data_dir=directory, admin_key=SecretStr(ADMIN_KEY), **NO_LIMITS)
    clock = Clock()
    with TestClient(create_app(settings, clock), raise_server_exceptions=False) as client:
        api = Api(client)
        api.wait_until_ready()
        client.app_state["hub"].close()  # a stream ends as soon as it has begun
        yield Service(api, _keys(url, clock), count())


def _keys(url: str, clock: Clock) -> dict[str, str | None]:
    made: dict[str, str | None] = {"nobody": None, "wrong key": access.new_key(), "admin": ADMIN_KEY}
    database = Database(url)
    with database.write() as tx:
        for caller, role in (("installer", "installer"), ("manager", "manager"), ("expired key", "admin")):
            made[caller] = key = access.new_key()
            ends = clock() - timedelta(seconds=1) if caller == "expired key" else None
            keys.add(tx, access.digest(key), role, caller, clock(), expires_at=ends)
    database.close()
    return made


def test_the_table_names_every_endpoint(service: Service) -> None:
    document = service.admin.client.request("GET", "/openapi.json").json()
    described = {f"{method.upper()} {path}" for path, operations in document["paths"].items() for method in operations}
    assert described == set(TABLE)


@pytest.mark.parametrize("endpoint", TABLE)
def test_everybody_gets_what_the_table_says(service: Service, endpoint: str) -> None:
    own, other = service.devices()
    known = service.keys | {"own device": own.key, "other device": other.key}
    answers = {caller: service.call(known[caller], endpoint, own.id) for caller in CALLERS}
    seen = tuple(a.status_code if a.status_code in {401, 403} else "ok" for a in answers.values())
    assert dict(zip(CALLERS, seen, strict=True)) == dict(zip(CALLERS, TABLE[endpoint], strict=True))
    assert all(a.status_code < 500 for a in answers.values())
    for answer in answers.values():
        if answer.status_code == 401:
            assert answer.headers["www-authenticate"].startswith("Bearer")
            assert answer.headers["content-type"] == "application/problem+json"
    assert len({answers[caller].content for caller in ("wrong key", "expired key")}) == 1 or TABLE[endpoint] == PUBLIC


@pytest.mark.parametrize("endpoint", OF_A_DEVICE)
def test_a_refusal_does_not_tell_which_devices_exist(service: Service, endpoint: str) -> None:
    own, other = service.devices()
    for key in (None, "wrong", service.keys["expired key"], other.key):
        told = {_told(service.call(key, endpoint, device_id)) for device_id in (own.id, *ODD_IDS)}
        assert len(told) == 1, (key, told)
        assert told.pop()[0] == (403 if key == other.key else 401)


def _told(answer: Response) -> tuple[int, bytes, tuple[tuple[str, str], ...]]:
    headers = {name: value for name, value in answer.headers.items() if not name.startswith(("ratelimit", "x-request"))}
    return answer.status_code, answer.content, tuple(sorted(headers.items()))
