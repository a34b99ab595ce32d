import threading
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, suppress
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest
import sqlalchemy as sa
from sqlalchemy.exc import DBAPIError, IntegrityError

from storage import devices, events, installations, keys, meta
from storage.database import Database, ReadSession
from storage.events import Position
from storage.installations import Installation
from storage.migrate import upgrade
from storage.models import api_keys, metadata
from storage.models import devices as device_table

MEMORY = 2
"""of SQLite's PRAGMA temp_store"""
NOW = datetime(2024, 5, 6, 7, 8, 9, 123456, tzinfo=UTC)


@pytest.fixture
def tables(database: Database) -> Database:
    upgrade(database)
    return database


def add_device(database: Database, device_id: str = "a") -> int:
    with database.write() as tx:
        pk = devices.add(tx, device_id, {"name": "A"}, NOW)
        installations.add(
            tx,
            Installation(pk, None, None, "waiting", None, None, NOW, {"progress": 0.0}, last_data_at=None, revision=0),
        )
        return pk


def test_a_failed_transaction_leaves_nothing(tables: Database) -> None:
    def fail() -> None:
        with tables.write() as tx:
            devices.add(tx, "a", {"name": "A"}, NOW)
            raise RuntimeError

    with pytest.raises(RuntimeError):
        fail()
    with tables.read() as tx:
        assert devices.exists(tx, "a") is None


def test_a_read_session_cannot_write(tables: Database) -> None:
    with pytest.raises(DBAPIError), tables.read() as tx:
        tx.connection.execute(sa.insert(device_table).values(id="a", name="A", created_at=NOW))
    add_device(tables)


def test_a_read_session_sees_one_moment(tables: Database) -> None:
    with tables.read() as tx:
        assert devices.exists(tx, "a") is None
        add_device(tables)
        assert devices.exists(tx, "a") is None
    with tables.read() as tx:
        assert devices.exists(tx, "a") is not None


def test_a_look_takes_no_transaction(tables: Database) -> None:
    with tables.look() as tx:
        assert installations.find(tx, "a") is None
        add_device(tables)
        assert installations.find(tx, "a") is not None


def test_a_look_leaves_nothing_to_the_next_one(tables: Database) -> None:
    for number in range(3):
        with tables.look() as tx:
            assert tx.value(sa.select(sa.func.count()).select_from(device_table)) == number
        add_device(tables, f"box-{number}")
        with suppress(KeyError), tables.look() as tx:
            assert tx.value(sa.select(sa.func.count()).select_from(device_table)) == number + 1
            raise KeyError


def test_many_looks_at_once_leave_connections_for_as_many_reads(tmp_path: Path) -> None:
    database = Database(f"sqlite:///{tmp_path / 'x.db'}")
    upgrade(database)
    for way in (database.look, database.read):
        with ExitStack() as opened:
            for tx in [opened.enter_context(way()) for _ in range(60)]:
                assert installations.find(tx, "a") is None
    database.close()


def test_moments_are_kept_to_the_microsecond(tables: Database) -> None:
    add_device(tables)
    with tables.read() as tx:
        assert tx.value(sa.select(device_table.c.created_at)) == NOW


def test_references_are_enforced(tables: Database) -> None:
    with pytest.raises(IntegrityError), tables.write() as tx:
        keys.add(tx, b"x" * 32, "device", "x", NOW, device_pk=5)
    pk = add_device(tables)
    with tables.write() as tx:
        keys.add(tx, b"x" * 32, "device", "x", NOW, device_pk=pk)
        devices.remove(tx, pk)
        assert tx.value(sa.select(sa.func.count()).select_from(api_keys)) == 0


def test_numbers_are_not_used_again(tables: Database) -> None:
    """A cookie or a stream that names a removed row must not find another one."""
    first = add_device(tables)
    with tables.write() as tx:
        devices.remove(tx, first)
    assert add_device(tables) > first


def test_every_reference_is_indexed(tables: Database) -> None:
    """Otherwise removing a device reads whole tables."""
    for table in metadata.tables.values():
        leading = [index.columns.keys()[0] for index in table.indexes if not index.dialect_options["sqlite"]["where"]]
        leading += [next(iter(constraint.columns)).name for constraint in table.constraints if constraint.columns]  # type: ignore[attr-defined]
        for reference in table.foreign_keys:
            assert reference.parent.name in leading, f"{table.name}.{reference.parent.name}"


def test_what_a_savepoint_may_take_back_goes_through_no_file(tmp_path: Path) -> None:
    database = Database(f"sqlite:///{tmp_path / 'x.db'}")
    upgrade(database)
    with database.write() as tx:
        assert tx.connection.exec_driver_sql("PRAGMA temp_store").scalar() == MEMORY
    database.close()


