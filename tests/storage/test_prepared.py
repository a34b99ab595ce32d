"""A prepared statement does what SQLAlchemy does with it."""

from datetime import UTC, datetime
from typing import Any

import pytest
import sqlalchemy as sa

from storage import devices
from storage.database import Database
from storage.migrate import upgrade
from storage.models import devices as table
from storage.prepared import Prepared

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
