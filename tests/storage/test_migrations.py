import subprocess
import sys
import threading
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest
import sqlalchemy as sa
from alembic import command
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from alembic.script import ScriptDirectory

from storage import chunks, devices, motion_events, mounts, raw_chunks
from storage.database import Database
from storage.migrate import config, upgrade
from storage.models import EPOCH, metadata
from storage.models import devices as device_table
from tests.postgres import Server

ROOT = Path(__file__).parents[2]
ON_SQLITE, ON_POSTGRESQL = (
    {"ix_devices_id_search", "ix_devices_name_key_id_search"},
    {"ix_devices_id", "ix_devices_name_key_id"},
)
AT = datetime(2024, 5, 6, 7, 8, 9, tzinfo=UTC)
CALIBRATION = sa.select(device_table.c.accelerometer_calibration)


@pytest.fixture
def empty_url(backend: str, request: pytest.FixtureRequest, tmp_path: Path) -> str:
    if backend == "sqlite":
        return f"sqlite:///{tmp_path / 'livella.db'}"
    server: Server = request.getfixturevalue("postgres")
    return server.empty_database()


def tables(database: Database) -> set[str]:
    with database.read() as tx:
        return set(sa.inspect(tx.connection).get_table_names())


def test_the_migrations_make_the_tables_of_the_models(empty_url: str) -> None:
    database = Database(empty_url)
    upgrade(database)
    assert tables(database) == {*metadata.tables, "alembic_version"}
    elsewhere = ON_POSTGRESQL if database.is_sqlite else ON_SQLITE
    opts = {"include_object": lambda _thing, name, *_rest: name not in elsewhere}
    with database.read() as tx:
        differences = compare_metadata(MigrationContext.configure(tx.connection, opts=opts), metadata)
    assert differences == []
    upgrade(database)
    database.close()


def test_the_migrations_can_be_undone(empty_url: str) -> None:
    database = Database(empty_url)
    upgrade(database)
    with database.write() as tx:
        command.downgrade(config(tx.connection), "base")
    assert tables(database) == {"alembic_version"}
    upgrade(database)
    assert tables(database) == {*metadata.tables, "alembic_version"}
    database.close()


def test_postgresql_packs_states_by_lz4(postgres: Server) -> None:
    database = Database(postgres.empty_database())
    upgrade(database)
    packed_by = sa.text("SELECT attcompression FROM pg_attribute WHERE attname = 'snapshot'")
    with database.write() as tx:
        assert tx.value(packed_by) in ("l", b"l")
        command.downgrade(config(tx.connection), "0006")
        assert tx.value(packed_by) in ("", b"", "\0", b"\0")
    database.close()


def test_there_is_one_newest_migration() -> None:
    assert len(ScriptDirectory.from_config(config()).get_heads()) == 1


def test_several_may_migrate_at_once(empty_url: str) -> None:
    databases = [Database(empty_url) for _ in range(6)]
    failures: list[Exception] = []

    def migrate(database: Database) -> None:
        try:
            upgrade(database)
        except Exception as error:
            failures.append(error)

    threads = [threading.Thread(target=migrate, args=(database,)) for database in databases]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert failures == []
    assert tables(databases[0]) == {*metadata.tables, "alembic_version"}
    for database in databases:
        database.close()


PREPARE = """
from api.services import startup
from api.services.context import Context
from api.settings import Settings
print(startup.prepare(Context.make(Settings())))
"""


def test_of_processes_that_start_at_once_one_shows_the_admin_key(empty_url: str, tmp_path: Path) -> None:
    environment = {"LIVELLA_DATABASE_URL": empty_url, "LIVELLA_DATA_DIR": str(tmp_path), "PATH": ""}
    starts = [
        subprocess.Popen([sys.executable, "-c", PREPARE], cwd=ROOT, env=environment, stdout=subprocess.PIPE, text=True)
        for _ in range(3)
    ]
    shown = [start.communicate(timeout=120)[0].strip() for start in starts]
    assert [start.returncode for start in starts] == [0, 0, 0]
    assert sorted(shown)[:2] == ["None", "None"]
    assert sorted(shown)[2].startswith("livella_")


