"""Receipts of chunks. A receipt stays, so that a repeated chunk is recognised; the bytes stay only while waiting."""

from collections.abc import Sequence
from datetime import datetime
from typing import NamedTuple

import sqlalchemy as sa

from storage.database import ReadSession, WriteSession
from storage.models import Instant, chunk_waits, chunks, devices, sessions
from storage.prepared import Prepared

APPLIED, WAITING = "applied", "waiting"


class Receipt(NamedTuple):
    """A chunk that was taken in."""

    session_pk: int
    seq: int
    digest: str
    state: str
    samples: int
    fixes: int
    rejected: dict[str, int]
    received_at: datetime
    t_first: float | None
    """s on the session's clock; None of a chunk without samples, and of those from before it was kept"""
    t_last: float | None


class Body(NamedTuple):
    """The bytes of a waiting chunk, as they were sent."""

    body: bytes
    content_type: str
    content_encoding: str | None
    course: str


class Waiting(NamedTuple):
    """What waits in a session."""

    number: int
    first_seq: int | None
    since: datetime | None


_receipt = [chunks.c[name] for name in Receipt._fields]
_body = [chunks.c[name] for name in Body._fields]
_this = (chunks.c.session_pk == sa.bindparam("of_session_pk")) & (chunks.c.seq == sa.bindparam("of_seq"))
_find = Prepared(sa.select(*_receipt).where(_this))
_find_waiting = sa.select(*_receipt, *_body).where(_this)
_newest = Prepared(
    sa.select(*_receipt)
    .where(chunks.c.session_pk == sa.bindparam("of_session_pk"), chunks.c.seq < sa.bindparam("before"))
    .order_by(chunks.c.seq.desc())
    .limit(sa.bindparam("limit"))
)
_add = Prepared(sa.insert(chunks))
_settle = sa.update(chunks).where(_this)
_waiting = sa.select(sa.func.count(), sa.func.min(chunks.c.seq), sa.func.min(chunks.c.received_at)).where(
    chunks.c.session_pk == sa.bindparam("session_pk"), chunk_waits
)
_bring_back = (
    sa.update(chunks)
    .where(
        chunks.c.session_pk.in_(sa.bindparam("session_pks", expanding=True)),
        chunk_waits,
        chunks.c.received_at > sa.bindparam("now", type_=Instant),
    )
    .values(received_at=sa.bindparam("now", type_=Instant))
)
_sessions_waiting = Prepared(
    sa.select(sessions.c.pk)
    .where(
        sessions.c.device_pk == sa.bindparam("device_pk"),
        sessions.c.pk >= sa.bindparam("current"),
        sa.exists().where(chunks.c.session_pk == sessions.c.pk, chunk_waits),
    )
    .order_by(sessions.c.pk)
)
_came_in = sa.type_coerce(chunks.c.received_at, sa.BigInteger) + 0
"""Written so that SQLite looks among what waits, not among all receipts that are as old."""
_devices_waiting = (
    sa.select(devices.c.id)
    .distinct()
    .join_from(chunks, sessions)
    .join(devices)
    .where(
        chunk_waits,
        sa.or_(_came_in <= sa.bindparam("moment", type_=Instant), _came_in > sa.bindparam("now", type_=Instant)),
    )
)


def find(tx: ReadSession, session_pk: int, seq: int) -> Receipt | None:
    """Find the receipt of a chunk."""
    return tx.one(Receipt, _find, of_session_pk=session_pk, of_seq=seq)


def newest(tx: ReadSession, session_pk: int, before: int, limit: int) -> list[Receipt]:
    """Give up to `limit` receipts of a session, the highest number first, from before number `before`."""
    return tx.all(Receipt, _newest, of_session_pk=session_pk, before=before, limit=limit)


def find_waiting(tx: ReadSession, session_pk: int, seq: int) -> tuple[Receipt, Body]:
    """Give a waiting chunk with its bytes."""
    row = tx.connection.execute(_find_waiting, {"of_session_pk": session_pk, "of_seq": seq}).one()
    return Receipt(*row[: len(_receipt)]), Body(*row[len(_receipt) :])


def add(tx: WriteSession, receipt: Receipt, body: Body | None = None) -> None:
    """Store a receipt, with the bytes when the chunk has to wait."""
    tx.run(_add, **receipt._asdict(), **({} if body is None else body._asdict()))


def settle(tx: WriteSession, receipt: Receipt) -> None:
    """Store what became of a waiting chunk and drop its bytes."""
    values = receipt._asdict() | dict.fromkeys(Body._fields)
    tx.execute(_settle, of_session_pk=values.pop("session_pk"), of_seq=values.pop("seq"), **values)


def waiting(tx: ReadSession, session_pk: int) -> Waiting:
    """Tell what waits in a session."""
    return Waiting(*tx.connection.execute(_waiting, {"session_pk": session_pk}).one())


def sessions_waiting(tx: ReadSession, device_pk: int, current: int | None) -> list[int]:
    """Give the sessions of a device that have waiting chunks, in the order in which they began.

    Nothing waits in sessions before the current one: however many there are, they are not looked at.
    """
    return tx.all(int, _sessions_waiting, device_pk=device_pk, current=current or 0)


def bring_back(tx: WriteSession, session_pks: Sequence[int], now: datetime) -> None:
    """Let chunks that came in later than now, by a clock that was set back since, have come in now."""
    tx.execute(_bring_back, session_pks=session_pks, now=now)


def devices_waiting_since(tx: ReadSession, moment: datetime, now: datetime) -> list[str]:
    """Give the ids of the devices that have a chunk waiting since `moment` or longer, or from later than now."""
    return tx.all(str, _devices_waiting, moment=moment, now=now)
