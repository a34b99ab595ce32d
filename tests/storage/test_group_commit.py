import multiprocessing
import sqlite3
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import pytest
import sqlalchemy as sa
from sqlalchemy import event

from storage import database as database_module
from storage import meta
from storage.database import Database
from storage.file_lock import FileLock
from storage.migrate import upgrade


@pytest.fixture
def database(tmp_path: Path) -> Iterator[Database]:
    made = Database(f"sqlite:///{tmp_path / 'x.db'}")
    upgrade(made)
    yield made
    made.close()


def facts(database: Database) -> dict[str, str]:
    with database.read() as tx:
        found = tx.connection.execute(sa.text("SELECT name, value FROM meta WHERE name LIKE 'x%'"))
        return {row.name: row.value for row in found}


@contextmanager
def commits(database: Database, before: Callable[[], None] = lambda: None) -> Iterator[list[int]]:
    seen: list[int] = []

    def count(_: sa.Connection) -> None:
        before()
        seen.append(1)

    event.listen(database.engine, "commit", count)
    yield seen
    event.remove(database.engine, "commit", count)


def write_together(database: Database, write: Callable[[int], None], number: int = 6) -> None:
    """Let threads write that all wait while another one has its turn."""
    threads = [threading.Thread(target=write, args=(n,)) for n in range(number)]
    try:
        with database.write():
            for thread in threads:
                thread.start()
            time.sleep(0.2)
    finally:
        for thread in threads:
            thread.join(20)
            assert not thread.is_alive()


def test_those_who_wait_are_committed_together(database: Database) -> None:
    def write(n: int) -> None:
        with database.write() as tx:
            meta.put(tx, f"x{n}", "1")
        assert facts(database)[f"x{n}"] == "1"

    with commits(database) as seen:
        write_together(database, write)
    assert len(facts(database)) == 6
    assert len(seen) == 1


def test_one_that_fails_spoils_nothing_for_the_others(database: Database) -> None:
    failed = []

    def write(n: int) -> None:
        try:
            with database.write() as tx:
                meta.put(tx, f"x{n}", "1")
                assert n % 2 == 0
        except AssertionError:
            failed.append(n)

    write_together(database, write)
    assert sorted(facts(database)) == ["x0", "x2", "x4"]
    assert sorted(failed) == [1, 3, 5]


def test_when_the_commit_fails_everybody_is_told(database: Database) -> None:
    told = []

    def fail() -> None:
        raise sqlite3.OperationalError("disk I/O error")

    def write(n: int) -> None:
        try:
            with database.write() as tx:
                meta.put(tx, f"x{n}", "1")
        except sqlite3.OperationalError:
            told.append(n)

    with commits(database, fail), pytest.raises(sqlite3.OperationalError):
        write_together(database, write)
    assert facts(database) == {}
    write(7)
    assert sorted(facts(database)) == ["x7"]


def test_when_sqlite_gives_up_the_transaction_everybody_is_told(database: Database) -> None:
    told = []

    def write(n: int) -> None:
        try:
            with database.write() as tx:
                meta.put(tx, f"x{n}", "1")
                if n == 5:
                    tx.connection.exec_driver_sql("ROLLBACK")
        except sa.exc.DBAPIError:
            told.append(n)

    with pytest.raises(sa.exc.OperationalError):
        write_together(database, write)
    assert len(told) + len(facts(database)) == 6
    assert 5 in told


