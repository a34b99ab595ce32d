"""What the log says, and what it never says."""

import json
import logging
import logging.config
from collections.abc import Iterator
from io import StringIO

import pytest
from starlette.testclient import TestClient

from api import logs
from api.settings import Settings
from tests.drives import chunks
from tests.service import ADMIN_KEY, Api


@pytest.fixture
def written() -> Iterator[StringIO]:
    """The log as JSON."""
    written, handler = StringIO(), logging.StreamHandler()
    handler.setStream(written)
    handler.setFormatter(logs.json_formatter())
    handler.addFilter(logs.WithRequest())
    root = logging.getLogger()
    level = root.level
    root.addHandler(handler)
    root.setLevel(logging.DEBUG)
    yield written
    root.setLevel(level)
    root.removeHandler(handler)


def lines(written: StringIO) -> list[dict[str, object]]:
    return [json.loads(line) for line in written.getvalue().splitlines()]


def of_requests(written: StringIO) -> list[dict[str, object]]:
    return [line for line in lines(written) if line["logger"] == logs.ACCESS]


def test_every_request_is_one_line(api: Api, written: StringIO) -> None:
    device = api.add_device("van-7")
    answer = device.send(chunks()[0], 0, expect=200, X_Request_ID="trip-1")
    line = of_requests(written)[-1]
    assert answer.headers["x-request-id"] == line["request_id"] == "trip-1"
    assert line["device_id"] == "van-7"
    assert line["method"] == "POST"
    assert line["route"] == "/api/v1/devices/{device_id}/chunks"
    assert line["status"] == 200
    assert float(str(line["duration_ms"])) > 0


@pytest.mark.parametrize("given", ["", "two words", "a" * 65, "x\tforged", "ü"])
def test_an_unsound_request_id_is_replaced(client: TestClient, given: str) -> None:
    made = client.get("/healthz", headers={b"X-Request-ID": given.encode()}).headers["x-request-id"]
    assert made != given
    assert len(made) == 32


def test_no_secret_is_in_the_log(api: Api, client: TestClient, written: StringIO) -> None:
    device = api.add_device("van-7")
    key = device.key
    device.send(chunks()[0], 0, expect=200)
    device.send(b"t,ax\nbody-secret", 1, expect=422)
    cookie = client.post("/api/v1/session", json={"key": key}).cookies.get("livella_session")
    assert cookie
    client.get(f"/api/v1/devices?q=query-secret&key={key}")
    client.get(f"/api/v1/devices/{key}/installation", headers={"Authorization": f"Bearer {key}"})
    client.get(f"/api/v1/devices/{key}/installation", headers={"Authorization": f"Bearer {ADMIN_KEY}"})
    client.get(f"/{key}")
    text = "\n".join(str(line) for line in lines(written) if str(line["logger"]).startswith(("api", "storage")))
    assert len(of_requests(written)) >= 8
    for secret in (key, ADMIN_KEY, cookie, "query-secret", "body-secret"):
        assert secret not in text


@pytest.mark.parametrize("log_format", ["text", "json"])
def test_nothing_from_outside_begins_a_line(log_format: str) -> None:
    made = logs.json_formatter() if log_format == "json" else logs.TextFormatter()
    error = ValueError("first\nERROR forged: in an error")
    record = logging.getLogger("api").makeRecord(
        "api", logging.ERROR, "f", 1, "said %s", ("a\r\nERROR forged\u2028b",), (ValueError, error, None)
    )
    record.request_id = "r-1"
    text = made.format(record)
    assert not any(line.startswith("ERROR forged") for line in text.splitlines())
    assert len(text.splitlines()) == 1 or log_format == "text"
    assert "r-1" in text


def test_the_settings_choose_format_and_level() -> None:
    config = logs.config(Settings(log_format="json", log_level="warning"))
    assert config["loggers"]["api"]["level"] == "WARNING"
    assert config["formatters"]["line"]["()"] is logs.json_formatter
    assert logs.config(Settings())["formatters"]["line"]["()"] is logs.TextFormatter
