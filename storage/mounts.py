"""Confirmed mountings. A device has at most one that is not superseded: the one in force, or suspect."""

from datetime import datetime
from typing import Any, NamedTuple

import sqlalchemy as sa

from storage.database import ReadSession, WriteSession
from storage.models import mounts, sessions

IN_FORCE, SUSPECT, SUPERSEDED = "in_force", "suspect", "superseded"


class Mount(NamedTuple):
    """A confirmed mounting; `t` on the clock of the session that started at `started_at`."""

    n: int
    t: float
    started_at: datetime
    quaternion: list[float]
    sigma_deg: list[float]
    verification: dict[str, Any]
    status: str


_select = sa.select(
    mounts.c.n,
    mounts.c.t,
    sessions.c.started_at,
    mounts.c.quaternion,
    mounts.c.sigma_deg,
    mounts.c.verification,
    mounts.c.status,
).join_from(mounts, sessions)


def add(
    tx: WriteSession,
    device_pk: int,
    session_pk: int,
    t: float,
    quaternion: list[float],
    sigma_deg: list[float],
    verification: dict[str, Any],
) -> int:
    """Put a new mounting in force, in the place of the former one; give its number."""
    supersede(tx, device_pk)
    last = tx.value(sa.select(sa.func.max(mounts.c.n)).where(mounts.c.device_pk == device_pk))
    n = (last or 0) + 1
    tx.execute(
        sa.insert(mounts).values(
            device_pk=device_pk,
            n=n,
            session_pk=session_pk,
            t=t,
            quaternion=quaternion,
            sigma_deg=sigma_deg,
            verification=verification,
            status=IN_FORCE,
        )
    )
    return n


def supersede(tx: WriteSession, device_pk: int) -> None:
    """The current mounting holds no longer."""
    _set_status(tx, device_pk, SUPERSEDED)


def suspect(tx: WriteSession, device_pk: int) -> None:
    """The current mounting is in doubt."""
    _set_status(tx, device_pk, SUSPECT)


def _set_status(tx: WriteSession, device_pk: int, status: str) -> None:
    current = (mounts.c.device_pk == device_pk) & (mounts.c.status != SUPERSEDED)
    tx.execute(sa.update(mounts).where(current).values(status=status))


def current(tx: ReadSession, device_pk: int) -> Mount | None:
    """Give the mounting in force, or the suspect one."""
    return tx.one(Mount, _select.where(mounts.c.device_pk == device_pk, mounts.c.status != SUPERSEDED))


def find(tx: ReadSession, device_pk: int, n: int) -> Mount | None:
    """Give mounting number `n` of a device."""
    return tx.one(Mount, _select.where(mounts.c.device_pk == device_pk, mounts.c.n == n))


def page(tx: ReadSession, device_pk: int, limit: int, before: int | None = None) -> list[Mount]:
    """Give up to `limit` mountings, newest first, from before number `before`."""
    statement = _select.where(mounts.c.device_pk == device_pk).order_by(mounts.c.n.desc()).limit(limit)
    return tx.all(Mount, statement if before is None else statement.where(mounts.c.n < before))
