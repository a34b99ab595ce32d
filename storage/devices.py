"""Devices, each with a summary of its installation; `device_lists.py` lists them."""

from collections.abc import Sequence
from datetime import datetime
from typing import Any, NamedTuple

import sqlalchemy as sa

from storage.database import ReadSession, WriteSession
from storage.models import alert_unresolved, alerts, devices, installations, mount_current, mounts


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
    progress: float
    last_data_at: datetime | None
    revision: int
    name_key: str
    """the name as lists order it"""
    mount_status: str | None
    open_alerts: int
    vehicle_class: str | None


open_alerts = (
    sa.select(sa.func.count())
    .where(alerts.c.device_id == devices.c.id, alert_unresolved)
    .correlate(devices)
    .scalar_subquery()
)

_mount_status = (
    sa.select(mounts.c.status)
    .where(mounts.c.device_pk == devices.c.pk, mount_current)
    .correlate(devices)
    .scalar_subquery()
)

select = sa.select(
    devices.c.pk,
    devices.c.id,
    devices.c.name,
    devices.c.vehicle,
    devices.c.notes,
    devices.c.accelerometer_calibration,
    devices.c.created_at,
    installations.c.stage,
    installations.c.status["progress"].as_float(),
    installations.c.last_data_at,
    installations.c.revision,
    devices.c.name_key,
    _mount_status,
    open_alerts,
    devices.c.vehicle_class,
).join_from(devices, installations)
_find = select.where(devices.c.id == sa.bindparam("id"))
_pk = sa.select(devices.c.pk).where(devices.c.id == sa.bindparam("id"))
_add = sa.insert(devices).returning(devices.c.pk)
_edit = sa.update(devices).where(devices.c.pk == sa.bindparam("of_pk"))
TEXTS = ("id", "name", "vehicle", "notes")
"""What is searched, in this order."""
SEARCHED = 1000
"""characters of these texts that are searched"""
_texts = sa.select(*(devices.c[name] for name in TEXTS)).where(devices.c.pk == sa.bindparam("pk"))
_remove = sa.delete(devices).where(devices.c.pk == sa.bindparam("pk"))


def find(tx: ReadSession, device_id: str) -> Device | None:
    """Find a device by its id."""
    return tx.one(Device, _find, id=device_id)


def exists(tx: ReadSession, device_id: str) -> int | None:
    """Give the `pk` of a device, None when unknown."""
    pk: int | None = tx.value(_pk, id=device_id)
    return pk


def add(tx: WriteSession, device_id: str, values: dict[str, Any], now: datetime) -> int:
    """Register a device with the values of its columns; `IntegrityError` when the id is taken."""
    keys = _keys([device_id, *(values.get(name) for name in TEXTS[1:])])
    return int(tx.execute(_add, id=device_id, created_at=now, **keys, **values).scalar_one())


def _keys(texts: Sequence[str | None]) -> dict[str, str]:
    """Give what a device is found by, and ordered by, without regard to case."""
    name = texts[TEXTS.index("name")] or ""
    return {"search": "\n".join(filter(None, texts)).casefold()[:SEARCHED], "name_key": name.casefold()}


def edit(tx: WriteSession, pk: int, values: dict[str, Any]) -> None:
    """Change the texts of a device, its accelerometer's calibration, or its vehicle's class."""
    if values:
        tx.execute(_edit, of_pk=pk, **values)
        tx.execute(_edit, of_pk=pk, **_keys(tx.connection.execute(_texts, {"pk": pk}).one()))


def remove(tx: WriteSession, pk: int) -> None:
    """Remove a device and everything of it."""
    tx.execute(_remove, pk=pk)


def stages(tx: ReadSession, device_pk: int | None = None) -> dict[str, int]:
    """Count devices by stage, all of them or only one."""
    statement = sa.select(installations.c.stage, sa.func.count()).group_by(installations.c.stage)
    if device_pk is not None:
        statement = statement.where(installations.c.device_pk == device_pk)
    return dict(tx.all(lambda stage, count: (stage, count), statement))
