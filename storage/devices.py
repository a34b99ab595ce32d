"""Devices, each listed with a summary of its installation."""

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
    status: dict[str, Any]
    last_data_at: datetime | None
    revision: int
    mount_status: str | None
    open_alerts: int


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
_add = sa.insert(devices).returning(devices.c.pk)
_edit = sa.update(devices).where(devices.c.pk == sa.bindparam("of_pk"))
TEXTS = ("id", "name", "vehicle", "notes")
"""What is searched, in this order."""
SEARCHED = 1000
"""characters of these texts that are searched"""
_plan_for_this_text = sa.text("SET LOCAL plan_cache_mode = force_custom_plan")
"""Whether many or few have a text decides how PostgreSQL finds them; a plan made for any text takes it for common."""
FEW = 5000
"""devices that are looked at one by one as fast as all of them in a row"""


def _count_some(which: sa.Select[Any]) -> sa.Select[int]:
    return sa.select(sa.func.count()).select_from(which.limit(sa.bindparam("few")).subquery("some"))


_some_alerts = _count_some(sa.select(alerts.c.device_id).where(alert_unresolved))
_some_of_stage = _count_some(sa.select(installations.c.device_id).where(installations.c.stage == sa.bindparam("stage")))
_texts = sa.select(*(devices.c[name] for name in TEXTS)).where(devices.c.pk == sa.bindparam("pk"))
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
    if q and tx.is_postgresql:
        tx.connection.execute(_plan_for_this_text)
    pk, device_id, conditions = _listed(tx, q, stage, has_open_alert)
    if after is not None:
        conditions.append(device_id > after)
    pks = sa.select(pk).where(*conditions).order_by(device_id).limit(limit)
    if pk is alerts.c.device_pk:
        pks = pks.group_by(device_id, pk).order_by(pk)  # there may be several of a device
    return tx.all(Device, _select.where(devices.c.pk.in_(pks)).order_by(devices.c.id))


Listed = tuple[sa.ColumnElement[int], sa.ColumnElement[str], list[sa.ColumnElement[bool]]]


def _listed(tx: ReadSession, q: str | None, stage: str | None, has_open_alert: bool | None) -> Listed:
    """Give number, id and conditions of the devices to list, from where an index has the most telling ones in order.

    A text that few have is looked for in every device, unless a few others are named: then only in those.
    """
    if has_open_alert and (not q or _few(tx, _some_alerts)):
        pk, device_id = alerts.c.device_pk, alerts.c.device_id
        return pk, device_id, [alert_unresolved, *_has_stage(device_id, stage), *_has_text(pk, q)]
    if stage is not None and (not q or _few(tx, _some_of_stage, stage=stage)):
        pk, device_id = installations.c.device_pk, installations.c.device_id
        this = installations.c.stage == stage
        return pk, device_id, [this, *_is_alerted(device_id, has_open_alert), *_has_text(pk, q)]
    found = [] if not q else [_holds(q)]
    device_id = devices.c.id
    return devices.c.pk, device_id, [*found, *_has_stage(device_id, stage), *_is_alerted(device_id, has_open_alert)]


def _few(tx: ReadSession, some: sa.Select[int], **values: Any) -> bool:
    return int(tx.value(some, **values, few=FEW)) < FEW


def _holds(q: str, text: sa.ColumnElement[str] = devices.c.search) -> sa.ColumnElement[bool]:
    return text.contains(q.casefold(), autoescape=True)


def _has_text(pk: sa.ColumnElement[int], q: str | None) -> list[sa.ColumnElement[bool]]:
    """Look at the text of one device after the other; PostgreSQL would turn EXISTS into a search of all devices."""
    text = sa.select(devices.c.search).where(devices.c.pk == pk).scalar_subquery()
    return [_holds(q, text)] if q else []


def _has_stage(device_id: sa.ColumnElement[str], stage: str | None) -> list[sa.ColumnElement[bool]]:
    this = (installations.c.device_id == device_id, installations.c.stage == stage)
    return [] if stage is None else [sa.exists().where(*this)]


def _is_alerted(device_id: sa.ColumnElement[str], wanted: bool | None) -> list[sa.ColumnElement[bool]]:
    alerted = sa.exists().where(alerts.c.device_id == device_id, alert_unresolved)
    return [] if wanted is None else [alerted if wanted else ~alerted]


def add(tx: WriteSession, device_id: str, values: dict[str, Any], now: datetime) -> int:
    """Register a device with the values of its columns; `IntegrityError` when the id is taken."""
    search = _search([device_id, *(values.get(name) for name in TEXTS[1:])])
    return int(tx.execute(_add, id=device_id, created_at=now, search=search, **values).scalar_one())


def _search(texts: Sequence[str | None]) -> str:
    return "\n".join(filter(None, texts)).casefold()[:SEARCHED]


def edit(tx: WriteSession, pk: int, values: dict[str, Any]) -> None:
    """Change the texts of a device, or its accelerometer's calibration."""
    if values:
        tx.execute(_edit, of_pk=pk, **values)
        tx.execute(_edit, of_pk=pk, search=_search(tx.connection.execute(_texts, {"pk": pk}).one()))


def remove(tx: WriteSession, pk: int) -> None:
    """Remove a device and everything of it."""
    tx.execute(_remove, pk=pk)


def stages(tx: ReadSession, device_pk: int | None = None) -> dict[str, int]:
    """Count devices by stage, all of them or only one."""
    statement = sa.select(installations.c.stage, sa.func.count()).group_by(installations.c.stage)
    if device_pk is not None:
        statement = statement.where(installations.c.device_pk == device_pk)
    return dict(tx.all(lambda stage, count: (stage, count), statement))
