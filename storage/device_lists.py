"""Lists of devices: in any order, with any filters, page by page from where an index has them in that order.

A filter names a set of devices. One of a few begins the search; one of many is made once, and each device in the
order's turn is looked up in it; of most devices, each one's belonging is looked up where it is kept, and so is a text
where the other filters leave not many. So a page never takes much longer than going through an index of all devices,
wherever in the order those are that a filter names.
"""

from collections.abc import Iterator
from datetime import datetime
from typing import Any, NamedTuple

import sqlalchemy as sa

from storage.database import ReadSession
from storage.devices import Device, select
from storage.models import alert_unresolved, alerts, devices, installations, mount_current, mounts

FEW, SOME, MANY = 1000, 10_000, 40_000
"""devices of a filter: fewer than `FEW` are sorted as fast as they are found, of fewer than `SOME` the texts are read
sooner than those of all devices, more than `MANY` are not put into a set"""
_plan_this_list = sa.text(
    "SELECT set_config('plan_cache_mode', 'force_custom_plan', true), set_config('jit', 'off', true),"
    " set_config('max_parallel_workers_per_gather', '0', true)"
)
"""For PostgreSQL. Whether many or few have a text decides how they are found: a plan made for any text takes it for
common. Compiling, and starting processes, takes longer than a page may."""


class Filter(NamedTuple):
    """Which devices to list."""

    q: str | None = None
    """found in any text of a device"""
    stage: str | None = None
    has_open_alert: bool | None = None
    alert_kind: str | None = None
    alert_severity: str | None = None
    mount_status: str | None = None
    """of the current mounting"""


class Place(NamedTuple):
    """A place in a list."""

    id: str
    key: str | datetime | None = None
    """of what the list is ordered by, before the id"""


class Order(NamedTuple):
    """An order, by a key (if any) and then by id; both are in one index."""

    pk: sa.ColumnElement[int]
    id: sa.ColumnElement[str]
    key: sa.ColumnElement[Any] | None = None
    is_backwards: bool = False

    @property
    def columns(self) -> list[sa.ColumnElement[Any]]:
        """What the index has, in its order."""
        return [self.id] if self.key is None else [self.key, self.id]

    @property
    def terms(self) -> list[sa.ColumnElement[Any]]:
        """What to order by."""
        return [column.desc() if self.is_backwards else column for column in self.columns]


_ORDERS = {
    "id": Order(devices.c.pk, devices.c.id),
    "name": Order(devices.c.pk, devices.c.id, devices.c.name_key),
    "last_data_at": Order(installations.c.device_pk, installations.c.device_id, installations.c.last_data_at),
}
_of = installations.alias()
_other = devices.alias()
_current_mounts = (
    sa.select(mounts.c.device_pk, _other.c.id)
    .join_from(mounts, _other, mounts.c.device_pk == _other.c.pk)
    .where(mount_current)
)
_unresolved = sa.select(alerts.c.device_pk, alerts.c.device_id).where(alert_unresolved)


def page(tx: ReadSession, limit: int, after: Place | None, wanted: Filter, sort: str = "id") -> list[Device]:
    """Give up to `limit` devices from after a place; `-` before the order's name turns it round.

    Those without the key that the list is ordered by come last, either way.
    """
    if tx.is_postgresql:
        tx.connection.execute(_plan_this_list)
    order = _ORDERS[sort.removeprefix("-")]._replace(is_backwards=sort.startswith("-"))
    chosen = list(_chosen(tx, order, wanted))
    found: list[Device] = []
    for part in _parts(order, after):
        ids = sa.select(order.id).where(*part, *chosen).order_by(*order.terms).limit(limit - len(found))
        found += tx.all(Device, select.where(devices.c.id.in_(ids)).order_by(*order.terms))
        if len(found) == limit:
            break
    return found


