"""Where the installation of each device stands: the estimator's snapshot (bytes to us) and what is shown of it.

The row is also the lock under which everything of one device is changed.
"""

from datetime import datetime
from typing import Any, NamedTuple

import sqlalchemy as sa

from storage.database import ReadSession, WriteSession
from storage.models import alert_unresolved, alerts, devices, installations, mount_current, mounts, sessions
from storage.mounts import COLUMNS as MOUNT_COLUMNS
from storage.mounts import Mount
from storage.prepared import Prepared


class Installation(NamedTuple):
    """An installation."""

    device_pk: int
    snapshot: bytes | None
    session_pk: int | None
    """the session the estimator is in"""
    stage: str
    since_session_pk: int | None
    """the session in which the stage began; None: it began at `since_at`"""
    since_t: float | None
    since_at: datetime
    status: dict[str, Any]
    last_data_at: datetime | None
    revision: int
    watch: dict[str, Any] | None = None
    """what the rules of alerts remember, see `api/services/rules`"""
    motion: bytes | None = None
    """state of the detector of events; None: it begins anew"""
    accelerometer_calibration: dict[str, Any] | None = None
    """of the device, where it is kept"""


class Beside(NamedTuple):
    """What is shown with an installation and kept elsewhere."""

    since_started_at: datetime | None
    """zero of the clock of the session in which the stage began"""
    open_alerts: int
    mount: Mount | None
    """the one in force, or the suspect one"""


_own = Installation._fields[:-1]
_select = sa.select(*(installations.c[name] for name in _own), devices.c.accelerometer_calibration).join_from(
    installations, devices
)
_of_id = _select.where(devices.c.id == sa.bindparam("id"))
_find = Prepared(_of_id)
_lock = Prepared(_of_id.with_for_update(key_share=True, of=(installations, devices)))
_get = _select.where(installations.c.device_pk == sa.bindparam("device_pk"))
_device_id = sa.select(devices.c.id).where(devices.c.pk == sa.bindparam("of_device_pk")).scalar_subquery()
_since = sessions.alias()
_show = (
    sa.select(
        sa.select(_since.c.started_at).where(_since.c.pk == sa.bindparam("since_session_pk")).scalar_subquery(),
        sa.select(sa.func.count()).where(alerts.c.device_id == devices.c.id, alert_unresolved).scalar_subquery(),
        *MOUNT_COLUMNS,
    )
    .select_from(  # one by one: SQLite would put all mountings of all devices together for a join in brackets
        devices.outerjoin(mounts, (mounts.c.device_pk == devices.c.pk) & mount_current).outerjoin(
            sessions, sessions.c.pk == mounts.c.session_pk
        )
    )
    .where(devices.c.pk == sa.bindparam("of_device_pk"))
)
_beside = Prepared(_show)
_add = sa.insert(installations).values(device_id=_device_id)
_update = sa.update(installations).where(installations.c.device_pk == sa.bindparam("of_device_pk"))
_save = Prepared(_update)
_touch = _update.values(revision=installations.c.revision + 1)
_remember = _update.values(watch=sa.bindparam("of_watch", type_=installations.c.watch.type))
_told = sa.exists().where(
    alerts.c.device_pk == installations.c.device_pk,
    alerts.c.kind == sa.bindparam("kind"),
    alert_unresolved | (alerts.c.opened_at > installations.c.last_data_at),
)
_silent = (
    sa.select(installations.c.device_pk, devices.c.id)
    .join_from(installations, devices)
    .where(
        installations.c.last_data_at < sa.bindparam("before"),
        installations.c.device_pk > sa.bindparam("after"),
        ~_told,
    )
    .order_by(installations.c.device_pk)
    .limit(sa.bindparam("limit"))
)


def lock(tx: WriteSession, device_id: str) -> Installation | None:
    """Make every other writer of this device wait until this transaction ends; None when the device is unknown."""
    return tx.one(Installation, _lock, id=device_id)


def find(tx: ReadSession, device_id: str) -> Installation | None:
    """Find the installation of a device by the device's id."""
    return tx.one(Installation, _find, id=device_id)


def get(tx: ReadSession, device_pk: int) -> Installation | None:
    """Find the installation of a device."""
    return tx.one(Installation, _get, device_pk=device_pk)


def beside(tx: ReadSession, row: Installation) -> Beside:
    """Give what is shown with an installation."""
    values = {"since_session_pk": row.since_session_pk, "of_device_pk": row.device_pk}
    return tx.one(_shown_beside, _beside, **values) or Beside(None, 0, None)


def _shown_beside(since_started_at: datetime | None, open_alerts: int, *mount: Any) -> Beside:
    return Beside(since_started_at, open_alerts, None if mount[0] is None else Mount(*mount))


def add(tx: WriteSession, installation: Installation) -> None:
    """Store the installation of a new device."""
    values = _values(installation)
    tx.execute(_add, of_device_pk=values["device_pk"], **values)


def save(tx: WriteSession, installation: Installation) -> None:
    """Store what evolves."""
    values = _values(installation)
    tx.run(_save, of_device_pk=values.pop("device_pk"), **values)


def _values(installation: Installation) -> dict[str, Any]:
    return dict(zip(_own, installation, strict=False))


def remember(tx: WriteSession, device_pk: int, watch: dict[str, Any] | None) -> None:
    """Store what the rules of alerts remember."""
    tx.execute(_remember, of_device_pk=device_pk, of_watch=watch)


def silent(tx: ReadSession, kind: str, before: datetime, after: int, limit: int) -> list[tuple[int, str]]:
    """Give devices (number, id) whose last data came before a moment and of which no alert of this kind tells yet.

    An alert tells of this silence when it is not resolved, or was opened after the last data: one that somebody
    resolved by hand is not raised again before the device has sent and fallen silent anew.
    """
    values = {"kind": kind, "before": before, "after": after, "limit": limit}
    return tx.all(lambda pk, device_id: (pk, device_id), _silent, **values)


def touch(tx: WriteSession, device_pk: int) -> None:
    """Raise the revision: something shown with the installation has changed."""
    tx.execute(_touch, of_device_pk=device_pk)
