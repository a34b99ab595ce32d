"""A fleet of any size, written straight into the tables: registering ten thousand devices would take minutes."""

from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import sqlalchemy as sa

import core
from api.services import presenting
from storage.database import Database
from storage.migrate import upgrade
from storage.models import alerts, devices, installations, mounts, sessions

STAGES = {"waiting": 0.0, "aligning": 0.2, "settling": 0.6, "verifying": 0.9, "confirmed": 1.0}
ALERTED_EACH = 50
"""one device of so many has an open alert"""
ALERTS = (
    ("orientation_changed", "warning"),
    ("device_silent", "warning"),
    ("device_loose", "critical"),
    ("gps_lost", "info"),
)
"""kinds and severities, in turn"""
SILENT_DAYS = 5
STATUS = presenting.status(core.status(core.DEFAULT, core.initial_state(core.DEFAULT)))


def make(data: Path, number: int) -> None:
    """Make the database of a service that keeps its data in this directory."""
    data.mkdir(parents=True)
    database = Database(f"sqlite:///{data.absolute() / 'livella.db'}")
    upgrade(database)
    now = datetime.now(UTC)
    with database.write() as tx:
        for table, rows in _tables(number, now).items():
            if rows:
                tx.connection.execute(sa.insert(table), rows)
    database.close()


def _tables(number: int, now: datetime) -> dict[sa.Table, list[dict[str, Any]]]:
    numbers = range(1, number + 1)
    moved = [n for n in numbers if alert_of(n) == ALERTS[0]]
    return {
        devices: [_device(n, now) for n in numbers],
        installations: [_installation(n, now) for n in numbers],
        sessions: [_session(n, now) for n in moved],
        mounts: [_mount(n) for n in moved],
        alerts: [_alert(n, alert, now) for n in numbers if (alert := alert_of(n)) is not None],
    }


def id_of(n: int) -> str:
    """Name device `n`."""
    return f"dev-{n:05}"


def stage_of(n: int) -> str:
    """Give the stage of device `n`: each in turn, but devices with a mounting have been confirmed."""
    return "confirmed" if alert_of(n) == ALERTS[0] else tuple(STAGES)[n % len(STAGES)]


def alert_of(n: int) -> tuple[str, str] | None:
    """Give kind and severity of the open alert of device `n`, if it has one."""
    return ALERTS[n // ALERTED_EACH % len(ALERTS)] if n % ALERTED_EACH == 0 else None


def _device(n: int, now: datetime) -> dict[str, Any]:
    texts = {"id": id_of(n), "name": f"Van {n}", "vehicle": f"Fiat Ducato, FL {n:05} AG" if n % 3 else None}
    search = "\n".join(filter(None, texts.values())).casefold()
    keys = {"search": search, "name_key": str(texts["name"]).casefold()}
    return texts | keys | {"pk": n, "created_at": now - timedelta(days=30)}


def _installation(n: int, now: datetime) -> dict[str, Any]:
    stage = stage_of(n)
    silent = alert_of(n) == ("device_silent", "warning")
    quiet = timedelta(days=SILENT_DAYS) if silent else timedelta(seconds=n)
    return {
        "device_pk": n,
        "device_id": id_of(n),
        "stage": stage,
        "since_at": now - timedelta(days=1),
        "status": STATUS | {"progress": STAGES[stage]},
        "last_data_at": None if stage == "waiting" and not silent else now - quiet,
        "revision": 1,
    }


def _session(n: int, now: datetime) -> dict[str, Any]:
    return {"pk": n, "device_pk": n, "name": "a", "next_seq": 0, "created_at": now, "started_at": now}


def _mount(n: int) -> dict[str, Any]:
    made = {"device_pk": n, "session_pk": n, "n": 1, "t": 60.0, "status": "suspect"}
    return made | {"quaternion": [1.0, 0.0, 0.0, 0.0], "sigma_deg": [0.5] * 3, "verification": {"state": "passed"}}


def _alert(n: int, alert: tuple[str, str], now: datetime) -> dict[str, Any]:
    opened = now - timedelta(minutes=n)
    return {
        "device_pk": n,
        "device_id": id_of(n),
        "kind": alert[0],
        "severity": alert[1],
        "state": "open",
        "opened_at": opened,
        "updated_at": opened,
        "occurrences": 1,
        "message": "Something is not as it should be.",
        "data": {},
    }
