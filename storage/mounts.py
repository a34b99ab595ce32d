"""Confirmed mountings. A device has at most one that is not superseded: the one in force, or suspect."""

from datetime import datetime
from typing import Any, NamedTuple

import sqlalchemy as sa

from storage.database import ReadSession, WriteSession
from storage.models import Instant, microseconds, mount_current, mount_suspect, mounts, sessions
from storage.prepared import Prepared

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
    ended_at: datetime | None
    """since when it was in doubt, or superseded; None: it is in force, or that was not recorded yet"""

    @property
    def in_force(self) -> bool:
        """True while nothing speaks against it."""
        return self.status == IN_FORCE


COLUMNS = [sessions.c.started_at if name == "started_at" else mounts.c[name] for name in Mount._fields]
"""of a mounting with its session"""
_select = sa.select(*COLUMNS).join_from(mounts, sessions)
_current = (mounts.c.device_pk == sa.bindparam("of_device_pk")) & mount_current
_find_current = Prepared(_select.where(_current))
_of_device = _select.where(mounts.c.device_pk == sa.bindparam("device_pk"))
_find = _of_device.where(mounts.c.n == sa.bindparam("n"))
_page = _of_device.order_by(mounts.c.n.desc()).limit(sa.bindparam("limit"))
_last = sa.select(sa.func.max(mounts.c.n)).where(mounts.c.device_pk == sa.bindparam("device_pk"))
_suspects = sa.select(sa.func.count()).select_from(mounts).where(mount_suspect)
_add = sa.insert(mounts)
_at = sa.bindparam("at", type_=Instant)
_set_status = sa.update(mounts).where(_current).values(ended_at=sa.func.coalesce(mounts.c.ended_at, _at))
_confirmed_at = sa.type_coerce(sessions.c.started_at, sa.BigInteger) + mounts.c.t * 1e6
_before = (
    _of_device.where(_confirmed_at < sa.bindparam("end", type_=sa.BigInteger)).order_by(mounts.c.n.desc()).limit(1)
)


def add(
    tx: WriteSession,
    device_pk: int,
    session_pk: int,
    t: float,
    quaternion: list[float],
    sigma_deg: list[float],
    verification: dict[str, Any],
    at: datetime,
) -> int:
    """Put a new mounting in force, in the place of the former one; give its number. `at`: when it was confirmed."""
    supersede(tx, device_pk, at)
    n = (tx.value(_last, device_pk=device_pk) or 0) + 1
    tx.execute(
        _add,
        device_pk=device_pk,
        n=n,
        session_pk=session_pk,
        t=t,
        quaternion=quaternion,
        sigma_deg=sigma_deg,
        verification=verification,
        status=IN_FORCE,
    )
    return n


def supersede(tx: WriteSession, device_pk: int, at: datetime) -> None:
    """The current mounting holds no longer."""
    tx.execute(_set_status, of_device_pk=device_pk, status=SUPERSEDED, at=at)


def suspect(tx: WriteSession, device_pk: int, at: datetime) -> None:
    """The current mounting is in doubt."""
    tx.execute(_set_status, of_device_pk=device_pk, status=SUSPECT, at=at)


def suspects(tx: ReadSession, device_pk: int | None = None) -> int:
    """Count devices whose current mounting is in doubt, all of them or only one."""
    return int(tx.value(_suspects if device_pk is None else _suspects.where(mounts.c.device_pk == device_pk)))


def current(tx: ReadSession, device_pk: int) -> Mount | None:
    """Give the mounting in force, or the suspect one."""
    return tx.one(Mount, _find_current, of_device_pk=device_pk)


def before(tx: ReadSession, device_pk: int, end: datetime) -> Mount | None:
    """Give the newest mounting that was confirmed before a moment."""
    return tx.one(Mount, _before, device_pk=device_pk, end=microseconds(end))


def find(tx: ReadSession, device_pk: int, n: int) -> Mount | None:
    """Give mounting number `n` of a device."""
    return tx.one(Mount, _find, device_pk=device_pk, n=n)


def page(tx: ReadSession, device_pk: int, limit: int, before: int | None = None) -> list[Mount]:
    """Give up to `limit` mountings, newest first, from before number `before`."""
    statement = _page if before is None else _page.where(mounts.c.n < before)
    return tx.all(Mount, statement, device_pk=device_pk, limit=limit)
