"""Samples as devices sent them, packed (bytes to us), a row for each applied chunk.

Found like the angle history: by device and arrival, which is after the samples were taken. They go after some days,
but for those around an impact, which are marked as kept when their time has come.
"""

from datetime import datetime
from itertools import groupby
from typing import Any, NamedTuple

import sqlalchemy as sa

from storage.database import ReadSession, WriteSession
from storage.models import (
    EPOCH,
    MICROSECOND,
    Instant,
    microseconds,
    motion_events,
    raw_chunks,
    raw_may_go,
    sessions,
)
from storage.motion_events import IMPACT
from storage.prepared import Prepared


class RawChunk(NamedTuple):
    """A chunk's samples."""

    session_pk: int
    seq: int
    device_pk: int
    t_first: float
    """s on the session's clock"""
    t_last: float
    received_at: datetime
    columns: str
    """names of the columns, a blank between them"""
    content: bytes


class Piece(NamedTuple):
    """A chunk without its samples."""

    seq: int
    t_first: float
    t_last: float
    columns: str


class Stretch(NamedTuple):
    """Chunks of a session that overlap a period."""

    session_pk: int
    session: str
    started_at: datetime
    pieces: tuple[Piece, ...]

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the columns that any of them has."""
        return tuple(dict.fromkeys(name for piece in self.pieces for name in piece.columns.split()))


SLACK = 1_000_000
"""us added to a period when chunks are looked for, so that rounding loses none"""
EVER = 2**62
"""us, longer ago and later than anything"""


def _utc(t: sa.ColumnElement[float]) -> sa.ColumnElement[float]:
    """Time of a column on the session's clock, us since 1970."""
    zero: sa.ColumnElement[float] = sa.type_coerce(sessions.c.started_at, sa.BigInteger)
    return zero + t * 1e6


_of_device = raw_chunks.c.device_pk == sa.bindparam("device_pk")
_of_session = (sessions.c.pk == raw_chunks.c.session_pk) & (sessions.c.device_pk == raw_chunks.c.device_pk)
_start, _end = (sa.bindparam(name, type_=sa.BigInteger) for name in ("start", "end"))
_overlapping = (
    sa.select(sessions.c.pk, sessions.c.name, sessions.c.started_at, *(raw_chunks.c[name] for name in Piece._fields))
    .join_from(raw_chunks, sessions, _of_session)
    .where(
        _of_device,
        sa.type_coerce(raw_chunks.c.received_at, sa.BigInteger) >= _start,
        _utc(raw_chunks.c.t_last) >= _start,
        _utc(raw_chunks.c.t_first) <= _end,
    )
    .order_by(sessions.c.pk, raw_chunks.c.seq)
)
_newest = (
    sa.select(_utc(raw_chunks.c.t_last))
    .join_from(raw_chunks, sessions, _of_session)
    .where(_of_device)
    .order_by(raw_chunks.c.received_at.desc())
    .limit(1)
)
_content = sa.select(raw_chunks.c.content).where(
    raw_chunks.c.session_pk == sa.bindparam("session_pk"), raw_chunks.c.seq == sa.bindparam("seq")
)
_add = Prepared(sa.insert(raw_chunks))
_key = tuple(raw_chunks.primary_key)
_old = (
    sa.select(*_key)
    .where(raw_may_go, raw_chunks.c.received_at < sa.bindparam("before", type_=Instant))
    .order_by(raw_chunks.c.received_at)
    .limit(sa.bindparam("limit"))
)
_near_impact = sa.exists().where(
    motion_events.c.session_pk == raw_chunks.c.session_pk,
    motion_events.c.kind == IMPACT,
    motion_events.c.t >= raw_chunks.c.t_first - sa.bindparam("seconds_after"),
    motion_events.c.t <= raw_chunks.c.t_last + sa.bindparam("seconds_before"),
)
_these = sa.tuple_(*_key).in_(sa.bindparam("keys", expanding=True))
_keep = sa.update(raw_chunks).where(_these, _near_impact).values(kept=True)
_remove = sa.delete(raw_chunks).where(_these, raw_may_go)


def add(tx: WriteSession, chunk: RawChunk) -> None:
    """Keep a chunk's samples."""
    tx.run(_add, **chunk._asdict(), kept=False)


def stretches(tx: ReadSession, device_pk: int, start: datetime | None, end: datetime | None) -> list[Stretch]:
    """Find the chunks of a device that overlap a period, session by session in the order in which these began."""
    values = {
        "device_pk": device_pk,
        "start": -EVER if start is None else microseconds(start) - SLACK,
        "end": EVER if end is None else microseconds(end) + SLACK,
    }
    rows = tx.all(_found, _overlapping, **values)
    grouped = groupby(rows, lambda row: row[0])
    return [Stretch(pk, name, at, tuple(piece for _, piece in found)) for (pk, name, at), found in grouped]


def _found(session_pk: int, session: str, started_at: datetime, *piece: Any) -> tuple[tuple[int, str, datetime], Piece]:
    return (session_pk, session, started_at), Piece(*piece)


def newest(tx: ReadSession, device_pk: int) -> datetime | None:
    """Give the time of the last sample of the chunk that came in last."""
    found: float | None = tx.value(_newest, device_pk=device_pk)
    return None if found is None else EPOCH + found * MICROSECOND


def content(tx: ReadSession, session_pk: int, seq: int) -> bytes | None:
    """Give the samples of a chunk; None when they have gone."""
    found: bytes | None = tx.value(_content, session_pk=session_pk, seq=seq)
    return found


def remove(tx: WriteSession, before: datetime, around: tuple[float, float], limit: int) -> int:
    """Remove chunks that came in before a moment, but for those so many s before or after an impact.

    Give how many were looked at: fewer than the limit are the last.
    """
    keys = [tuple(row) for row in tx.connection.execute(_old, {"before": before, "limit": limit})]
    if keys:
        tx.execute(_keep, keys=keys, seconds_before=around[0], seconds_after=around[1])
        tx.execute(_remove, keys=keys)
    return len(keys)
