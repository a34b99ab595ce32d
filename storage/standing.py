"""What an upload has to know of its device beside the installation, read at once: each look is a way to the server."""

from datetime import datetime
from typing import Any, NamedTuple, Self

import sqlalchemy as sa

from storage.database import ReadSession
from storage.installations import Beside
from storage.models import (
    alert_unresolved,
    alerts,
    chunk_waits,
    chunks,
    devices,
    installations,
    mount_current,
    mounts,
    sessions,
)
from storage.mounts import COLUMNS as MOUNT_COLUMNS
from storage.mounts import Mount
from storage.prepared import Prepared
from storage.sessions import Session


class Standing(NamedTuple):
    """Where a device stands."""

    session: Session | None
    """the one with the name that was asked for; None: it is new"""
    waits: bool
    """True when any chunk waits in the current session or a later one"""
    since_started_at: datetime | None
    """zero of the clock of the session in which the stage began"""
    open_alerts: int
    mount: Mount | None
    """the one in force, or the suspect one"""
    mount_session_pk: int | None
    """the session whose clock tells when that was confirmed"""

    def as_begun(self, session: Session) -> Self:
        """Give what it is when it is known better when its session began."""
        mount = self.mount
        if mount is not None and session.started_at is not None and self.mount_session_pk == session.pk:
            mount = mount._replace(started_at=session.started_at)
        return self._replace(session=session, mount=mount)

    def beside(self, since_session_pk: int | None) -> Beside:
        """Give what is shown with the installation, whose stage began in the session that it did, or in this one."""
        since = self.since_started_at if since_session_pk is not None else None
        if self.session is not None and since_session_pk == self.session.pk:
            since = self.session.started_at
        return Beside(since, self.open_alerts, self.mount)


_named, _since, _of_mount, _other = (sessions.alias(name) for name in ("named", "since", "of_mount", "other"))
_mount = [_of_mount.c.started_at if column.table is sessions else column for column in MOUNT_COLUMNS]
_waits = sa.exists().where(
    _other.c.device_pk == installations.c.device_pk,
    _other.c.pk >= sa.func.coalesce(installations.c.session_pk, 0),
    sa.exists().where(chunks.c.session_pk == _other.c.pk, chunk_waits),
)
_find = Prepared(
    sa.select(
        *(_named.c[name] for name in Session._fields),
        _waits.label("waits"),
        _since.c.started_at.label("since_started_at"),
        sa.select(sa.func.count()).where(alerts.c.device_id == devices.c.id, alert_unresolved).scalar_subquery(),
        mounts.c.session_pk.label("mount_session_pk"),
        *_mount,
    )
    .select_from(
        devices.join(installations, installations.c.device_pk == devices.c.pk)
        .outerjoin(_named, (_named.c.device_pk == devices.c.pk) & (_named.c.name == sa.bindparam("session")))
        .outerjoin(_since, _since.c.pk == installations.c.since_session_pk)
        .outerjoin(mounts, (mounts.c.device_pk == devices.c.pk) & mount_current)
        .outerjoin(_of_mount, _of_mount.c.pk == mounts.c.session_pk)
    )
    .where(devices.c.pk == sa.bindparam("of_device_pk"))
)
_SESSION = len(Session._fields)


def find(tx: ReadSession, device_pk: int, session: str) -> Standing | None:
    """Find where a device stands; `session` is the name of one of its sessions."""
    return tx.one(_standing, _find, of_device_pk=device_pk, session=session)


def _standing(*row: Any) -> Standing:
    session, (waits, since_started_at, open_alerts, mount_session_pk, *mount) = row[:_SESSION], row[_SESSION:]
    return Standing(
        None if session[0] is None else Session(*session),
        bool(waits),
        since_started_at,
        open_alerts,
        None if mount_session_pk is None else Mount(*mount),
        mount_session_pk,
    )
