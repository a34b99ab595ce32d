"""Fine angle history: a block of rows per chunk, packed (bytes to us): a chunk is one insert, a chart few reads.

Blocks are found by device and arrival, whatever the number of sessions. A block arrives after its rows were taken, by
whatever clock: `sessions.started_at` is made so. So those of a period are among those that arrived after it began.
"""

from collections.abc import Sequence
from datetime import datetime
from typing import Any, NamedTuple

import sqlalchemy as sa

from storage.database import ReadSession, WriteSession
from storage.models import Instant, estimates, microseconds, sessions


class Mark(NamedTuple):
    """What is known of a block without reading it."""

    pk: int
    session_pk: int
    t_first: float
    t_last: float
    size: int
    """rows"""
    changes: int
    """rows whose stage differs from that of the row before"""


class Block(NamedTuple):
    """A block of history, with the session that tells its time."""

    session: str
    started_at: datetime
    rows: bytes


class OldBlock(NamedTuple):
    """A block that is to become coarse."""

    pk: int
    session_pk: int
    started_at: datetime
    rows: bytes


SLACK = 1_000_000
"""us added to a period when blocks are looked for, so that rounding loses none"""

_received_at = estimates.c.received_at
_before = sa.bindparam("before", type_=Instant)
_blocks_of = sessions.c.pk == estimates.c.session_pk
_add = sa.insert(estimates)
_marks = (
    sa.select(*(estimates.c[name] for name in Mark._fields))
    .join_from(estimates, sessions, _blocks_of)
    .where(estimates.c.device_pk == sa.bindparam("device_pk"))
    .order_by(estimates.c.pk)
)
_blocks = (
    sa.select(sessions.c.name, sessions.c.started_at, estimates.c.rows)
    .join_from(estimates, sessions, _blocks_of)
    .where(estimates.c.pk.in_(sa.bindparam("pks", expanding=True)))
    .order_by(estimates.c.pk)
)
_device_of_oldest = sa.select(estimates.c.device_pk).where(_received_at < _before).order_by(_received_at).limit(1)
_old_blocks = (
    sa.select(estimates.c.pk, estimates.c.session_pk, sessions.c.started_at, estimates.c.rows)
    .join_from(estimates, sessions, _blocks_of)
    .where(estimates.c.device_pk == sa.bindparam("device_pk"), _received_at < _before)
    .order_by(_received_at, estimates.c.pk)
    .limit(sa.bindparam("limit"))
    .with_for_update(of=estimates)
)
_remove = sa.delete(estimates).where(estimates.c.pk.in_(sa.bindparam("pks", expanding=True)))


def add(
    tx: WriteSession,
    device_pk: int,
    session_pk: int,
    t: tuple[float, float],
    mark: tuple[int, int],
    rows: bytes,
    now: datetime,
) -> None:
    """Append a block: `t` its first and last time on the session's clock, `mark` its rows and stage changes."""
    tx.execute(
        _add,
        device_pk=device_pk,
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
    """Give the marks of the blocks that overlap [start, end], and perhaps their neighbours, as they came in."""
    statement = _marks
    if start is not None:
        from_us = microseconds(start) - SLACK
        statement = statement.where(
            sa.type_coerce(_received_at, sa.BigInteger) >= from_us, _utc(estimates.c.t_last) >= from_us
        )
    if end is not None:
        statement = statement.where(_utc(estimates.c.t_first) <= microseconds(end) + SLACK)
    return tx.all(Mark, statement, device_pk=device_pk)


def blocks(tx: ReadSession, pks: Sequence[int], batch: int = 500) -> list[Block]:
    """Give the blocks with these numbers, in that order."""
    batches = (pks[i : i + batch] for i in range(0, len(pks), batch))
    return [block for part in batches for block in tx.all(Block, _blocks, pks=part)]


def device_of_oldest(tx: ReadSession, before: datetime) -> int | None:
    """Give the device of the oldest block that came in before a moment."""
    found: int | None = tx.value(_device_of_oldest, before=before)
    return found


def old_blocks(tx: WriteSession, device_pk: int, before: datetime, limit: int) -> list[OldBlock]:
    """Give up to `limit` blocks of a device that came in before a moment, oldest first, for this transaction alone."""
    return tx.all(OldBlock, _old_blocks, device_pk=device_pk, before=before, limit=limit)


def remove(tx: WriteSession, pks: Sequence[int]) -> None:
    """Remove the blocks with these numbers."""
    tx.execute(_remove, pks=pks)
