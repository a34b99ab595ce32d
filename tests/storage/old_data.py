"""A row or two in every table of the first versions, as the service of that time would have written them."""

import hashlib
from datetime import UTC, datetime, timedelta
from typing import Any

import sqlalchemy as sa

from api.services.access import digest
from storage.database import WriteSession
from storage.models import microseconds
from tests import aged
from tests.drives import chunks

DEVICE_KEY = "livella_key-of-the-old-device"
AT = microseconds(datetime(2024, 5, 6, 7, 0, 0, tzinfo=UTC))
MINUTE = timedelta(minutes=1) // timedelta(microseconds=1)
IDENTITY = [1.0, 0.0, 0.0, 0.0]
IDLE = {"state": "idle", "elapsed_s": 0.0, "duration_s": 40.0, "error_mps": None, "limit_mps": 0.5}
PASSED = {"state": "passed", "elapsed_s": 40.0, "duration_s": 40.0, "error_mps": 0.2, "limit_mps": 0.5}


def _alert(pk: int, device_pk: int, state: str, **more: Any) -> dict[str, Any]:
    row = {"pk": pk, "device_pk": device_pk, "kind": "orientation_changed", "severity": "warning", "state": state}
    return row | {"opened_at": AT, "updated_at": AT, "occurrences": 2, "message": "Moved.", "data": {"n": 1}} | more


def _receipt(seq: int, state: str, **more: Any) -> dict[str, Any]:
    content = hashlib.sha256(b"text/csv\0" + chunks()[seq]).hexdigest()  # as it was made then
    row = {"session_pk": 2, "seq": seq, "digest": content, "state": state, "samples": 1500, "fixes": 120}
    return row | {"rejected": {}, "received_at": AT} | more


def _block(n: int) -> dict[str, Any]:
    row = {"pk": n + 1, "session_pk": 1, "t_first": 60.0 * n, "t_last": 60.0 * n + 55.0, "size": 12, "changes": 0}
    return row | {"rows": aged.chunk_rows(60.0 * n), "received_at": AT + (n + 1) * MINUTE}


def rows() -> dict[str, list[dict[str, Any]]]:
    """Give the rows of version 0001, in an order in which they can be stored."""
    mount = {"device_pk": 7, "session_pk": 1, "quaternion": IDENTITY, "sigma_deg": [0.5] * 3, "verification": PASSED}
    status = {"progress": 0.0, "needs": ["data"], "estimate": None, "verification": IDLE}
    installation = {"stage": "waiting", "since_at": AT, "status": status, "revision": 3}
    key = {"created_at": AT, "source": "made"}
    waiting = {"body": chunks()[2], "content_type": "text/csv", "content_encoding": None, "course": "auto"}
    return {
        "devices": [
            {"pk": 7, "id": "old", "name": "Old Box", "vehicle": "HH-LV 1", "notes": "Äußerst alt", "created_at": AT},
            {"pk": 9, "id": "bare", "name": "Bare", "vehicle": None, "notes": None, "created_at": AT},
        ],
        "events": [{"pk": 1, "xact": 0, "device_id": "old", "type": "device", "data": "{}", "created_at": AT}],
        "meta": [{"name": "cookie_secret", "value": "secret"}, {"name": "events_pruned", "value": "0.0"}],
        "alerts": [
            _alert(3, 7, "open"),
            _alert(4, 7, "resolved", resolved_at=AT, resolved_by="service", resolve_note="over"),
        ],
        "api_keys": [
            key | {"pk": 1, "digest": digest("admin"), "role": "admin", "name": "first admin", "device_pk": None},
            key | {"pk": 2, "digest": digest(DEVICE_KEY), "role": "device", "name": "old", "device_pk": 7},
        ],
        "installations": [
            installation | {"device_pk": 7, "session_pk": 2, "last_data_at": AT},
            installation | {"device_pk": 9, "session_pk": None, "last_data_at": None},
        ],
        "sessions": [
            {"pk": 1, "device_pk": 7, "name": "first", "next_seq": 3, "started_at": AT, "created_at": AT},
            {"pk": 2, "device_pk": 7, "name": "second", "next_seq": 1, "started_at": AT + 9 * MINUTE, "created_at": AT},
        ],
        "chunks": [_receipt(0, "applied"), _receipt(2, "waiting", **waiting)],
        "estimates": [_block(n) for n in range(3)],
        "mounts": [
            mount | {"n": 1, "t": 60.0, "status": "superseded"},
            mount | {"n": 2, "t": 120.0, "status": "in_force"},
        ],
    }


def fill(tx: WriteSession, version: str) -> None:
    """Store the rows in a database of a version."""
    tables = sa.MetaData()
    tables.reflect(tx.connection)
    for name, found in rows().items():
        for row in found:
            tx.connection.execute(sa.insert(tables.tables[name]).values(**row))
    if version >= "0002":
        devices = tables.tables["devices"]
        calibration = {"gain": [[1.1, 0, 0], [0, 1, 0], [0, 0, 1]], "offset": [0.1, 0, 0]}
        tx.connection.execute(sa.update(devices).where(devices.c.pk == 9).values(accelerometer_calibration=calibration))
    if tx.is_postgresql:
        for name, found in rows().items():
            if "pk" in found[0]:  # numbers were given out
                newest = f"SELECT setval(pg_get_serial_sequence('{name}', 'pk'), max(pk)) FROM {name}"  # noqa: S608
                tx.connection.execute(sa.text(newest))


def contents(tx: WriteSession) -> dict[str, list[dict[str, Any]]]:
    """Give everything that is stored, by table."""
    tables = sa.MetaData()
    tables.reflect(tx.connection)
    found = {}
    for table in tables.sorted_tables:
        result = tx.connection.execute(sa.select(table).order_by(*table.primary_key))
        found[table.name] = [dict(row) for row in result.mappings()]
    return {name: table for name, table in found.items() if name != "alembic_version"}
