"""One leader among all processes, on whatever hosts, for what one has to do: whoever holds a lease and renews it.

When the leader dies its lease runs out and another process takes over. For a moment there may be two, when a leader was
held up for longer than its lease: so whatever a leader does has to bear being done twice.
"""

import os
import secrets
import socket
import threading
from datetime import datetime, timedelta

from api.services.context import Context
from storage import leases
from storage.leases import Lease

LEASE = timedelta(seconds=30)
"""How long after the death of a leader another one takes over, at most."""
RENEWAL = timedelta(seconds=10)
"""Age at which a lease is renewed."""
SKEW = timedelta(seconds=30)
"""Clocks of hosts may differ by so much; a lease that ends later than any can is from before the clock was set back."""


class Leadership:
    """The wish of one process to lead."""

    def __init__(self, context: Context, name: str = "housekeeping") -> None:
        self.context = context
        self.name = name
        self.holder = f"{socket.gethostname()[:32]}-{os.getpid()}-{secrets.token_hex(4)}"
        self._taken_at: datetime | None = None
        self._asking = threading.Lock()
        """several jobs ask at once, and one that comes second must not forget what the first one took"""

    def held(self) -> bool:
        """Tell whether this process leads, taking or renewing the lease where that is due."""
        with self._asking:
            now = self.context.clock()
            if self._taken_at is not None and timedelta(0) <= now - self._taken_at < RENEWAL:
                return True
            self._taken_at = now if self._take(now) else None
            return self._taken_at is not None

    def _take(self, now: datetime) -> bool:
        latest = now + LEASE + SKEW
        with self.context.database.read() as tx:
            found = leases.find(tx, self.name)
        if found is not None and found.holder != self.holder and now < found.until <= latest:
            return False  # looked up first, since those who do not lead ask all the time
        with self.context.database.write() as tx:
            return leases.take(tx, self.name, Lease(self.holder, now + LEASE), now, latest)

    def give_up(self) -> None:
        """Let another one lead at once."""
        if self._taken_at is not None:
            self._taken_at = None
            with self.context.database.write() as tx:
                leases.give_up(tx, self.name, self.holder)
