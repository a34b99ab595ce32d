"""A transaction tried beforehand, without a lock: what it would write is kept, and played when nothing has changed.

On SQLite everybody who writes waits for everybody else, and what an upload computes takes many times as long as its
statements. What it does follows from what it reads. So it is done on a look at the database; the transaction then reads
the same once more and, if it finds the same rows, has nothing left to do but to write.
"""

from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from storage.database import ReadSession, WriteSession
from storage.prepared import Prepared, Run

T = TypeVar("T")


class NotRehearsedError(Exception):
    """What was asked for is done in a transaction only."""


class Rehearsal(WriteSession):
    """Prepared statements only, those that read before those that write, and of these one for each table."""

    def __init__(self, look: ReadSession) -> None:
        super().__init__(look.connection)
        self._seen: list[tuple[Run, list[Any]]] = []
        """what was read, with the rows as the driver had them"""

    @property
    def connection(self) -> Connection:
        """None is given: what is done on it could not be seen."""
        raise NotRehearsedError

    def run_all(self) -> None:
        """Nothing is run."""
        raise NotRehearsedError

    def one(self, make: Callable[..., T], statement: sa.Executable | Prepared, **values: Any) -> T | None:
        """Give the first row as `make(*row)`, or None."""
        return next((make(*row) for row in self._rows(statement, values)), None)

    def all(self, make: Callable[..., T], statement: sa.Executable | Prepared, **values: Any) -> list[T]:
        """Give every row as `make(*row)`."""
        return [make(*row) for row in self._rows(statement, values)]

    def _rows(self, statement: sa.Executable | Prepared, values: dict[str, Any]) -> list[Sequence[Any]]:
        if self._later or not isinstance(statement, Prepared):
            raise NotRehearsedError
        found = statement.found(self._connection, values)
        self._seen.append(((statement, values), found))
        return statement.shaped(self._connection, values, found)

    def play(self, tx: WriteSession) -> bool:
        """Write in a transaction what would be written; False, and nothing is, when it finds other rows."""
        if any(statement.found(tx.connection, values) != found for (statement, values), found in self._seen):
            return False
        for statement, values in self._later.values():
            tx.run(statement, **values)
        return True