def test_sqlite_is_durable(tmp_path: Path) -> None:
    database = Database(f"sqlite:///{tmp_path / 'x.db'}")
    upgrade(database)
    with database.write() as tx:
        pragmas = {
            name: tx.connection.exec_driver_sql(f"PRAGMA {name}").scalar()
            for name in ("journal_mode", "synchronous", "foreign_keys", "busy_timeout")
        }
    assert pragmas == {"journal_mode": "wal", "synchronous": 2, "foreign_keys": 1, "busy_timeout": 10_000}
    database.close()


def test_writers_of_one_device_wait_for_each_other(tables: Database) -> None:
    """Lost updates: each writer reads, then writes; with a lock all additions count."""
    pk = add_device(tables)

    def name(tx: ReadSession) -> str:
        return str(tx.value(sa.select(device_table.c.name)))

    def add_one() -> None:
        for _ in range(5):
            with tables.write() as tx:
                assert installations.lock(tx, "a") is not None
                devices.edit(tx, pk, {"name": str(int(name(tx)) + 1)})

    with tables.write() as tx:
        devices.edit(tx, pk, {"name": "0"})
    threads = [threading.Thread(target=add_one) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    with tables.read() as reader:
        assert name(reader) == "20"


def test_facts_are_set_and_changed(tables: Database) -> None:
    with tables.write() as tx:
        assert meta.get(tx, "x") is None
        meta.put(tx, "x", "1")
        meta.put(tx, "x", "2")
        assert meta.get(tx, "x") == "2"


# ---------------------------------------------------------------- the order of events


def told(database: Database, position: Position) -> list[str]:
    with database.read() as tx:
        return [event.device_id for event in events.after(tx, position)]


def test_events_are_read_after_a_position(tables: Database) -> None:
    with tables.write() as tx:
        events.add(tx, "before", "device", "{}", NOW)
    with tables.read() as tx:
        start = events.latest(tx)
    assert told(tables, start) == []
    with tables.write() as tx:
        for name in ("a", "b"):
            events.add(tx, name, "device", "{}", NOW)
    with tables.write() as tx:
        events.add(tx, "c", "device", "{}", NOW)
    assert told(tables, start) == ["a", "b", "c"]
    with tables.read() as tx:
        first, *_ = events.after(tx, start)
        assert [e.device_id for e in events.after(tx, start, limit=2)] == ["a", "b"]
        assert told(tables, first.position) == ["b", "c"]
        assert Position.parse(str(first.position)) == first.position


@pytest.mark.postgres
@pytest.mark.parametrize("backend", ["postgresql"], indirect=True)
def test_an_event_committed_late_is_not_missed(tables: Database) -> None:
    """Row numbers are handed out before the commit: a reader must not go past one that is still under way."""
    with tables.read() as tx:
        start = events.latest(tx)
    with tables.write() as slow:
        events.add(slow, "slow", "device", "{}", NOW)
        slow.run_all()  # now it has its number
        with tables.write() as fast:
            events.add(fast, "fast", "device", "{}", NOW)
        assert told(tables, start) == []
    assert told(tables, start) == ["slow", "fast"]


def test_removing_events_remembers_how_far(tables: Database) -> None:
    with tables.write() as tx:
        for n, name in enumerate("abc"):
            events.add(tx, name, "device", "{}", NOW + timedelta(seconds=n))
    with tables.write() as tx:
        events.forget(tx, NOW, 10)
        assert events.pruned(tx) == Position(0, 0)
        events.forget(tx, NOW + timedelta(seconds=2), 10)
    with tables.read() as tx:
        (left,) = events.after(tx, Position(0, 0))
        assert left.device_id == "c"
        assert Position(0, 0) < events.pruned(tx) < left.position


@pytest.mark.parametrize("text", ["", "1", "1.", ".1", "1.2.3", "-1.2", "1.x", "1e3.2", "٣.٤", "9" * 30 + ".1"])
def test_only_positions_are_read_as_positions(text: str) -> None:
    assert Position.parse(text) is None


def test_a_calibration_edited_while_an_upload_waits_for_the_lock_holds_for_it(tables: Database) -> None:
    pk = add_device(tables)
    calibration = {"gain": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "offset": [0, 0, 0]}
    locked = threading.Event()

    def upload() -> installations.Installation | None:
        locked.wait()
        with tables.write() as tx:
            return installations.lock(tx, "a")

    with ThreadPoolExecutor() as pool:
        waiting = pool.submit(upload)
        with tables.write() as tx:
            installations.lock(tx, "a")
            devices.edit(tx, pk, {"accelerometer_calibration": calibration})
            locked.set()
            time.sleep(0.3)
        row = waiting.result(10)
    assert row is not None
    assert row.accelerometer_calibration == calibration
