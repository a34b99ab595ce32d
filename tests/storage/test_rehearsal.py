"""A transaction is tried beforehand, and played only where nothing has changed."""

from collections.abc import Callable, Iterator
from datetime import UTC, datetime

import pytest
import sqlalchemy as sa

from storage import chunks, devices, events, sessions
from storage.database import Database, WriteSession
from storage.migrate import upgrade
from storage.models import events as event_table
from storage.rehearsal import NotRehearsedError, Rehearsal
from storage.sessions import Session

NOW = datetime(2024, 5, 6, 7, 8, 9, tzinfo=UTC)


@pytest.fixture
def tables(database: Database) -> Database:
    upgrade(database)
    with database.write() as tx:
        devices.add(tx, "a", {"name": "A"}, NOW)
        sessions.find_or_add(tx, 1, "s", NOW)
    return database


@pytest.fixture
def rehearsal(tables: Database) -> Iterator[Rehearsal]:
    with tables.look() as look:
        yield Rehearsal(look)


def count_on(tx: WriteSession) -> None:
    """What is tried here: read a session, and write two tables."""
    session = sessions.find(tx, 1, "s")
    assert session is not None
    sessions.save(tx, session._replace(next_seq=session.next_seq + 1))
    events.add(tx, "a", "kind", "{}", NOW)


def stored(database: Database) -> tuple[Session | None, int]:
    with database.read() as tx:
        return sessions.find(tx, 1, "s"), int(tx.value(sa.select(sa.func.count()).select_from(event_table)))


def test_nothing_is_written_before_it_is_played(tables: Database, rehearsal: Rehearsal) -> None:
    before = stored(tables)
    count_on(rehearsal)
    assert stored(tables) == before
    with tables.write() as tx:
        assert rehearsal.play(tx)
    session, number = stored(tables)
    assert session is not None
    assert (session.next_seq, number) == (1, 1)


def test_nothing_is_written_where_other_rows_are_found(tables: Database, rehearsal: Rehearsal) -> None:
    count_on(rehearsal)
    with tables.write() as tx:
        count_on(tx)
    before = stored(tables)
    with tables.write() as tx:
        assert not rehearsal.play(tx)
    assert stored(tables) == before


def test_that_nothing_was_found_is_a_finding(tables: Database, rehearsal: Rehearsal) -> None:
    assert chunks.find(rehearsal, 1, 0) is None
    with tables.write() as tx:
        assert rehearsal.play(tx)
        chunks.add(tx, chunks.Receipt(1, 0, "0" * 64, chunks.APPLIED, 1, 0, {}, NOW, 0.0, 1.0))
    with tables.write() as tx:
        assert not rehearsal.play(tx)


def look_at_what_was_changed(tx: WriteSession) -> None:
    count_on(tx)
    sessions.find(tx, 1, "s")


def change_a_table_twice(tx: WriteSession) -> None:
    for _ in range(2):
        events.add(tx, "a", "kind", "{}", NOW)


@pytest.mark.parametrize(
    "ask",
    [
        lambda tx: sessions.get(tx, 1),
        lambda tx: tx.value(sa.select(1)),
        lambda tx: tx.all(int, sa.select(1)),
        lambda tx: tx.execute(sa.insert(event_table)),
        look_at_what_was_changed,
        change_a_table_twice,
    ],
    ids=["unprepared", "a value", "unprepared rows", "a change", "a look at what was changed", "a table changed twice"],
)
def test_what_needs_a_transaction_is_refused(
    tables: Database, rehearsal: Rehearsal, ask: Callable[[WriteSession], object]
) -> None:
    before = stored(tables)
    with pytest.raises(NotRehearsedError):
        ask(rehearsal)
    assert stored(tables) == before
