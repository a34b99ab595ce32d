"""Writes that PostgreSQL is sent without waiting for the answer to each: every wait costs a way there and back.

While statements are on their way so, the driver's answers come later and errors are raised by what waits next: a read,
or the commit. SQLAlchemy knows nothing of this, so it gets a connection only on which nothing is on its way.
"""

from typing import Any

from sqlalchemy.engine import Connection

from storage.prepared import wrapping


class Pipeline:
    """The pipeline of one transaction on PostgreSQL, open from a write on."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._open: Any = None

    def begin(self) -> None:
        """Send what follows without waiting."""
        if self._open is None:
            driver: Any = self._connection.connection.dbapi_connection
            self._open = driver.pipeline()
            self._open.__enter__()

    def end(self) -> None:
        """Wait until everything that was sent has taken effect.

        Raises
        ------
        sqlalchemy.exc.DBAPIError
            something has not.
        """
        if self._open is not None:
            with wrapping(self._connection, "pipeline"):
                self._leave()

    def abandon(self) -> None:
        """Leave the connection as it was found, after the transaction: whatever was wrong has been told."""
        if self._open is not None:
            try:
                self._leave()
            except self._connection.dialect.loaded_dbapi.Error:
                self._connection.invalidate()

    def _leave(self) -> None:
        pipeline, self._open = self._open, None
        pipeline.__exit__(None, None, None)
