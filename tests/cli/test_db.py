import os
import sqlite3
import stat
from contextlib import closing
from pathlib import Path

import pytest
from pydantic import SecretStr
from starlette.testclient import TestClient
from typer.testing import CliRunner, Result

from api.app import create_app
from api.cli import app
from api.settings import Settings
from tests.service import ADMIN_KEY, Api


@pytest.fixture(autouse=True)
def kept_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    """Give the environment back as it was: flags go into it."""
    monkeypatch.setattr(os, "environ", os.environ.copy())


def db(*arguments: object) -> Result:
    return CliRunner().invoke(app, ["db", *map(str, arguments)])


def add_device(url: str, name: str) -> None:
    settings = Settings(database_url=SecretStr(url), admin_key=SecretStr(ADMIN_KEY))
    with TestClient(create_app(settings)) as client:
        Api(client).add_device(name)


def devices(url: str) -> list[str]:
    settings = Settings(database_url=SecretStr(url), admin_key=SecretStr(ADMIN_KEY))
    with TestClient(create_app(settings)) as client:
        return [device["id"] for device in Api(client).get("/devices")["items"]]


def test_backup_and_restore(database_url: str, tmp_path: Path) -> None:
    flags = ["--database-url", database_url]
    copy = tmp_path / "copy"
    add_device(database_url, "before")
    assert db("backup", copy, *flags).exit_code == 0
    assert stat.S_IMODE(copy.stat().st_mode) == 0o600
    assert sorted(path.name for path in tmp_path.glob("copy*")) == ["copy"]
    add_device(database_url, "after")

    refused = db("restore", copy, *flags)
    assert refused.exit_code == 2
    assert "--replace" in refused.stderr
    assert devices(database_url) == ["after", "before"]

    assert db("restore", copy, "--replace", *flags).exit_code == 0
    assert devices(database_url) == ["before"]


def test_a_backup_while_the_service_writes(tmp_path: Path) -> None:
    url, copy = f"sqlite:///{tmp_path / 'live.db'}", tmp_path / "copy.db"
    settings = Settings(database_url=SecretStr(url), admin_key=SecretStr(ADMIN_KEY))
    with TestClient(create_app(settings)) as client:
        api = Api(client)
        api.add_device("first")
        assert db("backup", copy, "--database-url", url).exit_code == 0
        api.add_device("second")
    assert devices(f"sqlite:///{copy}") == ["first"]


def test_restore_into_a_new_place(tmp_path: Path) -> None:
    old, new, copy = (f"sqlite:///{tmp_path / 'old.db'}", f"sqlite:///{tmp_path / 'new.db'}", tmp_path / "copy")
    add_device(old, "box")
    assert db("backup", copy, "--database-url", old).exit_code == 0
    assert db("restore", copy, "--database-url", new).exit_code == 0
    assert devices(new) == ["box"]


@pytest.mark.parametrize("body", [b"", b"nothing of ours", b"SQLite format 3\0" + bytes(4096)])
def test_a_file_that_is_no_backup_changes_nothing(tmp_path: Path, body: bytes) -> None:
    url, copy = f"sqlite:///{tmp_path / 'live.db'}", tmp_path / "copy"
    add_device(url, "box")
    copy.write_bytes(body)
    done = db("restore", copy, "--replace", "--database-url", url)
    assert done.exit_code == 2
    assert str(copy) in done.stderr
    assert devices(url) == ["box"]


def test_what_cannot_be_done(tmp_path: Path) -> None:
    empty = ["--data-dir", tmp_path / "empty"]
    assert "nothing to check" in db("check", *empty).stderr
    assert "nothing to back up" in db("backup", tmp_path / "copy", *empty).stderr
    assert "no such file" in db("restore", tmp_path / "missing", *empty).stderr
    (tmp_path / "there").touch()
    assert "is there already" in db("backup", tmp_path / "there", *empty).stderr
    assert not (tmp_path / "copy").exists()


def test_migrate_twice(tmp_path: Path) -> None:
    for _ in range(2):
        assert db("migrate", "--data-dir", tmp_path).exit_code == 0
    assert (tmp_path / "livella.db").exists()


def test_a_sound_database_is_called_sound(database_url: str) -> None:
    add_device(database_url, "box")
    done = db("check", "--database-url", database_url)
    assert (done.exit_code, done.stdout.strip()) == (0, "The database is sound.")


def test_damage_is_told(tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path / 'livella.db'}"
    add_device(url, "box")
    with closing(sqlite3.connect(tmp_path / "livella.db")) as connection, connection:
        connection.execute("INSERT INTO sessions (device_pk, name, next_seq, created_at) VALUES (77, 's', 0, 0)")
        connection.execute("UPDATE alembic_version SET version_num = '0002'")
    done = db("check", "--database-url", url)
    assert done.exit_code == 1
    assert "sessions: row 1 belongs to nothing" in done.stderr
    assert "livella db migrate" in done.stderr


def test_a_damaged_file_is_told(tmp_path: Path) -> None:
    file = tmp_path / "livella.db"
    add_device(f"sqlite:///{file}", "box")
    with closing(sqlite3.connect(file)) as connection:
        connection.execute("PRAGMA wal_checkpoint(TRUNCATE)")
        page = connection.execute("SELECT rootpage FROM sqlite_master WHERE name = 'devices'").fetchone()[0]
        size = connection.execute("PRAGMA page_size").fetchone()[0]
    with file.open("r+b") as raw:
        raw.seek((page - 1) * size + size // 2)
        raw.write(b"\xff" * (size // 2))
    assert db("check", "--database-url", f"sqlite:///{file}").exit_code == 1
