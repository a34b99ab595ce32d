"""Receipts of chunks. A receipt stays, so that a repeated chunk is recognised; the bytes stay only while waiting."""

from datetime import datetime
from typing import NamedTuple

import sqlalchemy as sa

from storage.database import ReadSession, WriteSession
from storage.models import chunk_waits, chunks, devices, sessions

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


_receipt = sa.select(*(chunks.c[name] for name in Receipt._fields))
_body = sa.select(*(chunks.c[name] for name in Body._fields))


def find(tx: ReadSession, session_pk: int, seq: int) -> Receipt | None:
    """Find the receipt of a chunk."""
    return tx.one(Receipt, _receipt.where(chunks.c.session_pk == session_pk, chunks.c.seq == seq))


def find_waiting(tx: ReadSession, session_pk: int, seq: int) -> tuple[Receipt, Body]:
    """Give a waiting chunk with its bytes."""
    row = tx.connection.execute(
        _receipt.add_columns(*_body.selected_columns).where(chunks.c.session_pk == session_pk, chunks.c.seq == seq)
    ).one()
    width = len(Receipt._fields)
    return Receipt(*row[:width]), Body(*row[width:])


def add(tx: WriteSession, receipt: Receipt, body: Body | None = None) -> None:
    """Store a receipt, with the bytes when the chunk has to wait."""
    bytes_sent = {} if body is None else body._asdict()
    tx.execute(sa.insert(chunks).values(**receipt._asdict(), **bytes_sent))


def settle(tx: WriteSession, receipt: Receipt) -> None:
    """Store what became of a waiting chunk and drop its bytes."""
    tx.execute(
        sa.update(chunks)
        .where(chunks.c.session_pk == receipt.session_pk, chunks.c.seq == receipt.seq)
        .values(**receipt._asdict(), **dict.fromkeys(Body._fields))
    )


def waiting(tx: ReadSession, session_pk: int) -> Waiting:
    """Tell what waits in a session."""
    statement = sa.select(sa.func.count(), sa.func.min(chunks.c.seq), sa.func.min(chunks.c.received_at))
    found = tx.one(Waiting, statement.where(chunks.c.session_pk == session_pk, chunk_waits))
    return found or Waiting(0, None, None)


def sessions_waiting(tx: ReadSession, device_pk: int) -> list[int]:
    """Give the sessions of a device that have waiting chunks, in the order in which they began."""
    statement = (
        sa.select(sessions.c.pk)
        .where(
            sessions.c.device_pk == device_pk,
            sa.exists().where(chunks.c.session_pk == sessions.c.pk, chunk_waits),
        )
        .order_by(sessions.c.pk)
    )
    return tx.all(int, statement)


def devices_waiting_since(tx: ReadSession, moment: datetime) -> list[str]:
    """Give the ids of the devices that have a chunk waiting since before `moment`."""
    statement = (
        sa.select(devices.c.id)
        .distinct()
        .join_from(chunks, sessions)
        .join(devices)
        .where(chunk_waits, chunks.c.received_at <= moment)
    )
    return tx.all(str, statement)


def forget(tx: WriteSession, before: datetime) -> int:
    """Remove the receipts of chunks that came in before a moment and were settled."""
    return tx.execute(sa.delete(chunks).where(chunks.c.received_at < before, chunks.c.state == APPLIED)).rowcount
