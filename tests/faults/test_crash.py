"""A fault at any statement of an upload undoes all of it, and the same chunk sent again does all of it."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import psycopg
import pytest
import sqlalchemy as sa
from sqlalchemy import event
from starlette.testclient import TestClient

from api.app import create_app
from api.settings import Settings
from storage import database as database_module
from storage import prepared
from storage.database import Database
from storage.models import metadata
from tests.conftest import Clock
from tests.drives import Story, chunks, remounted
from tests.faults import stored
from tests.service import Api

EVENTFUL: dict[str, Callable[[Story], int]] = {
    "the first chunk": lambda _: 0,
    "a mounting is confirmed": lambda story: story.confirmed,
    "the device was moved": lambda story: story.moved,
    "a new mounting ends the alert": lambda story: story.confirmed_anew,
}


@contextmanager
def crash_at(statement: int) -> Iterator[list[str]]:
    """Fail at a statement of the write transactions, counted from 0; the COMMIT counts as one. Gives what ran."""
    seen: list[str] = []

    def count(what: str) -> None:
        seen.append(what)
        if len(seen) == statement + 1:
            raise RuntimeError("crash")

    def before_execute(connection: Any, _cursor: Any, text: str, *_rest: Any) -> None:
        if not connection.get_execution_options().get("postgresql_readonly") and not is_reader(connection):
            count(text)

    def before_commit(connection: Any) -> None:
        if not connection.get_execution_options().get("postgresql_readonly") and not is_reader(connection):
            count("COMMIT")

    def execute(
        connection: sa.Connection, sql: str, parameters: Sequence[Any] | dict[str, Any] = (), reads: bool = False
    ) -> list[Any]:
        before_execute(connection, None, sql)
        return straight(connection, sql, parameters, reads)

    straight, prepared.execute = prepared.execute, execute
    event.listen(sa.Engine, "before_cursor_execute", before_execute)
    event.listen(sa.Engine, "commit", before_commit)
    try:
        yield seen
    finally:
        event.remove(sa.Engine, "before_cursor_execute", before_execute)
        event.remove(sa.Engine, "commit", before_commit)
        prepared.execute = straight


def is_reader(connection: sa.Connection) -> bool:
    if connection.dialect.name == "postgresql":
        return False
    return bool(connection.connection.cursor().execute("PRAGMA query_only").fetchone()[0])


def everything(database: Database) -> dict[str, list[Any]]:
    with database.read() as tx:
        return {
            table.name: [tuple(row) for row in tx.connection.execute(sa.select(table).order_by(*table.primary_key))]
            for table in metadata.sorted_tables
        }


@pytest.mark.parametrize("what", EVENTFUL)
def test_a_crash_at_any_statement_undoes_everything(api: Api, database: Database, what: str) -> None:
    bodies = remounted().chunks
    seq = EVENTFUL[what](remounted())
    calm, disturbed = api.add_device("calm"), api.add_device("disturbed")
    for device in (calm, disturbed):
        device.send_all(bodies[:seq])
    with crash_at(10**6) as statements:
        calm.send(bodies[seq], seq, expect=200)
    assert statements[-1] == "COMMIT"
    before = everything(database)
    for n in range(len(statements)):
        with crash_at(n):
            problem = disturbed.send(bodies[seq], seq, expect=500)
        assert "crash" not in problem.text
        assert everything(database) == before, statements[n]
    assert not disturbed.send(bodies[seq], seq, expect=200).json()["chunk"]["duplicate"]
    assert stored.of_device(database, "disturbed") == stored.of_device(database, "calm")


def test_a_crash_after_the_commit_is_seen_as_a_duplicate(
    api: Api, database: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    device = api.add_device()
    monkeypatch.setattr("api.metrics.Upload.answered", lambda *_: 1 / 0)
    device.send(chunks()[0], 0, expect=500)
    monkeypatch.undo()
    assert device.send(chunks()[0], 0, expect=200).json()["chunk"]["duplicate"]


def test_a_busy_or_missing_database_is_worth_another_try(
    settings: Settings, clock: Clock, backend: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(database_module, "BUSY_TIMEOUT", 0.2)
    with TestClient(create_app(settings, clock), raise_server_exceptions=False) as client:
        api = Api(client)
        api.wait_until_ready()
        device = api.add_device()
        with blocked(settings, backend):
            answer = device.send(chunks()[0], 0, expect=503)
            assert answer.headers["retry-after"].isdigit()
            assert answer.headers["content-type"] == "application/problem+json"
            assert "livella" not in answer.text.replace("urn:livella", "")
        device.send(chunks()[0], 0, expect=200)


@contextmanager
def blocked(settings: Settings, backend: str) -> Iterator[None]:
    """Hold SQLite's write lock; shut the PostgreSQL database."""
    if backend == "sqlite":
        other = Database(settings.url)
        with other.write():
            yield
        other.close()
        return
    url, name = settings.url.rsplit("/", 1)
    with psycopg.connect(f"{url}/postgres", autocommit=True) as server:
        server.execute(f"ALTER DATABASE {name} ALLOW_CONNECTIONS false".encode())
        server.execute("SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE datname = %s", [name])
        yield
        server.execute(f"ALTER DATABASE {name} ALLOW_CONNECTIONS true".encode())
