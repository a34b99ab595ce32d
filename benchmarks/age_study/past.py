"""A fleet with alerts, and a device with a year of driving, written straight into the tables."""

import random
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from typing import Any

import sqlalchemy as sa

from api import schemas
from api.services import fleet, retention
from api.services.context import Context
from storage.database import Database
from storage.models import alerts, devices, installations
from tests import aged

NOW = datetime(2024, 5, 6, 7, 8, 9, tzinfo=UTC)
STAGES = {"confirmed": 0.93, "settling": 0.05, "aligning": 0.0199, "waiting": 0.0001}
KINDS = ("gps_lost", "device_silent", "orientation_changed", "sensor_fault")
SNAPSHOT = bytes(16_000)
BATCH = 2000


def add_fleet(database: Database, numbers: range, alerts_each: int) -> None:
    """Store devices with their installations and resolved alerts; every fiftieth has one open."""
    generator = random.Random(1)
    for start in range(0, len(numbers), BATCH):
        rows = [_device(generator, pk) for pk in numbers[start : start + BATCH]]
        with database.write() as tx:
            tx.connection.execute(sa.insert(devices), rows)
            tx.connection.execute(sa.insert(installations), [_installation(generator, row) for row in rows])
    for year in range(alerts_each):
        with database.write() as tx:
            rows = [_alert(generator, pk, year, alerts_each) for pk in numbers]
            tx.connection.execute(sa.insert(alerts), rows)
    with database.write() as tx:
        ids = sa.select(devices.c.id).where(devices.c.pk == alerts.c.device_pk).scalar_subquery()
        tx.execute(sa.update(alerts).values(device_id=ids))


def _device(generator: random.Random, pk: int) -> dict[str, Any]:
    device_id, name = f"dev-{generator.randrange(16**12):012x}", f"Box {pk}"
    vehicle = f"HH-LV {generator.randrange(10_000)}"
    search = f"{device_id}\n{name}\n{vehicle}".casefold()
    return {"pk": pk, "id": device_id, "name": name, "vehicle": vehicle, "created_at": NOW, "search": search}


def _installation(generator: random.Random, device: dict[str, Any]) -> dict[str, Any]:
    stage = generator.choices(list(STAGES), list(STAGES.values()))[0]
    status = {"progress": 0.5, "needs": [], "estimate": None, "verification": None}
    return {
        "device_pk": device["pk"],
        "device_id": device["id"],
        "snapshot": SNAPSHOT,
        "stage": stage,
        "since_at": NOW,
        "status": status,
        "last_data_at": NOW,
        "revision": 1,
    }


def _alert(generator: random.Random, pk: int, year: int, years: int) -> dict[str, Any]:
    opened_at = NOW - timedelta(days=365 * (years - year)) + timedelta(seconds=300 * pk)
    is_open = year == years - 1 and pk % 50 == 0
    return {
        "device_pk": pk,
        "device_id": "",
        "kind": generator.choice(KINDS),
        "severity": "critical" if pk % 10_000 == 0 else "warning",
        "state": "open" if is_open else "resolved",
        "opened_at": opened_at,
        "updated_at": opened_at,
        "occurrences": 1,
        "message": "The device was moved.",
        "data": {},
    }


def add_year(context: Context, sessions_a_day: int, hours: float) -> int:
    """Store a device that drove for a year, its history aged as it is by the service; give its number."""
    fleet.register(context, schemas.DeviceDraft(id="old", name="Old"))
    with context.database.read() as tx:
        pk = fleet.number(tx, "old")
    aged.add_past(context.database, pk, NOW, 365, sessions_a_day, hours)
    while retention.coarsen(context):
        pass
    return pk


def periods() -> Iterator[tuple[str, timedelta]]:
    """Give the spans of charts."""
    yield from (("an hour", timedelta(hours=1)), ("a day", timedelta(days=1)), ("a month", timedelta(days=30)))
    yield "a year", timedelta(days=365)
