"""Everything an upload may change, as it is stored: what two devices with the same drive must have in common."""

from typing import Any

import sqlalchemy as sa

from storage.database import Database
from storage.models import alerts, chunks, devices, estimates, installations, mounts, sessions

TIMES_OF_DAY = ("at", "since")
"""of an alert's data"""


def of_device(database: Database, device_id: str) -> dict[str, list[Any]]:
    """Give the rows of a device without the times of day, which are never the same."""
    with database.read() as tx:
        pk = tx.value(sa.select(devices.c.pk).where(devices.c.id == device_id))
        in_session = sessions.c.device_pk == pk
        queries = {
            "installation": sa.select(
                installations.c.snapshot, installations.c.stage, installations.c.status, installations.c.revision
            ).where(installations.c.device_pk == pk),
            "sessions": sa.select(sessions.c.name, sessions.c.next_seq, sessions.c.context).where(in_session),
            "chunks": sa.select(
                *(chunks.c.seq, chunks.c.digest, chunks.c.state, chunks.c.samples, chunks.c.rejected, chunks.c.body),
                *(chunks.c.t_first, chunks.c.t_last),
            )
            .join(sessions)
            .where(in_session)
            .order_by(chunks.c.seq),
            "estimates": sa.select(estimates.c.t_first, estimates.c.changes, estimates.c.rows)
            .join(sessions, sessions.c.pk == estimates.c.session_pk)
            .where(in_session)
            .order_by(estimates.c.pk),
            "mounts": sa.select(
                mounts.c.n, mounts.c.t, mounts.c.quaternion, mounts.c.verification, mounts.c.status
            ).where(mounts.c.device_pk == pk),
            "alerts": sa.select(alerts.c.kind, alerts.c.state, alerts.c.occurrences, alerts.c.data).where(
                alerts.c.device_pk == pk
            ),
        }
        rows = {name: [tuple(row) for row in tx.connection.execute(query)] for name, query in queries.items()}
    rows["alerts"] = [
        (*row[:-1], {k: v for k, v in row[-1].items() if k not in TIMES_OF_DAY}) for row in rows["alerts"]
    ]
    return rows
