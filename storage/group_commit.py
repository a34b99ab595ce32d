"""One commit for the transactions of several threads: on SQLite only one can write, and a commit waits for the disk.

Each transaction is a savepoint in the group's transaction, one after the other. Whoever finishes with nobody waiting
behind commits for all of the group; while the disk is waited for, the next group gathers. Nobody goes on before the
commit, and a transaction that fails undoes only itself.
"""

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from sqlalchemy.engine import Connection, Engine
from sqlalchemy.exc import DBAPIError
from sqlalchemy.exc import TimeoutError as BusyError

from storage import prepared
from storage.file_lock import FileLock

MOST = 32
"""transactions in a group, so that the first of them does not wait for ever"""


class Group:
    """Transactions that become durable together."""

    def __init__(self, connection: Connection) -> None:
        self.connection = connection
        self.size = 0
        self.error: BaseException | None = None
        self._over = threading.Event()

    @contextmanager
    def member(self) -> Iterator[Connection]:
        """Add a transaction; when the block raises, only this one is undone."""
        if self.error is not None:
            raise self.error
        prepared.execute(self.connection, "SAVEPOINT member")
        try:
            yield self.connection
            prepared.execute(self.connection, "RELEASE member")
        except BaseException:
            self._undo_member()
            raise
        self.size += 1

    def _undo_member(self) -> None:
        try:
            prepared.execute(self.connection, "ROLLBACK TO member")
            prepared.execute(self.connection, "RELEASE member")
        except DBAPIError as error:  # SQLite has given up the whole transaction, on a full disk for one
            self.error = error

    def end(self) -> None:
        """Commit, and tell the members how it went."""
        try:
            if self.size and self.error is None:
                self.connection.commit()
        except BaseException as error:
            self.error = error
            self.connection.invalidate()  # whatever state it is in
        finally:
            self.connection.close()  # undoes what was not committed
            self._over.set()

    def wait(self) -> None:
        """Wait for the commit; raise if it failed."""
        self._over.wait()
        if self.error is not None:
            raise self.error


class GroupCommit:
    """The write transactions of this process on a SQLite file; a lock file makes processes take turns."""

    def __init__(self, engine: Engine, lock: FileLock) -> None:
        self._engine = engine
        self._lock = lock
        self._turns = threading.Condition()
        self._taken = False
        self._waiting = 0
        self._group: Group | None = None

    @contextmanager
    def transaction(self, seconds: float) -> Iterator[Connection]:
        """Open a transaction, durable when the block ends without an error; SQLAlchemy's `TimeoutError` if busy."""
        with self.together(seconds) as group, group.member() as connection:
            yield connection

    @contextmanager
    def together(self, seconds: float, meanwhile: Callable[[], bool] = lambda: False) -> Iterator[Group]:
        """Take one turn for several transactions, members of a group, durable when the block ends without an error.

        `meanwhile` is called while another process has its turn, see `FileLock.acquire`.
        """
        self._take_turn(seconds)
        try:
            group = self._group = self._group or self._open(seconds, meanwhile)
            yield group
        finally:
            self._end_turn()
        group.wait()

    def _take_turn(self, seconds: float) -> None:
        with self._turns:
            self._waiting += 1
            free = self._turns.wait_for(lambda: not self._taken, seconds)
            self._waiting -= 1
            if not free:
                raise BusyError("the database is busy")
            self._taken = True

    def _end_turn(self) -> None:
        if not self._hand_on():
            self._end_group()
            self._free()

    def _hand_on(self) -> bool:
        """Leave the group to whoever waits; seen and done under one lock, or that one might give up in between."""
        group = self._group
        with self._turns:
            if self._waiting == 0 or group is None or group.size >= MOST or group.error is not None:
                return False
            self._taken = False
            self._turns.notify()
            return True

    def _end_group(self) -> None:
        group, self._group = self._group, None
        if group is not None:
            group.end()
            self._lock.release()

    def _free(self) -> None:
        with self._turns:
            self._taken = False
            self._turns.notify()

    def _open(self, seconds: float, meanwhile: Callable[[], bool]) -> Group:
        if not self._lock.acquire(seconds, meanwhile):
            raise BusyError("the database is busy")
        try:
            connection = self._engine.connect()
        except BaseException:
            self._lock.release()
            raise
        try:
            connection.begin()
        except BaseException:
            connection.close()
            self._lock.release()
            raise
        return Group(connection)

    def close(self) -> None:
        """Let go of the lock file."""
        self._lock.close()
