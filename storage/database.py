"""The database, SQLite or PostgreSQL: read and write sessions as two types, and one commit point.

The files beside this one make their statements once, when they are imported, with parameters: building one for every
call costs SQLAlchemy more time than the database needs to run it.
"""

import math
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from typing import Any, TypeVar

import orjson
import sqlalchemy as sa
from sqlalchemy import event
from sqlalchemy.engine import Connection, CursorResult, Engine, make_url

from storage import prepared
from storage.file_lock import FileLock
from storage.group_commit import GroupCommit
from storage.prepared import Prepared, Run

T = TypeVar("T")

BUSY_TIMEOUT = 10.0
"""s a writer waits for another one before the request is answered with 503"""

LOOKS_KEPT = 2
"""connections to SQLite kept for looks: the event loop's and that of the thread that works on uploads"""
ASKED_AFTER = 1.0
"""s a connection to a server has rested after which it is asked whether it still lives"""


class ReadSession:
    """One consistent look at the database."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection

    @property
    def connection(self) -> Connection:
        """The connection, for what is not done here."""
        return self._connection

    @property
    def is_postgresql(self) -> bool:
        """True on PostgreSQL, False on SQLite."""
        return self._connection.dialect.name == "postgresql"

    def one(self, make: Callable[..., T], statement: sa.Executable | Prepared, **values: Any) -> T | None:
        """Give the first row as `make(*row)`, or None; `values` are those of the statement's parameters."""
        if isinstance(statement, Prepared):
            return next((make(*row) for row in statement.rows(self.connection, values)), None)
        row = self.connection.execute(statement, values).first()
        return None if row is None else make(*row)

    def all(self, make: Callable[..., T], statement: sa.Executable | Prepared, **values: Any) -> list[T]:
        """Give every row as `make(*row)`."""
        if isinstance(statement, Prepared):
            return [make(*row) for row in statement.rows(self.connection, values)]
        return [make(*row) for row in self.connection.execute(statement, values)]

    def value(self, statement: sa.Executable, **values: Any) -> Any:
        """Give the first column of the first row, or None."""
        return self.connection.execute(statement, values).scalar()


class WriteSession(ReadSession):
    """A transaction that may write; everything in it becomes durable together, or nothing does."""

    def __init__(self, connection: Connection) -> None:
        super().__init__(connection)
        self._later: dict[sa.FromClause | None, Run] = {}
        """what is still to be run, by table"""
        self.others = 0
        """statements other than the prepared ones that have changed something"""

    @property
    def connection(self) -> Connection:
        """The connection, on which everything has been run."""
        self.run_all()
        return self._connection

    def execute(self, statement: sa.Executable, **values: Any) -> CursorResult[Any]:
        """Run an INSERT, UPDATE or DELETE."""
        self.others += 1
        return self.connection.execute(statement, values)

    def run(self, statement: Prepared, **values: Any) -> None:
        """Run a prepared INSERT or UPDATE before anything else is asked for or changed, or at the end."""
        if statement.table in self._later:
            self.run_all()
        self._later[statement.table] = statement, values

    def run_all(self) -> None:
        """Run what is still to be run."""
        if self._later:
            runs, self._later = list(self._later.values()), {}
            prepared.run_all(self._connection, runs)


class Database:
    """The engines of one database. `read` and `write` are the only ways in, `write` is the only commit point."""

    def __init__(self, url: str) -> None:
        self.url = make_url(url)
        if self.url.drivername in {"postgresql", "postgres"}:
            self.url = self.url.set(drivername="postgresql+psycopg")
        self.is_sqlite = self.url.get_backend_name() == "sqlite"
        self._reads, self._writes = _sqlite_engines(self.url) if self.is_sqlite else _postgresql_engines(self.url)
        # SQLite's driver begins nothing by itself here, see `_sqlite_engines`
        # from the engine itself: what was set for the reads would be set once more, after this
        self._looks = self._reads if self.is_sqlite else self._writes.execution_options(isolation_level="AUTOCOMMIT")
        self._looking: list[Connection] = []
        """connections to SQLite with which nobody looks just now"""
        self._group = GroupCommit(self._writes, FileLock(self.url.database)) if self.is_sqlite else None

    @property
    def engine(self) -> Engine:
        """The engine that writes, for migrations."""
        return self._writes

    @contextmanager
    def read(self) -> Iterator[ReadSession]:
        """Open a read-only transaction: every query in it sees the same moment."""
        with self._reads.connect() as connection, connection.begin():
            yield ReadSession(connection)

    @contextmanager
    def look(self) -> Iterator[ReadSession]:
        """Look at the database without a transaction: each prepared statement sees the moment it runs at."""
        if not self.is_sqlite:
            with self._looks.connect() as connection:
                yield ReadSession(connection)
            return
        connection = self._connection_to_look()
        try:
            yield ReadSession(connection)
            connection.rollback()  # a statement that is not prepared has begun a transaction
        except BaseException:
            connection.close()
            raise
        if len(self._looking) < LOOKS_KEPT:
            self._looking.append(connection)
        else:
            connection.close()

    def _connection_to_look(self) -> Connection:
        """Take one that is kept: to take it from a pool and give it back costs more than to look."""
        with suppress(IndexError):
            return self._looking.pop()
        return self._looks.connect()

    @contextmanager
    def write(self) -> Iterator[WriteSession]:
        """Open a transaction, committed durably when the block ends and rolled back when it raises."""
        with _write_session(self._transaction()) as tx:
            yield tx

    @contextmanager
    def together(
        self, meanwhile: Callable[[], bool] = lambda: False
    ) -> Iterator[Callable[[], AbstractContextManager[WriteSession]]]:
        """Give what opens transactions, each on its own whether it takes effect.

        On SQLite all become durable together when the block ends without an error, elsewhere each when it ends. While
        another process writes there, `meanwhile` is called: some other work, False when there is none.
        """
        if self._group is None:
            yield self.write
            return
        with self._group.together(BUSY_TIMEOUT, meanwhile) as group:
            yield lambda: _write_session(group.member())

    def _transaction(self) -> AbstractContextManager[Connection]:
        return self._writes.begin() if self._group is None else self._group.transaction(BUSY_TIMEOUT)

    def close(self) -> None:
        """Close every connection."""
        while self._looking:
            self._looking.pop().close()
        self._reads.dispose()
        self._writes.dispose()
        if self._group is not None:
            self._group.close()


