"""Where the installation of each device stands: the estimator's snapshot (bytes to us) and what is shown of it.

The row is also the lock under which everything of one device is changed.
"""

from datetime import datetime
from typing import Any, NamedTuple

import sqlalchemy as sa

from storage.database import ReadSession, WriteSession
from storage.models import alert_unresolved, alerts, devices, installations, sessions
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
    accelerometer_calibration: dict[str, Any] | None = None
    """of the device, where it is kept"""


class Beside(NamedTuple):
    """What is shown with an installation and kept elsewhere."""

    since_started_at: datetime | None
    """zero of the clock of the session in which the stage began"""
    open_alerts: int


_own = Installation._fields[:-1]
_select = sa.select(*(installations.c[name] for name in _own), devices.c.accelerometer_calibration).join_from(
    installations, devices
)
_of_id = _select.where(devices.c.id == sa.bindparam("id"))
_find = Prepared(_of_id)
_lock = Prepared(_of_id.with_for_update(key_share=True, of=installations))
_get = _select.where(installations.c.device_pk == sa.bindparam("device_pk"))
_show = sa.select(
    sa.select(sessions.c.started_at).where(sessions.c.pk == sa.bindparam("since_session_pk")).scalar_subquery(),
    sa.select(sa.func.count())
    .where(alerts.c.device_pk == sa.bindparam("device_pk"), alert_unresolved)
    .scalar_subquery(),
)
_beside = Prepared(_show)
_add = sa.insert(installations)
_update = sa.update(installations).where(installations.c.device_pk == sa.bindparam("of_device_pk"))
_save = Prepared(_update)
_touch = _update.values(revision=installations.c.revision + 1)


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
    values = {"since_session_pk": row.since_session_pk, "device_pk": row.device_pk}
    return tx.all(Beside, _beside, **values)[0]


def add(tx: WriteSession, installation: Installation) -> None:
    """Store the installation of a new device."""
    tx.execute(_add, **_values(installation))


def save(tx: WriteSession, installation: Installation) -> None:
    """Store what evolves."""
    values = _values(installation)
    tx.run(_save, of_device_pk=values.pop("device_pk"), **values)


def _values(installation: Installation) -> dict[str, Any]:
    return dict(zip(_own, installation, strict=False))


def touch(tx: WriteSession, device_pk: int) -> None:
    """Raise the revision: something shown with the installation has changed."""
    tx.execute(_touch, of_device_pk=device_pk)