def test_receipts_survive_the_fourth_migration_and_its_undoing(empty_url: str) -> None:
    database = Database(empty_url)
    with database.write() as tx:
        command.upgrade(config(tx.connection), "0003")
        tx.execute(sa.text("INSERT INTO devices (pk, id, name, created_at) VALUES (1, 'a', 'A', 0)"))
        tx.execute(sa.text("INSERT INTO sessions (pk, device_pk, name, next_seq, created_at) VALUES (1, 1, 's', 1, 0)"))
        tx.execute(
            sa.text(
                "INSERT INTO chunks (session_pk, seq, digest, state, samples, fixes, rejected, received_at)"
                " VALUES (1, 0, 'd', 'applied', 7, 3, '{}', 5)"
            )
        )
    upgrade(database)
    with database.write() as tx:
        receipt = chunks.find(tx, 1, 0)
        assert receipt is not None
        assert (receipt.samples, receipt.fixes, receipt.t_first, receipt.t_last) == (7, 3, None, None)
        chunks.add(tx, receipt._replace(seq=1, t_first=0.5, t_last=1.5))
        assert chunks.find(tx, 1, 1) == receipt._replace(seq=1, t_first=0.5, t_last=1.5)
        command.downgrade(config(tx.connection), "0003")
        assert tx.all(int, sa.text("SELECT samples FROM chunks ORDER BY seq")) == [7, 7]
        tx.connection.execute(sa.text("DELETE FROM devices"))
        assert tx.value(sa.text("SELECT count(*) FROM chunks")) == 0
    database.close()


OLD_MOUNT = (
    "INSERT INTO mounts (device_pk, n, session_pk, t, quaternion, sigma_deg, verification, status)"
    " VALUES (1, 1, 1, 60.0, '[1, 0, 0, 0]', '[1, 1, 1]', '{}', 'in_force')"
)


def test_mountings_survive_the_sixth_migration_and_its_undoing(empty_url: str) -> None:
    database = Database(empty_url)
    with database.write() as tx:
        command.upgrade(config(tx.connection), "0005")
        tx.execute(sa.text("INSERT INTO devices (pk, id, name, created_at) VALUES (1, 'a', 'A', 0)"))
        tx.execute(
            sa.text(
                "INSERT INTO sessions (pk, device_pk, name, next_seq, started_at, created_at)"
                " VALUES (1, 1, 's', 1, 1000000, 0)"
            )
        )
        tx.execute(sa.text(OLD_MOUNT))
    upgrade(database)
    with database.write() as tx:
        mount = mounts.before(tx, 1, AT)
        assert mount is not None
        assert (mount.n, mount.status, mount.ended_at) == (1, "in_force", None)
        assert mounts.before(tx, 1, EPOCH) is None
        mounts.suspect(tx, 1, AT)
        mounts.supersede(tx, 1, AT + timedelta(hours=1))
        assert mounts.before(tx, 1, AT) == mount._replace(status="superseded", ended_at=AT)
        chunk = raw_chunks.RawChunk(1, 0, 1, 0.0, 10.0, AT, "t ax", b"content")
        raw_chunks.add(tx, chunk)
        motion_events.add(tx, 1, (1, 0), "impact", 3.0, AT, {})
        assert raw_chunks.content(tx, 1, 0) == b"content"
        command.downgrade(config(tx.connection), "0005")
        assert tx.value(sa.text("SELECT status FROM mounts")) == "superseded"
    upgrade(database)
    with database.write() as tx:
        raw_chunks.add(tx, chunk)
        motion_events.add(tx, 1, (1, 0), "impact", 3.0, AT, {})
        devices.remove(tx, 1)
        assert raw_chunks.content(tx, 1, 0) is None
        assert tx.value(sa.text("SELECT count(*) FROM motion_events")) == 0
    database.close()


def test_devices_and_what_hangs_on_them_survive_the_second_migration_and_its_undoing(empty_url: str) -> None:
    database = Database(empty_url)
    with database.write() as tx:
        command.upgrade(config(tx.connection), "0001")
        tx.execute(sa.text("INSERT INTO devices (pk, id, name, created_at) VALUES (1, 'a', 'A', 0)"))
        tx.execute(sa.text("INSERT INTO sessions (pk, device_pk, name, next_seq, created_at) VALUES (1, 1, 's', 3, 0)"))
    upgrade(database)
    with database.write() as tx:
        assert tx.value(CALIBRATION) is None
        devices.edit(tx, 1, {"accelerometer_calibration": {"gain": [[1.1]], "offset": [0.1]}})
        assert tx.value(CALIBRATION) == {"gain": [[1.1]], "offset": [0.1]}
        command.downgrade(config(tx.connection), "0001")
    with database.read() as tx:
        assert tx.value(sa.text("SELECT name FROM devices")) == "A"
        assert tx.value(sa.text("SELECT next_seq FROM sessions")) == 3
    database.close()