def _as_json(value: Any) -> str:
    return orjson.dumps(value).decode()


_JSON: dict[str, Any] = {"json_serializer": _as_json, "json_deserializer": orjson.loads}
"""Several times as quick as Python's own: every upload reads and writes half a dozen documents."""


@contextmanager
def _write_session(transaction: AbstractContextManager[Connection]) -> Iterator[WriteSession]:
    with transaction as connection:
        yield (tx := WriteSession(connection))
        tx.run_all()


def _sqlite_engines(url: sa.URL) -> tuple[Engine, Engine]:
    def engine(begin: str, pragmas: tuple[str, ...], **pool: Any) -> Engine:
        options = {"timeout": BUSY_TIMEOUT, "check_same_thread": False}
        made = sa.create_engine(url, connect_args=options, hide_parameters=True, **_JSON, **pool)

        @event.listens_for(made, "connect")
        def _connect(connection: Any, _record: Any) -> None:
            connection.isolation_level = None  # the driver leaves BEGIN to us
            for pragma in (f"busy_timeout = {int(BUSY_TIMEOUT * 1000)}", "foreign_keys = ON", *pragmas):
                connection.execute(f"PRAGMA {pragma}")

        @event.listens_for(made, "begin")
        def _begin(connection: Connection) -> None:
            prepared.execute(connection, begin)

        return made

    # what a SAVEPOINT may have to take back would else go through a file, page by page, in every group of uploads
    writing = ("synchronous = FULL", "temp_store = MEMORY")
    # more than there are threads that read: a look at a key, in the event loop, must not wait for one of them to end
    reads = engine("BEGIN", ("query_only = ON",), pool_size=8, max_overflow=56)
    writes = engine("BEGIN IMMEDIATE", writing, pool_size=1, max_overflow=1)
    return reads, writes


def _postgresql_engines(url: sa.URL) -> tuple[Engine, Engine]:
    waits = f"-c lock_timeout={int(BUSY_TIMEOUT * 1000)} -c idle_in_transaction_session_timeout=60000"
    engine = sa.create_engine(
        url,
        connect_args={"connect_timeout": 5, "options": waits, "application_name": "livella"},
        hide_parameters=True,  # errors are logged, and must not hold what was sent
        pool_size=10,
        max_overflow=40,
        pool_timeout=BUSY_TIMEOUT,
        **_JSON,
    )
    _watch_over(engine)
    reads = engine.execution_options(isolation_level="REPEATABLE READ", postgresql_readonly=True)
    return reads, engine


def _watch_over(engine: Engine) -> None:
    """Ask a connection whether it lives before it is used again, unless it was used just now: asking costs a way.

    When one was found to have ended, so may have all that were put back before.
    """
    lost_at = -math.inf

    @event.listens_for(engine, "checkin")
    def _rests(_connection: Any, record: Any) -> None:
        record.info["since"] = time.monotonic()

    @event.listens_for(engine, "invalidate")
    def _lost(_connection: Any, _record: Any, _error: Any) -> None:
        nonlocal lost_at
        lost_at = time.monotonic()

    @event.listens_for(engine, "checkout")
    def _ask(connection: Any, record: Any, _proxy: Any) -> None:
        since = record.info.get("since", math.inf)
        if since > max(lost_at, time.monotonic() - ASKED_AFTER):
            return
        try:
            engine.dialect.do_ping(connection)
        except engine.dialect.loaded_dbapi.Error as error:
            raise sa.exc.DisconnectionError("the connection has ended") from error
