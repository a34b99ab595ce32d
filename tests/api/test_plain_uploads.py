"""The way of a plain upload and the one of the declared route answer the same."""

from typing import Any

import pytest

from api.routes.plain_uploads import find
from api.services import access
from api.settings import Settings
from tests.drives import chunks
from tests.service import Api, Device, Response

PLAIN: dict[str, Any] = {
    "type": "http",
    "method": "POST",
    "path": "/api/v1/devices/box-1/chunks",
    "query_string": b"session=a&seq=0",
    "headers": [(b"host", b"x"), (b"authorization", b"Bearer key"), (b"content-type", b"text/csv")],
}
UNUSUAL: list[dict[str, Any]] = [
    {"method": "GET"},
    {"path": "/api/v1/devices/box%1/chunks"},
    {"path": "/api/v1/devices/box-1/chunks/"},
    {"path": "/base/api/v1/devices/box-1/chunks"},
    *({"query_string": query} for query in (b"", b"seq=0&session=a", b"session=a", b"session=%41&seq=0")),
    *({"query_string": b"session=a&seq=" + seq} for seq in (b"", b"-1", b"01", b"1.0", b"2147483647", b"0&seq=1")),
    {"query_string": b"session=a&seq=0&course=left"},
    {"headers": [(b"host", b"x")]},
    {"headers": [(b"authorization", b"Basic key")]},
    {"headers": [(b"authorization", b"Bearer a"), (b"authorization", b"Bearer b")]},
]


def test_plain_is_what_devices_send() -> None:
    assert find(PLAIN) == ("box-1", "key", "a", 0, "auto", "text/csv", None)
    assert find(PLAIN | {"query_string": b"session=a-1&seq=120&course=clockwise"}) is not None
    assert find(PLAIN | {"headers": [*PLAIN["headers"], (b"content-encoding", b"zstd")]}) is not None


@pytest.mark.parametrize("unusual", UNUSUAL)
def test_anything_unusual_goes_the_declared_way(unusual: dict[str, Any]) -> None:
    assert find(PLAIN | unusual) is None


@pytest.fixture
def devices(api: Api) -> tuple[Device, Device]:
    return api.add_device("plain"), api.add_device("declared")


def both(devices: tuple[Device, Device], body: bytes, seq: object = 0, key: str | None = None) -> tuple[Response, ...]:
    """Send the same to a device of its own, each way."""
    answers = []
    for device, query in zip(devices, (f"session=a&seq={seq}", f"seq={seq}&session=a"), strict=True):
        url = f"/devices/{device.id}/chunks?{query}"
        answers.append(device.api.as_(key or device.key).call("POST", url, content=body, headers=CSV))
    return tuple(answers)


CSV = {"Content-Type": "text/csv"}
OWN = ("x-request-id", "ratelimit", "content-length")
"""headers that differ from request to request"""


def assert_same(devices: tuple[Device, Device], answers: tuple[Response, ...], status: int) -> None:
    plain, declared = answers
    assert plain.status_code == declared.status_code == status
    assert _told(plain) == _told(declared)
    headers = [{name: value for name, value in a.headers.items() if name not in OWN} for a in answers]
    assert headers[0] == headers[1]
    assert set(plain.headers) == set(declared.headers)


def _told(answer: Response) -> Any:
    told = answer.json()
    for name in ("device_id", "since", "revision"):
        told.get("installation", {}).pop(name, None)
    return told


def test_what_is_taken_in(devices: tuple[Device, Device]) -> None:
    first, second, third = chunks()[:3]
    assert_same(devices, both(devices, first, 0), 200)
    assert_same(devices, both(devices, first, 0), 200)  # a duplicate
    assert_same(devices, both(devices, second, 0), 409)
    assert_same(devices, both(devices, third, 2), 202)


def test_what_is_refused(devices: tuple[Device, Device], api: Api, settings: Settings) -> None:
    assert_same(devices, both(devices, b"t,ax\n1"), 422)
    assert_same(devices, both(devices, bytes(settings.max_chunk_bytes + 1)), 413)
    assert_same(devices, both(devices, chunks()[0], key=access.new_key()), 401)
    assert_same(devices, both(devices, chunks()[0], key=api.add_device("other").key), 403)
    assert_same(devices, both(devices, chunks()[0], "x"), 422)


def test_a_revoked_key_is_refused_at_once(devices: tuple[Device, Device], api: Api) -> None:
    assert_same(devices, both(devices, chunks()[0]), 200)
    for device in devices:
        api.post(f"/devices/{device.id}/key")
    assert_same(devices, both(devices, chunks()[1], 1), 401)
