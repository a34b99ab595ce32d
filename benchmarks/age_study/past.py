"""A fleet, and devices with a year behind them, written straight into the tables."""

import math
import random
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from typing import Any

import sqlalchemy as sa

from api import schemas
from api.services import fleet, retention
from api.services.context import Context
from storage.database import Database, WriteSession
from storage.models import (
    Instant,
    alerts,
    chunks,
    devices,
    estimates,
    estimates_coarse,
    installations,
    microseconds,
    mounts,
    sessions,
)
from tests import aged

NOW = datetime(2024, 5, 6, 7, 8, 9, tzinfo=UTC)
YEAR = 365
"""days"""
STAGES = {"confirmed": 0.93, "settling": 0.05, "aligning": 0.0199, "waiting": 0.0001}
KINDS = ("gps_lost", "device_silent", "orientation_changed", "sensor_fault")
SNAPSHOT = bytes(16_000)
BATCH = 2000
OPEN_EACH = 50
"""one device of so many has an open alert"""
MOUNTS = 12
"""former mountings of an old device"""
HALF_LIFE = timedelta(hours=6)
"""half of the devices have sent within the last one, half of the others within the one before..."""
SCRAMBLE = 7919
"""prime, by which devices have their alerts in another order than they were registered"""


def add_fleet(database: Database, numbers: range) -> None:
    """Store devices with their installations; every fiftieth has an open alert."""
    generator = random.Random(1)
    for start in range(0, len(numbers), BATCH):
        rows = [_device(generator, pk) for pk in numbers[start : start + BATCH]]
        with database.write() as tx:
            tx.connection.execute(sa.insert(devices), [_without_pk(row) for row in rows])
            tx.connection.execute(sa.insert(installations), [_installation(generator, row) for row in rows])
    with database.write() as tx:
        _add_alerts(tx, "open", _since(devices.c.pk * 1_000_000), devices.c.pk % OPEN_EACH == 0)


def _device(generator: random.Random, pk: int) -> dict[str, Any]:
    device_id, name = f"dev-{generator.randrange(16**12):012x}", f"Box {pk}"
    vehicle = f"HH-LV {generator.randrange(10_000)}"
    keys = {"name_key": name.casefold(), "search": f"{device_id}\n{name}\n{vehicle}".casefold()}
    return {"pk": pk, "id": device_id, "name": name, "vehicle": vehicle, "created_at": NOW} | keys


def _without_pk(row: dict[str, Any]) -> dict[str, Any]:
    """The database numbers rows by itself, in turn; PostgreSQL would give out a number twice that it did not choose."""
    return {name: value for name, value in row.items() if name != "pk"}


def _installation(generator: random.Random, device: dict[str, Any]) -> dict[str, Any]:
    stage = generator.choices(list(STAGES), list(STAGES.values()))[0]
    last_data_at = None if stage == "waiting" else NOW + HALF_LIFE * math.log2(1 - generator.random())
    status = {"progress": 0.5, "needs": [], "estimate": None, "verification": None}
    return {
        "device_pk": device["pk"],
        "device_id": device["id"],
        "snapshot": SNAPSHOT,
        "stage": stage,
        "since_at": NOW,
        "status": status,
        "last_data_at": last_data_at,
        "revision": 1,
    }


def _since(ago: sa.ColumnElement[int]) -> sa.ColumnElement[int]:
    return sa.literal(microseconds(NOW), sa.BigInteger) - ago


def add_alerts(database: Database, number: int, each: int) -> None:
    """Store resolved alerts of all devices, evenly over the year before."""
    step = timedelta(days=YEAR) // timedelta(microseconds=1) // (number * each)
    for n in range(each):
        ago = (n * number + devices.c.pk * SCRAMBLE % number + 1) * step
        with database.write() as tx:
            _add_alerts(tx, "resolved", _since(ago), sa.true())