def test_a_busy_database_is_given_up_and_what_is_written_is_still_committed(
    database: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(database_module, "BUSY_TIMEOUT", 0.1)

    def write(_: int) -> None:
        with pytest.raises(sa.exc.TimeoutError), database.write():
            pass

    thread = threading.Thread(target=write, args=(0,))
    with database.write() as tx:
        meta.put(tx, "x", "1")
        thread.start()
        thread.join(10)
    assert facts(database) == {"x": "1"}


def count_turns(path: str, until: float, turns: "multiprocessing.Queue[int]") -> None:
    lock, number = FileLock(path), 0
    while time.monotonic() < until:
        assert lock.acquire(5)
        time.sleep(0.002)
        lock.release()
        number += 1
    turns.put(number)


def test_processes_take_turns(tmp_path: Path) -> None:
    spawn = multiprocessing.get_context("spawn")
    turns: multiprocessing.Queue[int] = spawn.Queue()
    until = time.monotonic() + 8
    processes = [spawn.Process(target=count_turns, args=(str(tmp_path / "x"), until, turns)) for _ in range(2)]
    for process in processes:
        process.start()
    numbers = [turns.get(timeout=30) for _ in processes]
    for process in processes:
        process.join()
    assert min(numbers) > 0.2 * max(numbers)


def test_nobody_stands_in_the_line_while_there_is_other_work(tmp_path: Path) -> None:
    writing, busy, passing = (FileLock(str(tmp_path / "x")) for _ in range(3))
    work = iter([True, True, False])

    def pass_by() -> bool:
        writing.release()
        assert passing.acquire(0.0)
        return next(work)

    assert writing.acquire(5)
    assert not busy.acquire(0.0)
    assert not busy.acquire(0.0, pass_by)
    assert list(work) == []
    passing.release()
    assert busy.acquire(0.0, pass_by)
    assert not passing.acquire(0.0)
    for lock in (writing, busy, passing):
        lock.close()


class SlowCondition(threading.Condition):
    """Lets others come between two uses of the lock."""

    def __exit__(self, *error: Any) -> None:
        super().__exit__(*error)
        time.sleep(0.2)


def test_nobody_is_left_waiting_when_the_one_behind_gives_up(
    database: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whoever hands its turn on relies on the next one to commit, which may give up at that very moment."""
    assert database._group is not None
    monkeypatch.setattr(database._group, "_turns", SlowCondition())
    monkeypatch.setattr(database_module, "BUSY_TIMEOUT", 0.5)
    inside = threading.Event()

    def write(name: str, seconds: float) -> None:
        with suppress(sa.exc.TimeoutError), database.write() as tx:
            meta.put(tx, name, "1")
            inside.set()
            time.sleep(seconds)

    threads = [threading.Thread(target=write, args=args, daemon=True) for args in (("x1", 0.4), ("x2", 0.0))]
    threads[0].start()
    assert inside.wait(10)
    threads[1].start()
    for thread in threads:
        thread.join(10)
        assert not thread.is_alive()
    assert "x1" in facts(database)


def test_members_of_one_turn_are_committed_at_once_and_fail_alone(database: Database) -> None:
    with commits(database) as seen, database.together() as transaction:
        for n in range(4):
            with suppress(ValueError), transaction() as tx:
                meta.put(tx, f"x{n}", "1")
                if n == 2:
                    raise ValueError(n)
        assert facts(database) == {}
    assert set(facts(database)) == {"x0", "x1", "x3"}
    assert len(seen) == 1


def test_after_the_whole_turn_has_failed_no_member_goes_on(database: Database) -> None:
    def spoil(transaction: Callable[[], Any]) -> None:
        with suppress(sa.exc.DBAPIError), transaction() as tx:
            meta.put(tx, "x0", "1")
            tx.connection.exec_driver_sql("ROLLBACK")  # as SQLite does by itself on a full disk
            raise sa.exc.OperationalError("INSERT", None, Exception("disk is full"))

    def take_turn() -> None:
        with database.together() as transaction:
            spoil(transaction)
            with suppress(sa.exc.DBAPIError), transaction() as tx:
                meta.put(tx, "x1", "1")

    with pytest.raises(sa.exc.DBAPIError):
        take_turn()
    assert facts(database) == {}
    with database.write() as tx:
        meta.put(tx, "x2", "1")
    assert set(facts(database)) == {"x2"}
