"""From every version that was released, with data in every table: all of it is kept, and the service runs on it."""

from pathlib import Path
from typing import Any

import pytest
import sqlalchemy as sa
from alembic import command
from pydantic import SecretStr
from starlette.testclient import TestClient

from api.app import create_app
from api.services import retention
from api.services.context import Context
from api.settings import Settings
from storage.database import Database
from storage.migrate import config, upgrade
from storage.models import metadata
from tests.conftest import Clock
from tests.drives import chunks
from tests.postgres import Server
from tests.service import ADMIN_KEY, Api, Device
from tests.storage.old_data import DEVICE_KEY, contents, fill

VERSIONS = ("0001", "0002")


@pytest.fixture(params=VERSIONS)
def version(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture
def old_url(version: str, backend: str, request: pytest.FixtureRequest, tmp_path: Path) -> str:
    """URL of a database of that version, with its data."""
    url = f"sqlite:///{tmp_path / 'livella.db'}"
    if backend == "postgresql":
        server: Server = request.getfixturevalue("postgres")
        url = server.empty_database()
    database = Database(url)
    with database.write() as tx:
        command.upgrade(config(tx.connection), version)
        fill(tx, version)
    database.close()
    return url


def test_every_table_has_data(old_url: str) -> None:
    database = Database(old_url)
    with database.write() as tx:
        assert all(contents(tx).values())
    database.close()


def test_nothing_is_lost_on_the_way_up_or_down(old_url: str, version: str) -> None:
    database = Database(old_url)
    with database.write() as tx:
        before = contents(tx)
    before["meta"] = [row for row in before["meta"] if row["name"] != "cookie_secret"]  # sign-ins are in a table now
    upgrade(database)
    with database.write() as tx:
        after = contents(tx)
        command.downgrade(config(tx.connection), version)
        assert contents(tx) == before
    for name, found in before.items():
        kept = [{column: row[column] for column in found[0]} for row in after[name]]
        assert kept == found, name
    assert {row["device_pk"] for row in after["estimates"]} == {7}
    assert {row["device_id"] for row in after["alerts"]} == {"old"}
    assert [row["device_id"] for row in after["installations"]] == ["old", "bare"]
    assert after["devices"][0]["search"] == "old\nold box\nhh-lv 1\näusserst alt"
    assert [row["name_key"] for row in after["devices"]] == ["old box", "bare"]
    database.close()


def test_numbers_go_on(old_url: str) -> None:
    """A copied table must not give a number out again."""
    database = Database(old_url)
    with database.write() as tx:
        tx.execute(sa.text("DELETE FROM estimates WHERE pk = 3"))
    upgrade(database)
    table = metadata.tables["estimates"]
    values = {"device_pk": 7, "session_pk": 1, "t_first": 0.0, "t_last": 1.0, "size": 1, "changes": 0, "rows": b""}
    if database.is_sqlite:
        with database.write() as tx:
            added = tx.execute(sa.insert(table).returning(table.c.pk), **values, received_at=Clock().now)
            assert added.scalar_one() > 2
            assert "AUTOINCREMENT" in tx.value(sa.text("SELECT sql FROM sqlite_master WHERE name = 'estimates'"))
    database.close()


def test_the_service_runs_on_it(old_url: str, clock: Clock, tmp_path: Path) -> None:
    settings = Settings(database_url=SecretStr(old_url), data_dir=tmp_path, admin_key=SecretStr(ADMIN_KEY))
    with TestClient(create_app(settings, clock), raise_server_exceptions=False) as client:
        api = Api(client)
        api.wait_until_ready()
        device = Device(api, "old", DEVICE_KEY)
        assert [found["id"] for found in api.get("/devices")["items"]] == ["bare", "old"]
        assert listed(api, q="ÄUSSERST") == listed(api, has_open_alert=True) == ["old"]
        assert listed(api, stage="waiting", has_open_alert=False) == ["bare"]
        assert [alert["id"] for alert in api.get("/alerts", params={"device_id": "old"})["items"]] == [4, 3]
        assert [mount["id"] for mount in device.get("mounts")["items"]] == [2, 1]
        assert len(device.get("estimates")["time"]) == 36
        assert device.installation()["data"] is device.installation()["verification"]["trace"] is None
        assert [mount["verification"]["trace"] for mount in device.get("mounts")["items"]] == [None, None]
        assert device.send(chunks()[0], 0, "second", expect=200).json()["chunk"]["duplicate"]
        device.send(chunks()[1], 1, "second", expect=200)
        assert device.send(chunks()[2], 2, "second", expect=200).json()["chunk"]["state"] == "applied"
        assert device.installation()["data"]["sample_rate_hz"] == 50.0
        assert device.get("health")["rates"]["sample_rate_hz"] == [None, None, 50.0]  # the last came in last
        assert len(device.get("estimates")["time"]) > 36
        assert device.get("motion", params={"to": "2024-05-06T08:00:00Z"})["mount"] == 2
        assert device.api.call("GET", "/devices/old/raw", 200).content.count(b"\n") == 3001  # two chunks at 50 Hz
        assert device.get("events")["items"] == []
        coarsen(settings, clock)
        assert 3 < len(device.get("estimates")["time"]) < 20
        api.call("DELETE", "/devices/old", 204)
    database = Database(old_url)
    with database.write() as tx:
        left = contents(tx)
    assert not any(
        left[name] for name in ("sessions", "chunks", "raw_chunks", "estimates", "estimates_coarse", "mounts", "alerts")
    )
    database.close()


def listed(api: Api, **filters: Any) -> list[str]:
    return [found["id"] for found in api.get("/devices", params=filters)["items"]]


def coarsen(settings: Settings, clock: Clock) -> None:
    clock.advance(16 * 86400)
    context = Context.make(settings, clock)
    while retention.coarsen(context):
        pass
    context.database.close()
