"""When keys were last used: remembered here, and written now and then, so that no request waits for it."""

import threading
from datetime import datetime
from itertools import islice

from storage import keys
from storage.database import Database

AT_ONCE = 100
"""keys in one transaction, so that uploads get their turn in between"""


class Uses:
    """The uses that are not written yet; there is one for each key at most."""

    def __init__(self) -> None:
        self._moments: dict[int, datetime] = {}
        self._taken: dict[int, datetime] = {}
        """those that are being written"""
        self._writing = threading.Lock()

    def mark(self, key_pk: int, now: datetime) -> None:
        """Remember a use."""
        self._moments[key_pk] = now

    def write(self, database: Database) -> bool:
        """Write some of what is remembered, True when more is left; it is remembered on when that fails."""
        with self._writing:
            if not self._taken:
                self._taken, self._moments = self._moments, {}
            batch = dict(islice(self._taken.items(), AT_ONCE))
            if batch:
                with database.write() as tx:
                    keys.used(tx, batch)
            for key_pk in batch:
                del self._taken[key_pk]
            return bool(self._taken)
