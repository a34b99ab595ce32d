"""When keys were last used: remembered here, and written now and then, so that no request waits for it."""

import threading
from datetime import datetime
from itertools import islice

from storage import keys
from storage.database import Database

AT_ONCE = 500
"""keys in one transaction, so that uploads get their turn in between"""


class Uses:
    """The uses that are not written yet; there is one for each key at most."""

    def __init__(self) -> None:
        self._moments: dict[int, datetime] = {}
        self._writing = threading.Lock()

    def mark(self, key_pk: int, now: datetime) -> None:
        """Remember a use."""
        self._moments[key_pk] = now

    def write(self, database: Database) -> None:
        """Write what is remembered; it is remembered on when that fails."""
        with self._writing:
            moments, self._moments = self._moments, {}
            try:
                _write(database, moments)
            except BaseException:
                self._moments = moments | self._moments
                raise


def _write(database: Database, moments: dict[int, datetime]) -> None:
    left = iter(sorted(moments.items()))
    while batch := dict(islice(left, AT_ONCE)):
        with database.write() as tx:
            keys.used(tx, batch)
