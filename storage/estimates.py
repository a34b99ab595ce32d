"""Angle history: a block of rows per chunk, packed (bytes to us): a chunk is one insert, a chart few reads."""

from collections.abc import Sequence
from datetime import datetime
from typing import Any, NamedTuple

import sqlalchemy as sa

from storage.database import ReadSession, WriteSession
from storage.models import estimates, microseconds, sessions
from storage.prepared import Prepared


class Mark(NamedTuple):
    """What is known of a block without reading it."""

    pk: int
    size: int
    """rows"""
    changes: int
    """rows whose stage differs from that of the row before"""


class Block(NamedTuple):
    """A block of history, with the session that tells its time."""

    session: str
    started_at: datetime
    rows: bytes


_add = Prepared(sa.insert(estimates))
_marks = (
    sa.select(*(estimates.c[name] for name in Mark._fields))
    .join_from(estimates, sessions)
    .where(sessions.c.device_pk == sa.bindparam("device_pk"))
    .order_by(estimates.c.pk)
)
_blocks = (
    sa.select(sessions.c.name, sessions.c.started_at, estimates.c.rows)
    .join_from(estimates, sessions)
    .where(estimates.c.pk.in_(sa.bindparam("pks", expanding=True)))
    .order_by(estimates.c.pk)
)
_forget = sa.delete(estimates).where(estimates.c.received_at < sa.bindparam("before"))

SLACK = 1_000_000
"""us added to a period when blocks are looked for, so that rounding loses none"""


def add(
    tx: WriteSession,
    session_pk: int,
    t: tuple[float, float],
    mark: tuple[int, int],
    rows: bytes,
    now: datetime,
) -> None:
    """Append a block: `t` its first and last time on the session's clock, `mark` its rows and stage changes."""
    tx.run(
        _add,
        session_pk=session_pk,
        t_first=t[0],
        t_last=t[1],
        size=mark[0],
        changes=mark[1],
        rows=rows,
        received_at=now,
    )


def _utc(column: sa.ColumnElement[float]) -> sa.ColumnElement[Any]:
    """Time of a column on the session's clock, us since 1970."""
    return sa.type_coerce(sessions.c.started_at, sa.BigInteger) + column * 1e6


def marks(tx: ReadSession, device_pk: int, start: datetime | None, end: datetime | None) -> list[Mark]:
    """Give the marks of the blocks that overlap [start, end], and perhaps their neighbours, in time order."""
    statement = _marks
    if start is not None:
        statement = statement.where(_utc(estimates.c.t_last) >= microseconds(start) - SLACK)
    if end is not None:
        statement = statement.where(_utc(estimates.c.t_first) <= microseconds(end) + SLACK)
    return tx.all(Mark, statement, device_pk=device_pk)


def blocks(tx: ReadSession, pks: Sequence[int], batch: int = 500) -> list[Block]:
    """Give the blocks with these numbers, in that order of time."""
    batches = (pks[i : i + batch] for i in range(0, len(pks), batch))
    return [block for part in batches for block in tx.all(Block, _blocks, pks=part)]


def forget(tx: WriteSession, before: datetime) -> int:
    """Remove the blocks that came in before a moment."""
    return tx.execute(_forget, before=before).rowcount
