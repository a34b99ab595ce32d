"""Devices, each listed with a summary of its installation."""

from datetime import datetime
from typing import Any, NamedTuple

import sqlalchemy as sa

from storage.database import ReadSession, WriteSession
from storage.models import alert_unresolved, alerts, devices, installations, mounts


class Device(NamedTuple):
    """A device with a summary of its installation."""

    pk: int
    id: str
    name: str
    vehicle: str | None
    notes: str | None
    accelerometer_calibration: dict[str, Any] | None
    """`gain` (3x3) and `offset` (3, m/s2)"""
    created_at: datetime
    stage: str
    status: dict[str, Any]
    last_data_at: datetime | None
    revision: int
    mount_status: str | None
    open_alerts: int


open_alerts = (
    sa.select(sa.func.count())
    .where(alerts.c.device_pk == devices.c.pk, alert_unresolved)
    .correlate(devices)
    .scalar_subquery()
)

_mount_status = (
    sa.select(mounts.c.status)
    .where(mounts.c.device_pk == devices.c.pk, mounts.c.status != "superseded")
    .correlate(devices)
    .scalar_subquery()
)

_select = sa.select(
    devices.c.pk,
    devices.c.id,
    devices.c.name,
    devices.c.vehicle,
    devices.c.notes,
    devices.c.accelerometer_calibration,
    devices.c.created_at,
    installations.c.stage,
    installations.c.status,
    installations.c.last_data_at,
    installations.c.revision,
    _mount_status,
    open_alerts,
).join_from(devices, installations)
_find = _select.where(devices.c.id == sa.bindparam("id"))
_pk = sa.select(devices.c.pk).where(devices.c.id == sa.bindparam("id"))
_accelerometer_calibration = sa.select(devices.c.accelerometer_calibration).where(devices.c.pk == sa.bindparam("pk"))
_add = sa.insert(devices).returning(devices.c.pk)
_edit = sa.update(devices).where(devices.c.pk == sa.bindparam("of_pk"))
_remove = sa.delete(devices).where(devices.c.pk == sa.bindparam("pk"))


def find(tx: ReadSession, device_id: str) -> Device | None:
    """Find a device by its id."""
    return tx.one(Device, _find, id=device_id)


def exists(tx: ReadSession, device_id: str) -> int | None:
    """Give the `pk` of a device, None when unknown."""
    pk: int | None = tx.value(_pk, id=device_id)
    return pk


def page(
    tx: ReadSession,
    limit: int,
    after: str | None = None,
    q: str | None = None,
    stage: str | None = None,
    has_open_alert: bool | None = None,
) -> list[Device]:
    """Give up to `limit` devices in the order of their ids, from after `after`; `q` is looked for in every text."""
    statement = _select.order_by(devices.c.id).limit(limit)
    if after is not None:
        statement = statement.where(devices.c.id > after)
    if q:
        texts = (devices.c.id, devices.c.name, devices.c.vehicle, devices.c.notes)
        statement = statement.where(sa.or_(*(text.icontains(q, autoescape=True) for text in texts)))
    if stage is not None:
        statement = statement.where(installations.c.stage == stage)
    if has_open_alert is not None:
        statement = statement.where(open_alerts > 0 if has_open_alert else open_alerts == 0)
    return tx.all(Device, statement)


def accelerometer_calibration(tx: ReadSession, pk: int) -> dict[str, Any] | None:
    """Give `gain` (3x3) and `offset` (3, m/s2) of a device, None when it is taken as it reads."""
    found: dict[str, Any] | None = tx.value(_accelerometer_calibration, pk=pk)
    return found


def add(tx: WriteSession, device_id: str, values: dict[str, Any], now: datetime) -> int:
    """Register a device with the values of its columns; `IntegrityError` when the id is taken."""
    return int(tx.execute(_add, id=device_id, created_at=now, **values).scalar_one())


def edit(tx: WriteSession, pk: int, values: dict[str, Any]) -> None:
    """Change the texts of a device, or its accelerometer's calibration."""
    if values:
        tx.execute(_edit, of_pk=pk, **values)


def remove(tx: WriteSession, pk: int) -> None:
    """Remove a device and everything of it."""
    tx.execute(_remove, pk=pk)


def stages(tx: ReadSession, device_pk: int | None = None) -> dict[str, int]:
    """Count devices by stage, all of them or only one."""
    statement = sa.select(installations.c.stage, sa.func.count()).group_by(installations.c.stage)
    if device_pk is not None:
        statement = statement.where(installations.c.device_pk == device_pk)
    return dict(tx.all(lambda stage, count: (stage, count), statement))
