"""What happened to vehicles: events of their motion, newest first in lists."""

from collections.abc import Callable
from datetime import datetime, timedelta
from typing import Any, NamedTuple

import sqlalchemy as sa

from storage.database import ReadSession, WriteSession
from storage.models import MICROSECOND, Instant, motion_events, raw_chunks, sessions
from storage.prepared import Prepared

IMPACT = "impact"
"""the kind around which samples are kept for ever"""


class MotionEvent(NamedTuple):
    """An event."""

    pk: int
    kind: str
    t: float
    """s on the session's clock, of the peak"""
    at: datetime
    """of the peak, by what is known of the session's start"""
    data: dict[str, Any]
    """what more was found, SI units and radians"""
    session: str
    kept: bool
    """the samples of the chunk in which it was found are there"""


class Place(NamedTuple):
    """A place in a list of events."""

    at: datetime
    pk: int


class Filter(NamedTuple):
    """Which events to list."""

    start: datetime | None = None
    end: datetime | None = None
    kind: str | None = None


_kept = sa.exists().where(
    raw_chunks.c.session_pk == motion_events.c.session_pk, raw_chunks.c.seq == motion_events.c.seq
)
_select = (
    sa.select(
        *(motion_events.c[name] for name in ("pk", "kind", "t", "at", "data")), sessions.c.name, _kept.label("kept")
    )
    .join_from(motion_events, sessions, sessions.c.pk == motion_events.c.session_pk)
    .where(motion_events.c.device_pk == sa.bindparam("device_pk"))
)
_find = _select.where(motion_events.c.pk == sa.bindparam("pk"))
_add = sa.insert(motion_events).returning(motion_events.c.pk)
_moment = sa.type_coerce(motion_events.c.at, sa.BigInteger)
_move = Prepared(
    sa.update(motion_events)
    .where(motion_events.c.session_pk == sa.bindparam("of_session_pk"))
    .values(at=sa.type_coerce(_moment - sa.bindparam("earlier", type_=sa.BigInteger), Instant))
)


def add(
    tx: WriteSession,
    device_pk: int,
    chunk: tuple[int, int],
    kind: str,
    t: float,
    at: datetime,
    data: dict[str, Any],
) -> int:
    """Store an event found in a chunk (session, number); give its number."""
    session_pk, seq = chunk
    values = {"device_pk": device_pk, "session_pk": session_pk, "seq": seq, "kind": kind, "t": t, "at": at}
    return int(tx.execute(_add, **values, data=data).scalar_one())


def move(tx: WriteSession, session_pk: int, earlier: timedelta) -> None:
    """Let the events of a session be earlier: it is now known to have begun so."""
    tx.run(_move, of_session_pk=session_pk, earlier=earlier // MICROSECOND)


def find(tx: ReadSession, device_pk: int, pk: int) -> MotionEvent | None:
    """Find an event of a device."""
    return tx.one(MotionEvent, _find, device_pk=device_pk, pk=pk)


def page(tx: ReadSession, device_pk: int, limit: int, before: Place | None, wanted: Filter) -> list[MotionEvent]:
    """Give up to `limit` events of a device, newest first, from before a place in that order."""
    compare: dict[str, Callable[[Any], sa.ColumnElement[bool]]] = {
        "start": motion_events.c.at.__ge__,
        "end": motion_events.c.at.__le__,
        "kind": motion_events.c.kind.__eq__,
    }
    chosen = [compare[name](value) for name, value in wanted._asdict().items() if value is not None]
    if before is not None:
        place = sa.tuple_(sa.literal(before.at, Instant), sa.literal(before.pk, sa.BigInteger))
        chosen.append(sa.tuple_(motion_events.c.at, motion_events.c.pk) < place)
    order = motion_events.c.at.desc(), motion_events.c.pk.desc()
    return tx.all(MotionEvent, _select.where(*chosen).order_by(*order).limit(limit), device_pk=device_pk)
