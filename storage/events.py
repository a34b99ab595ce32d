"""What the live stream tells, in an order in which nothing can appear before something already read.

SQLite commits one transaction after the other, so row numbers are that order. PostgreSQL hands out row numbers before
the commit: a lower one may become visible later. There the order is (transaction, row), read only up to the oldest
transaction still running.
"""

from datetime import datetime
from typing import NamedTuple, Self

import sqlalchemy as sa

from storage import meta
from storage.database import ReadSession, WriteSession
from storage.models import Instant, events
from storage.prepared import Prepared

PRUNED = "events_pruned"


class Position(NamedTuple):
    """A place in the stream: everything up to here was read."""

    xact: int
    pk: int

    def __str__(self) -> str:
        """Give the text used as event id."""
        return f"{self.xact}.{self.pk}"

    @classmethod
    def parse(cls, text: str) -> Self | None:
        """Read what `str` gave; None when it is something else."""
        xact, dot, pk = text.partition(".")
        sound = dot and all(part.isascii() and part.isdigit() and len(part) < 19 for part in (xact, pk))
        return cls(int(xact), int(pk)) if sound else None


class Event(NamedTuple):
    """An event of the stream; `data` is JSON."""

    position: Position
    device_id: str
    type: str
    data: str


def _bigint(xid8: sa.ColumnElement[object]) -> sa.ColumnElement[int]:
    return sa.cast(sa.cast(xid8, sa.Text), sa.BigInteger)


_oldest_running = _bigint(sa.func.pg_snapshot_xmin(sa.func.pg_current_snapshot()))
_add_sqlite = Prepared(sa.insert(events).values(xact=0))
_add_postgresql = Prepared(sa.insert(events).values(xact=_bigint(sa.func.pg_current_xact_id())))
_after_sqlite = (
    sa.select(events.c.xact, events.c.pk, events.c.device_id, events.c.type, events.c.data)
    .where(
        sa.tuple_(events.c.xact, events.c.pk)
        > sa.tuple_(sa.bindparam("xact", type_=sa.BigInteger), sa.bindparam("pk", type_=sa.BigInteger))
    )
    .order_by(events.c.xact, events.c.pk)
    .limit(sa.bindparam("limit"))
)
_oldest = (
    sa.select(events.c.pk)
    .where(events.c.created_at < sa.bindparam("before", type_=Instant))
    .order_by(events.c.created_at)
    .limit(sa.bindparam("limit"))
)
_remove = sa.delete(events).where(events.c.pk.in_(_oldest)).returning(events.c.xact, events.c.pk)
_after_postgresql = _after_sqlite.where(events.c.xact < _oldest_running)


def add(tx: WriteSession, device_id: str, kind: str, data: str, now: datetime) -> None:
    """Append an event."""
    add_here = _add_postgresql if tx.is_postgresql else _add_sqlite
    tx.run(add_here, device_id=device_id, type=kind, data=data, created_at=now)


def after(tx: ReadSession, position: Position, limit: int = 500) -> list[Event]:
    """Give up to `limit` events after a position."""
    after_here = _after_postgresql if tx.is_postgresql else _after_sqlite
    values = {"xact": position.xact, "pk": position.pk, "limit": limit}
    return tx.all(lambda xact, pk, *rest: Event(Position(xact, pk), *rest), after_here, **values)


def latest(tx: ReadSession) -> Position:
    """Give the position now."""
    if tx.is_postgresql:
        return Position(tx.value(sa.select(_oldest_running)), 0)
    newest = Position(0, tx.value(sa.select(sa.func.coalesce(sa.func.max(events.c.pk), 0))))
    return max(newest, pruned(tx))  # all may have been removed


def pruned(tx: ReadSession) -> Position:
    """Give the position of the newest event that was removed."""
    text = meta.get(tx, PRUNED)
    return (Position.parse(text) if text else None) or Position(0, 0)


def forget(tx: WriteSession, before: datetime, limit: int) -> int:
    """Remove up to `limit` events from before a moment; give their number."""
    removed = tx.all(Position, _remove, before=before, limit=limit)
    if removed:
        meta.put(tx, PRUNED, str(max(*removed, pruned(tx))))
    return len(removed)
