import os
from collections.abc import Iterator
from datetime import datetime, timedelta
from pathlib import Path

import pytest
from starlette.testclient import TestClient
from typer.testing import CliRunner, Result

from api.app import create_app
from api.cli import app
from api.settings import Settings
from tests.service import Api


@pytest.fixture(autouse=True)
def data_dir(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(os, "environ", {**os.environ, "LIVELLA_DATA_DIR": str(tmp_path)})


@pytest.fixture
def admin() -> Iterator[Api]:
    """The service, as an administrator whose key came from the command line."""
    key = keys("create", "--role", "admin", "--name", "Ada [/bold]").stdout.strip()
    with TestClient(create_app(Settings())) as client:
        yield Api(client, key)


def keys(*arguments: object) -> Result:
    return CliRunner().invoke(app, ["keys", *map(str, arguments)])


def test_a_key_made_here_opens_the_service_until_it_is_revoked(admin: Api) -> None:
    assert admin.get("/devices")["items"] == []
    assert "Ada [/bold]" in keys("list").stdout
    assert admin.key
    assert admin.key not in keys("list").stdout
    assert keys("revoke", 1).exit_code == 0
    admin.call("GET", "/devices", 401)
    assert "Ada" not in keys("list").stdout


@pytest.mark.parametrize("role", ["installer", "manager"])
def test_roles(admin: Api, role: str) -> None:
    other = admin.as_(keys("create", "--role", role, "--name", "x").stdout.strip())
    other.get("/devices")
    other.call("GET", "/alerts", 200 if role == "manager" else 403)


def test_another_key_for_a_device(admin: Api) -> None:
    admin.add_device("box-1")
    made = keys("create", "--role", "device", "--device", "box-1")
    box = admin.as_(made.stdout.strip())
    box.get("/devices/box-1/installation")
    box.call("GET", "/devices", 403)
    assert keys("list").stdout.count("box-1") >= 3


@pytest.mark.parametrize(
    "arguments",
    [
        ["create", "--role", "device", "--name", "x"],
        ["create", "--role", "device", "--device", "nobody"],
        ["create", "--role", "admin", "--device", "box-1"],
        ["create", "--role", "admin"],
        ["create", "--role", "admin", "--name", "x" * 129],
        ["create", "--role", "king", "--name", "x"],
        ["revoke", 77],
    ],
)
def test_what_cannot_be_done(arguments: list[object]) -> None:
    done = keys(*arguments)
    assert done.exit_code == 2
    assert "livella_" not in done.output


def test_a_key_that_ends(admin: Api) -> None:
    made = keys("create", "--role", "installer", "--name", "Ida", "--expires-days", 30).stdout.strip()
    admin.as_(made).get("/devices")
    listed = keys("list").stdout
    assert made[:12] in listed
    assert made[:13] not in listed
    (entry,) = [key for key in admin.get("/keys")["items"] if key["name"] == "Ida"]
    assert entry["created_by"] == "command line"
    made_at, expires_at = (datetime.fromisoformat(entry[name]) for name in ("created_at", "expires_at"))
    assert abs(expires_at - made_at - timedelta(days=30)) < timedelta(seconds=1)
    assert f"{expires_at:%Y-%m-%d %H:%M}Z" in listed


def test_the_list_tells_the_last_use_and_steers_no_terminal(admin: Api) -> None:
    keys("create", "--role", "manager", "--name", "\x1b[31mred")
    line = next(line for line in keys("list").stdout.splitlines() if "manager" in line)
    assert "\x1b" not in line
    assert r"\x1b[31mred" in line


def test_what_is_done_here_is_in_the_audit_trail(admin: Api) -> None:
    keys("create", "--role", "manager", "--name", "Max")
    keys("revoke", 2)
    done = [
        (e["action"], e["target"], e["role"]) for e in admin.get("/audit", params={"actor": "command line"})["items"]
    ]
    assert done == [
        ("key.revoke", "keys/2", "none"),
        ("key.create", "keys/2", "none"),
        ("key.create", "keys/1", "none"),
    ]