def _parts(order: Order, after: Place | None) -> Iterator[list[sa.ColumnElement[bool]]]:
    """Give the conditions of the parts of a list that are left after a place: with the key, and without it."""
    if order.key is not installations.c.last_data_at:
        yield _after(order, after)
        return
    if after is None or after.key is not None:
        yield [order.key.is_not(None), *_after(order, after)]
        after = None
    yield [order.key.is_(None), *_after(order._replace(key=None), after)]


def _after(order: Order, after: Place | None) -> list[sa.ColumnElement[bool]]:
    if after is None:
        return []
    values = [after.id] if order.key is None else [after.key, after.id]
    here = sa.tuple_(*order.columns)
    there = sa.tuple_(*(sa.literal(value, column.type) for value, column in zip(values, order.columns, strict=True)))
    return [here < there if order.is_backwards else here > there]


def _chosen(tx: ReadSession, order: Order, wanted: Filter) -> Iterator[sa.ColumnElement[bool]]:
    """Give the conditions of the filters, those that usually leave the fewest first."""
    named = [_belonging(tx, order, members) for members in _named(wanted)]
    yield from (condition for _, condition in named)
    if wanted.has_open_alert is False:
        yield _belonging(tx, order, _unresolved, wanted=False)[1]
    if wanted.q:
        yield _has_text(tx, order, wanted.q, min((number for number, _ in named), default=MANY))


def _named(wanted: Filter) -> Iterator[sa.Select[int, str]]:
    """Give number and id of those that each filter names, of what usually are the fewest first."""
    of_alert = {"kind": wanted.alert_kind, "severity": wanted.alert_severity}
    conditions = [alerts.c[name] == value for name, value in of_alert.items() if value is not None]
    if conditions or wanted.has_open_alert:
        yield _unresolved.where(*conditions)
    if wanted.mount_status is not None:
        yield _current_mounts.where(mounts.c.status == wanted.mount_status)
    if wanted.stage is not None:
        yield sa.select(_of.c.device_pk, _of.c.device_id).where(_of.c.stage == wanted.stage)


def _belonging(
    tx: ReadSession, order: Order, members: sa.Select[int, str], wanted: bool = True
) -> tuple[int, sa.ColumnElement[bool]]:
    """Tell whether a device is one of those whose number and id are given, or is not; and, up to `MANY`, how many are.

    A database begins with those that a number must be IN; with what IS IN or not, it can do nothing but look.
    """
    pk, device_id = members.selected_columns
    number = _up_to_many(tx, pks := members.with_only_columns(pk))
    if number >= MANY:
        told = members.with_only_columns(device_id).where(device_id == order.id).exists()
        return number, told if wanted else ~told
    within = order.pk.in_(pks.limit(MANY))  # which takes none away now, but assures PostgreSQL that memory will do
    return number, within if number < FEW and wanted else within.is_(wanted)


def _has_text(tx: ReadSession, order: Order, q: str, named: int) -> sa.ColumnElement[bool]:
    """Tell whether a device has a text; `named`: how many the other filters leave, up to `MANY`.

    PostgreSQL can guess how many have it. SQLite reads all texts in an index, unless those of a few will do.
    """
    text = q.casefold()
    if order.id is devices.c.id:
        return devices.c.search.contains(text, autoescape=True)
    pks = sa.select(_other.c.pk).where(_other.c.search.contains(text, autoescape=True))
    if tx.is_postgresql:
        return order.pk.in_(pks)
    number = MANY if named < SOME else _up_to_many(tx, pks)
    if number >= MANY:
        return pks.where(_other.c.pk == order.pk).exists()
    if number >= FEW:
        return order.pk.in_(pks).is_(True)
    found = tx.all(int, pks)  # read once, not for each part of the list
    return order.pk.in_(found) if found else sa.false()


def _up_to_many(tx: ReadSession, pks: sa.Select[int]) -> int:
    """Count devices, up to `MANY`."""
    number: int = tx.value(sa.select(sa.func.count()).select_from(pks.limit(MANY).subquery("some")))
    return number