def _add_alerts(tx: WriteSession, state: str, opened_at: Any, which: sa.ColumnElement[bool]) -> None:
    kind = sa.case(
        *((devices.c.pk // OPEN_EACH % len(KINDS) == n, name) for n, name in enumerate(KINDS)), else_=KINDS[0]
    )
    severity = sa.case((devices.c.pk % 10_000 == 0, "critical"), else_="warning")
    values = {
        "device_pk": devices.c.pk,
        "device_id": devices.c.id,
        "kind": kind,
        "severity": severity,
        "state": sa.literal(state),
        "opened_at": opened_at,
        "updated_at": opened_at,
        "occurrences": sa.literal(1),
        "message": sa.literal("The device was moved."),
        "data": sa.literal({}, sa.JSON),
    }
    tx.execute(sa.insert(alerts).from_select(list(values), sa.select(*values.values()).where(which)))


def add_past(context: Context, device_id: str, days: int, sessions_a_day: int, hours: float) -> int:
    """Store a device that drove for so many days, its history aged as it is by the service; give its number."""
    fleet.register(context, schemas.DeviceDraft(id=device_id, name=device_id))
    with context.database.read() as tx:
        pk = fleet.number(tx, device_id)
    aged.add_past(context.database, pk, NOW, days, sessions_a_day, hours)
    while retention.coarsen(context):
        pass
    with context.database.write() as tx:
        _add_receipts(tx, pk)
        _add_mounts(tx, pk)
    return pk


def _add_receipts(tx: WriteSession, pk: int) -> None:
    """Store the receipts of what is fine history still: both are kept for as long."""
    values = {
        "session_pk": estimates.c.session_pk,
        "seq": sa.cast(estimates.c.t_first / aged.CHUNK, sa.Integer),
        "digest": sa.literal("0" * 64),
        "state": sa.literal("applied"),
        "samples": sa.literal(12_000),
        "fixes": sa.literal(240),
        "rejected": sa.literal({}, sa.JSON),
        "received_at": sa.type_coerce(estimates.c.received_at, Instant),
    }
    of_device = sa.select(*values.values()).where(estimates.c.device_pk == pk)
    tx.execute(sa.insert(chunks).from_select(list(values), of_device))


def _add_mounts(tx: WriteSession, pk: int) -> None:
    """Store former mountings, all in the first session."""
    first = sa.select(sa.func.min(sessions.c.pk)).where(sessions.c.device_pk == pk).scalar_subquery()
    mount = {"device_pk": pk, "t": 60.0, "quaternion": [1.0, 0.0, 0.0, 0.0], "sigma_deg": [0.5] * 3}
    mount |= {"verification": {"state": "passed"}, "status": "superseded"}
    for n in range(1, MOUNTS + 1):
        tx.execute(sa.insert(mounts).values(**mount, n=n, session_pk=first))


def copy_past(database: Database, of: int, to: int) -> None:
    """Give a device the past of another one."""
    with database.write() as tx:
        names = [column.name for column in sessions.c if column.name not in {"pk", "device_pk"}]
        own = sa.select(sa.literal(to), *(sessions.c[name] for name in names)).where(sessions.c.device_pk == of)
        tx.execute(sa.insert(sessions).from_select(["device_pk", *names], own.order_by(sessions.c.pk)))
        for table in (estimates, estimates_coarse, chunks, mounts):
            _copy(tx, table, of, to)


def _copy(tx: WriteSession, table: sa.Table, of: int, to: int) -> None:
    """Copy what belongs to the sessions of a device to those of the same names of another one."""
    theirs, ours = sessions.alias("theirs"), sessions.alias("ours")
    given = {"device_pk": sa.literal(to), "session_pk": ours.c.pk}
    here = theirs if "device_pk" not in table.c else table
    columns = {name: given.get(name, column) for name, column in table.c.items() if name != "pk"}
    found = (
        sa.select(*columns.values())
        .join_from(theirs, table, table.c.session_pk == theirs.c.pk)
        .join(ours, (ours.c.name == theirs.c.name) & (ours.c.device_pk == to))
        .where(theirs.c.device_pk == of, here.c.device_pk == of)
    )
    tx.execute(sa.insert(table).from_select(list(columns), found))


def periods() -> Iterator[tuple[str, timedelta]]:
    """Give the spans of charts."""
    yield from (("an hour", timedelta(hours=1)), ("a day", timedelta(days=1)), ("a month", timedelta(days=30)))
    yield "a year", timedelta(days=YEAR)
