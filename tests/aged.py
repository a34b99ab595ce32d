"""Devices with a long past, written straight into the tables: a year of driving would take a year to upload."""

from collections.abc import Iterator
from datetime import datetime, timedelta
from typing import Any

import numpy as np
import sqlalchemy as sa

from api.services.history_rows import ROW
from storage.database import Database, WriteSession
from storage.models import estimates, sessions

CHUNK = 60.0
"""s"""
ROWS_OF_CHUNK = 12
CONFIRMED = 4


def chunk_rows(start: float, stage: int = CONFIRMED) -> bytes:
    """Rows of a chunk that begins at `start` on the session's clock."""
    rows = np.zeros(ROWS_OF_CHUNK, ROW)
    rows["t"] = start + np.arange(ROWS_OF_CHUNK) * (CHUNK / ROWS_OF_CHUNK)
    angle = 0.1 * np.sin(rows["t"] / 1e4)
    rows["quaternion"][:, 0], rows["quaternion"][:, 3] = np.cos(angle / 2), np.sin(angle / 2)
    rows["sigma"], rows["progress"], rows["stage"] = 0.01, 1.0, stage
    rows["stable"] = rows["reliable"] = 1
    return rows.tobytes()


def add_session(tx: WriteSession, device_pk: int, started_at: datetime, hours: float) -> int:
    """Store a session and its fine history; give its number."""
    added = {"device_pk": device_pk, "name": started_at.isoformat(), "next_seq": 0, "created_at": started_at}
    session_pk = tx.execute(sa.insert(sessions).returning(sessions.c.pk), **added, started_at=started_at).scalar_one()
    blocks = [_block(device_pk, session_pk, started_at, n * CHUNK) for n in range(int(hours * 3600 / CHUNK))]
    if blocks:
        tx.connection.execute(sa.insert(estimates), blocks)
    return int(session_pk)


def _block(device_pk: int, session_pk: int, started_at: datetime, start: float) -> dict[str, Any]:
    return {
        "device_pk": device_pk,
        "session_pk": session_pk,
        "t_first": start,
        "t_last": start + CHUNK * (1.0 - 1.0 / ROWS_OF_CHUNK),
        "size": ROWS_OF_CHUNK,
        "changes": 0,
        "rows": chunk_rows(start),
        "received_at": started_at + timedelta(seconds=start + CHUNK),
    }


def days(end: datetime, number: int) -> Iterator[datetime]:
    """Give the moments so many days before `end`, oldest first, a day apart."""
    return (end - timedelta(days=n) for n in range(number, 0, -1))


def add_past(database: Database, device_pk: int, end: datetime, number: int, per_day: int, hours: float) -> None:
    """Store days of fine history, each of `per_day` sessions of so many hours."""
    for day in days(end, number):
        with database.write() as tx:
            for n in range(per_day):
                add_session(tx, device_pk, day + timedelta(days=n / per_day), hours)
