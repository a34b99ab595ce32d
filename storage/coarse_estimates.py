"""Coarse angle history: a block of packed rows (bytes to us) for each device, day and session, and a sketch of it.

The day is that of the rows when they became coarse, days since 1970 in UTC; it may be one off, when a session's start
became known better afterwards.
"""

from datetime import datetime
from typing import NamedTuple

import sqlalchemy as sa

from storage.database import ReadSession, WriteSession
from storage.estimates import Block
from storage.models import EPOCH, sessions
from storage.models import estimates_coarse as coarse


class Day(NamedTuple):
    """What happened in a session on a day; times on the session's clock."""

    device_pk: int
    day: int
    session_pk: int
    t_first: float
    t_last: float
    sketch: bytes
    rows: bytes


ALL_DAYS = (-(2**31), 2**31 - 1)

_this = (
    (coarse.c.device_pk == sa.bindparam("of_device_pk"))
    & (coarse.c.day == sa.bindparam("of_day"))
    & (coarse.c.session_pk == sa.bindparam("of_session_pk"))
)
_rows = sa.select(coarse.c.rows).where(_this)
_add = sa.insert(coarse)
_change = sa.update(coarse).where(_this)
_in_period = (
    coarse.c.device_pk == sa.bindparam("device_pk"),
    coarse.c.day.between(sa.bindparam("first_day"), sa.bindparam("last_day")),
)
_seconds = sa.select(sa.func.coalesce(sa.func.sum(coarse.c.t_last - coarse.c.t_first), 0.0)).where(*_in_period)
_sketches, _blocks = (
    sa.select(sessions.c.name, sessions.c.started_at, column)
    .join_from(  # the second part says nothing new, but PostgreSQL then looks among the sessions of a device only
        coarse, sessions, (sessions.c.pk == coarse.c.session_pk) & (sessions.c.device_pk == coarse.c.device_pk)
    )
    .where(*_in_period)
    .order_by(coarse.c.day, coarse.c.session_pk)
    for column in (coarse.c.sketch, coarse.c.rows)
)


def day_of(moment: datetime) -> int:
    """Give the number of a day."""
    return (moment - EPOCH).days


def days(start: datetime | None, end: datetime | None) -> tuple[int, int]:
    """Give the first and the last day on which rows of a period may be found."""
    first = ALL_DAYS[0] if start is None else day_of(start) - 1
    last = ALL_DAYS[1] if end is None else day_of(end) + 1
    return first, last


def rows(tx: ReadSession, device_pk: int, day: int, session_pk: int) -> bytes:
    """Give the rows of a session on a day, none if there are none."""
    return tx.value(_rows, of_device_pk=device_pk, of_day=day, of_session_pk=session_pk) or b""


def put(tx: WriteSession, day: Day) -> None:
    """Store a day, in the place of what is known of it."""
    this = {"of_device_pk": day.device_pk, "of_day": day.day, "of_session_pk": day.session_pk}
    values = {name: getattr(day, name) for name in ("t_first", "t_last", "sketch", "rows")}
    if tx.execute(_change, **this, **values).rowcount == 0:
        tx.execute(_add, **day._asdict())


def seconds(tx: ReadSession, device_pk: int, period: tuple[int, int]) -> float:
    """Give how long the sessions of these days were."""
    return float(tx.value(_seconds, device_pk=device_pk, first_day=period[0], last_day=period[1]))


def blocks(tx: ReadSession, device_pk: int, period: tuple[int, int], sketch: bool) -> list[Block]:
    """Give the history of these days, or a sketch of it."""
    statement = _sketches if sketch else _blocks
    return tx.all(Block, statement, device_pk=device_pk, first_day=period[0], last_day=period[1])
