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
from storage.prepared import Prepared


class Extent(NamedTuple):
    """How much there is in a period."""

    seconds: float
    """of device time"""
    rows: int


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


Period = tuple[datetime | None, datetime | None]
"""First and last moment, None: open."""
SLACK = 1_000_000
"""us added to a period when blocks are looked for, so that rounding loses none"""
EVER = 2**62
"""us, longer ago and later than anything"""


def _utc(column: sa.ColumnElement[float]) -> sa.ColumnElement[Any]:
    """Time of a column on the session's clock, us since 1970."""
    return sa.type_coerce(sessions.c.started_at, sa.BigInteger) + column * 1e6


_received_at = estimates.c.received_at
_before = sa.bindparam("before", type_=Instant)
_of_session = (sessions.c.pk == estimates.c.session_pk) & (sessions.c.device_pk == estimates.c.device_pk)
"""The second part says nothing new, but PostgreSQL then looks among the sessions of a device, not among all."""
_start, _end = (sa.bindparam(name, type_=sa.BigInteger) for name in ("start", "end"))
_in_period = (
    estimates.c.device_pk == sa.bindparam("device_pk"),
    sa.type_coerce(_received_at, sa.BigInteger) >= _start,
    _utc(estimates.c.t_last) >= _start,
    _utc(estimates.c.t_first) <= _end,
)
_add = Prepared(sa.insert(estimates))
_extent = (
    sa.select(
        sa.func.coalesce(sa.func.sum(estimates.c.t_last - estimates.c.t_first), 0.0),
        sa.func.coalesce(sa.func.sum(estimates.c.size), 0),
    )
    .join_from(estimates, sessions, _of_session)
    .where(*_in_period)
)
_pks = sa.select(estimates.c.pk).join_from(estimates, sessions, _of_session).where(*_in_period)
_slot = sa.cast(estimates.c.t_first / sa.bindparam("spacing", type_=sa.Double), sa.BigInteger)
_chosen = sa.union(
    _pks.with_only_columns(sa.func.min(estimates.c.pk)).group_by(estimates.c.session_pk, _slot),
    _pks.with_only_columns(sa.func.max(estimates.c.pk)),
    _pks.where(estimates.c.changes > 0),
)
_all_blocks = (
    sa.select(sessions.c.name, sessions.c.started_at, estimates.c.rows)
    .join_from(estimates, sessions, _of_session)
    .where(*_in_period)
    .order_by(estimates.c.pk)
)
_some_blocks = (
    sa.select(sessions.c.name, sessions.c.started_at, estimates.c.rows)
    .join_from(estimates, sessions, _of_session)
    .where(estimates.c.pk.in_(_chosen))
    .order_by(estimates.c.pk)
)
_device_of_oldest = sa.select(estimates.c.device_pk).where(_received_at < _before).order_by(_received_at).limit(1)
_old_blocks = (
    sa.select(estimates.c.pk, estimates.c.session_pk, sessions.c.started_at, estimates.c.rows)
    .join_from(estimates, sessions, _of_session)
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
    tx.run(
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


def _values(period: Period) -> dict[str, int]:
    start, end = period
    return {
        "start": -EVER if start is None else microseconds(start) - SLACK,
        "end": EVER if end is None else microseconds(end) + SLACK,
    }


def extent(tx: ReadSession, device_pk: int, period: Period) -> Extent:
    """Tell how much there is in the blocks that overlap a period."""
    return tx.one(Extent, _extent, device_pk=device_pk, **_values(period)) or Extent(0.0, 0)


def blocks(tx: ReadSession, device_pk: int, period: Period, spacing: float | None) -> list[Block]:
    """Give the blocks that overlap a period, as they came in.

    With a spacing, s: one in each slot of so many seconds, those in which the stage changes, and the last.
    """
    values = {"device_pk": device_pk, **_values(period)}
    if spacing is None:
        return tx.all(Block, _all_blocks, **values)
    return tx.all(Block, _some_blocks, **values, spacing=spacing)


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
