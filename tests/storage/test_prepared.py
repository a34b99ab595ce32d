"""A prepared statement does what SQLAlchemy does with it."""

from datetime import UTC, datetime
from typing import Any

import pytest
import sqlalchemy as sa

from storage import devices, events
from storage.database import Database
from storage.events import Position
from storage.migrate import upgrade
from storage.models import devices as table
from storage.prepared import Prepared
from tests.plans import statements

NOW = datetime(2026, 5, 4, 3, 2, 1, 123456, tzinfo=UTC)
CALIBRATION = {"gain": [[1.0]], "offset": [0.5]}
BY_ID = sa.select(table.c.id, table.c.accelerometer_calibration, table.c.created_at, table.c.notes).where(
    table.c.id == sa.bindparam("id"), table.c.name != "nobody"
)
ADD = Prepared(sa.insert(table))
RENAME = Prepared(sa.update(table).where(table.c.id == sa.bindparam("of_id")))


@pytest.fixture(autouse=True)
def _tables(database: Database) -> None:
    upgrade(database)


def rows(database: Database, device_id: str) -> list[tuple[Any, ...]]:
    with database.read() as tx:
        plain = tx.all(lambda *row: row, BY_ID, id=device_id)
        assert tx.all(lambda *row: row, Prepared(BY_ID), id=device_id) == plain
        assert tx.one(lambda *row: row, Prepared(BY_ID), id=device_id) == (plain[0] if plain else None)
    return plain


@pytest.mark.parametrize("calibration", [CALIBRATION, None])
def test_values_go_in_and_come_out_as_their_types_have_them(database: Database, calibration: Any) -> None:
    with database.write() as tx:
        tx.run(ADD, id="a", name="A", created_at=NOW, accelerometer_calibration=calibration)
    assert rows(database, "a") == [("a", calibration, NOW, None)]
    assert rows(database, "b") == []


def test_other_names_are_another_text(database: Database) -> None:
    with database.write() as tx:
        devices.add(tx, "a", {"name": "A"}, NOW)
        tx.run(RENAME, of_id="a", name="B")
        tx.run(RENAME, of_id="a", notes="new", accelerometer_calibration=CALIBRATION)
        assert tx.value(sa.select(table.c.name)) == "B"
    assert rows(database, "a") == [("a", CALIBRATION, NOW, "new")]


def test_errors_are_sqlalchemys_and_undo_the_transaction(database: Database) -> None:
    with database.write() as tx:
        tx.run(ADD, id="a", name="A", created_at=NOW)

    def add_both() -> None:
        with database.write() as tx:
            tx.run(ADD, id="b", name="B", created_at=NOW)
            tx.run(ADD, id="a", name="again", created_at=NOW)

    with pytest.raises(sa.exc.IntegrityError):
        add_both()
    assert rows(database, "b") == []


@pytest.mark.parametrize("backend", ["postgresql"], indirect=True)
def test_a_connection_that_has_ended_is_not_used_again(database: Database, monkeypatch: pytest.MonkeyPatch) -> None:
    end_all = sa.text(
        "SELECT count(pg_terminate_backend(pid)) FROM pg_stat_activity "
        "WHERE datname = current_database() AND pid <> pg_backend_pid()"
    )
    with database.write(), database.write(), database.write():
        pass  # now three connections rest
    other = Database(database.url.render_as_string(hide_password=False))
    with other.write() as tx:
        tx.connection.execute(end_all)

    def look() -> None:
        with database.look() as tx:
            tx.one(lambda *row: row, Prepared(BY_ID), id="a")

    with pytest.raises(sa.exc.DBAPIError) as caught:
        look()
    assert caught.value.connection_invalidated
    assert rows(database, "a") == []
    monkeypatch.setattr("storage.database.ASKED_AFTER", 0.0)
    with other.write() as tx:
        tx.connection.execute(end_all)
    assert rows(database, "a") == []  # one that has rested is asked first
    other.close()


@pytest.mark.parametrize("values", [{"id": "secret-value" * 30, "name": None, "created_at": NOW}])
def test_errors_do_not_tell_what_was_sent(database: Database, values: dict[str, Any]) -> None:
    def add() -> None:
        with database.write() as tx:
            tx.run(ADD, **values)

    with pytest.raises(sa.exc.DBAPIError) as caught:
        add()
    assert "parameters" not in str(caught.value)


def test_what_is_run_later_is_there_when_it_is_asked_for(database: Database) -> None:
    with database.write() as tx:
        tx.run(ADD, id="a", name="A", created_at=NOW)
        tx.run(RENAME, of_id="a", name="B")  # the same table: in this order
        events.add(tx, "a", "device", "{}", NOW)
        assert tx.value(sa.select(table.c.name)) == "B"
        tx.run(RENAME, of_id="a", name="C")
        events.add(tx, "a", "device", '{"C": "50 %"}', NOW)
    assert rows(database, "a")[0][0] == "a"
    with database.read() as tx:
        assert tx.value(sa.select(table.c.name)) == "C"
        assert [event.data for event in events.after(tx, Position(0, 0))] == ["{}", '{"C": "50 %"}']


@pytest.mark.parametrize("backend", ["postgresql"], indirect=True)
def test_postgresql_gets_rows_of_several_tables_at_once(database: Database) -> None:
    with database.write() as tx, statements(tx.connection) as ran:
        tx.run(ADD, id="a", name="A", created_at=NOW)
        events.add(tx, "a", "device", "{}", NOW)
        tx.run_all()
    ((text, _),) = ran
    assert text.startswith("WITH")


def test_an_error_of_what_is_run_later_undoes_everything(database: Database) -> None:
    def add_both() -> None:
        with database.write() as tx:
            tx.run(ADD, id="a", name=None, created_at=NOW)
            events.add(tx, "a", "device", "{}", NOW)

    with pytest.raises(sa.exc.IntegrityError):
        add_both()
    assert rows(database, "a") == []
    with database.read() as tx:
        assert events.after(tx, Position(0, 0)) == []
