"""The tables. Rows belong to a device and go with it; only `events` outlives it, so that a stream can tell of its end.

Times are whole microseconds since 1970 (`Instant`), the same on every database. History is kept on the device's clock
as (session, t); `sessions.started_at` turns it into UTC when it is read, see `storage/sessions.py`.
"""

from datetime import UTC, datetime, timedelta
from typing import Any

import sqlalchemy as sa
from sqlalchemy.engine import Dialect

EPOCH = datetime(1970, 1, 1, tzinfo=UTC)
MICROSECOND = timedelta(microseconds=1)


def microseconds(moment: datetime) -> int:
    """Give a moment as it is stored, us since 1970."""
    return (moment - EPOCH) // MICROSECOND


class Instant(sa.TypeDecorator[datetime]):
    """A moment in UTC, stored as whole microseconds since 1970."""

    impl = sa.BigInteger
    cache_ok = True

    def process_bind_param(self, value: datetime | None, dialect: Dialect) -> int | None:
        """Turn an aware datetime into microseconds."""
        return None if value is None else microseconds(value)

    def process_result_value(self, value: Any | None, dialect: Dialect) -> datetime | None:
        """Turn microseconds into a datetime in UTC."""
        return None if value is None else EPOCH + value * MICROSECOND


BIG = sa.BigInteger().with_variant(sa.Integer(), "sqlite")
"""Surrogate keys: 64 bits everywhere (SQLite numbers rows only in a column of type INTEGER)."""

NAME = sa.String(128)
DEVICE_ID = sa.String(64).with_variant(sa.String(64, collation="C"), "postgresql")
"""Compared byte by byte on every database, so that a list's order and its cursors do not depend on a locale."""
NAME_KEY = sa.Text().with_variant(sa.Text(collation="C"), "postgresql")
"""A name without regard to case, compared in the same way."""

metadata = sa.MetaData(
    naming_convention={
        "ix": "ix_%(table_name)s_%(column_0_N_name)s",
        "uq": "uq_%(table_name)s_%(column_0_N_name)s",
        "fk": "fk_%(table_name)s_%(column_0_name)s",
        "pk": "pk_%(table_name)s",
    }
)


def _device(**options: Any) -> sa.Column[int]:
    return sa.Column("device_pk", BIG, sa.ForeignKey("devices.pk", ondelete="CASCADE"), **options)


def _device_id() -> sa.Column[str]:
    """Copy of `devices.id`, which never changes: an index has lists in their order."""
    return sa.Column("device_id", DEVICE_ID, nullable=False, server_default="")


def _session(**options: Any) -> sa.Column[int]:
    return sa.Column("session_pk", BIG, sa.ForeignKey("sessions.pk", ondelete="CASCADE"), **options)


meta = sa.Table(
    "meta",
    metadata,
    sa.Column("name", sa.String(64), primary_key=True),
    sa.Column("value", sa.Text, nullable=False),
)

devices = sa.Table(
    "devices",
    metadata,
    sa.Column("pk", BIG, primary_key=True),
    sa.Column("id", DEVICE_ID, nullable=False, unique=True),
    sa.Column("name", NAME, nullable=False),
    sa.Column("vehicle", NAME),
    sa.Column("notes", sa.Text),
    sa.Column("accelerometer_calibration", sa.JSON(none_as_null=True)),
    sa.Column("created_at", Instant, nullable=False),
    sa.Column("search", sa.Text, nullable=False, server_default=""),
    sa.Column("name_key", NAME_KEY, nullable=False, server_default=""),
    sa.Column("vehicle_class", sa.String(16)),
    sqlite_autoincrement=True,
)
_by_id, _by_name = (devices.c.id,), (devices.c.name_key, devices.c.id)
sa.Index("ix_devices_id", *_by_id, postgresql_include=["pk"]).ddl_if(dialect="postgresql")
sa.Index("ix_devices_name_key_id", *_by_name, postgresql_include=["pk"]).ddl_if(dialect="postgresql")
sa.Index("ix_devices_id_search", *_by_id, devices.c.search).ddl_if(dialect="sqlite")
sa.Index("ix_devices_name_key_id_search", *_by_name, devices.c.search).ddl_if(dialect="sqlite")
"""SQLite looks through texts in the order of ids or names here, without the rest of the rows. PostgreSQL's indexes do
not take texts of any length, and it chooses by its statistics."""

api_keys = sa.Table(
    "api_keys",
    metadata,
    sa.Column("pk", BIG, primary_key=True),
    sa.Column("digest", sa.LargeBinary(32), nullable=False, unique=True),
    sa.Column("role", sa.String(16), nullable=False),
    sa.Column("name", NAME, nullable=False),
    _device(index=True),
    sa.Column("source", sa.String(16), nullable=False),
    sa.Column("created_at", Instant, nullable=False),
    sa.Column("prefix", sa.String(16)),
    sa.Column("last_used_at", Instant),
    sa.Column("expires_at", Instant),
    sa.Column("created_by", NAME),
    sqlite_autoincrement=True,
)

sign_ins = sa.Table(
    "sign_ins",
    metadata,
    sa.Column("pk", BIG, primary_key=True),
    sa.Column("digest", sa.LargeBinary(32), nullable=False, unique=True),
    sa.Column("key_pk", BIG, sa.ForeignKey("api_keys.pk", ondelete="CASCADE"), nullable=False, index=True),
    sa.Column("created_at", Instant, nullable=False),
    sa.Column("expires_at", Instant, nullable=False, index=True),
    sqlite_autoincrement=True,
)

sessions = sa.Table(
    "sessions",
    metadata,
    sa.Column("pk", BIG, primary_key=True),
    _device(nullable=False),
    sa.Column("name", NAME, nullable=False),
    sa.Column("next_seq", sa.Integer, nullable=False),
    sa.Column("context", sa.JSON(none_as_null=True)),
    sa.Column("started_at", Instant),
    sa.Column("created_at", Instant, nullable=False),
    sa.UniqueConstraint("device_pk", "name"),
    sa.Index("ix_sessions_device_pk_pk", "device_pk", "pk"),
    sqlite_autoincrement=True,
)

chunks = sa.Table(
    "chunks",
    metadata,
    _session(primary_key=True),
    sa.Column("seq", sa.Integer, primary_key=True, autoincrement=False),
    sa.Column("digest", sa.String(64), nullable=False),
    sa.Column("state", sa.String(16), nullable=False),
    sa.Column("samples", sa.Integer, nullable=False),
    sa.Column("fixes", sa.Integer, nullable=False),
    sa.Column("rejected", sa.JSON, nullable=False),
    sa.Column("received_at", Instant, nullable=False),
    sa.Column("body", sa.LargeBinary),
    sa.Column("content_type", sa.Text),
    sa.Column("content_encoding", sa.Text),
    sa.Column("course", sa.String(16)),
    sa.Column("t_first", sa.Double),
    sa.Column("t_last", sa.Double),
    sa.Index("ix_chunks_received_at", "received_at"),
)
chunk_waits = chunks.c.state == sa.literal_column("'waiting'")
"""As written in the index, so that queries find it."""
sa.Index("ix_chunks_waiting", chunks.c.session_pk, sqlite_where=chunk_waits, postgresql_where=chunk_waits)

raw_chunks = sa.Table(
    "raw_chunks",
    metadata,
    sa.Column("session_pk", BIG, primary_key=True, autoincrement=False),  # no foreign key, as below
    sa.Column("seq", sa.Integer, primary_key=True, autoincrement=False),
    _device(nullable=False),
    sa.Column("t_first", sa.Double, nullable=False),
    sa.Column("t_last", sa.Double, nullable=False),
    sa.Column("received_at", Instant, nullable=False),
    sa.Column("kept", sa.Boolean, nullable=False),
    sa.Column("columns", sa.String(128), nullable=False),
    sa.Column("content", sa.LargeBinary, nullable=False),  # last: SQLite reads a long row only as far as asked
    sa.Index("ix_raw_chunks_device_pk_received_at", "device_pk", "received_at"),
)
raw_may_go = raw_chunks.c.kept == sa.false()
sa.Index("ix_raw_chunks_may_go", raw_chunks.c.received_at, sqlite_where=raw_may_go, postgresql_where=raw_may_go)
"""Those that nothing keeps: however many are kept for ever, what goes is found without them."""

installations = sa.Table(
    "installations",
    metadata,
    _device(primary_key=True),
    sa.Column("snapshot", sa.LargeBinary),
    sa.Column("session_pk", BIG),  # no foreign key: it would cost an index, and the row goes with its device anyway
    sa.Column("stage", sa.String(16), nullable=False),
    sa.Column("since_session_pk", BIG),
    sa.Column("since_t", sa.Double),
    sa.Column("since_at", Instant, nullable=False),
    sa.Column("status", sa.JSON, nullable=False),
    sa.Column("last_data_at", Instant),
    sa.Column("revision", sa.BigInteger, nullable=False),
    sa.Column("watch", sa.JSON(none_as_null=True)),
    _device_id(),
    sa.Column("motion", sa.LargeBinary),
    sa.Index("ix_installations_stage_device_id", "stage", "device_id", postgresql_include=["device_pk"]),
    sa.Index("ix_installations_last_data_at_device_id", "last_data_at", "device_id", postgresql_include=["device_pk"]),
)

estimates = sa.Table(
    "estimates",
    metadata,
    sa.Column("pk", BIG, primary_key=True),
    _device(nullable=False),
    sa.Column("session_pk", BIG, nullable=False),  # no foreign key, as above
    sa.Column("t_first", sa.Double, nullable=False),
    sa.Column("t_last", sa.Double, nullable=False),
    sa.Column("size", sa.Integer, nullable=False),
    sa.Column("changes", sa.Integer, nullable=False),
    sa.Column("rows", sa.LargeBinary, nullable=False),
    sa.Column("received_at", Instant, nullable=False, index=True),
    sa.Index("ix_estimates_device_pk_received_at", "device_pk", "received_at"),
    sqlite_autoincrement=True,
)

estimates_coarse = sa.Table(
    "estimates_coarse",
    metadata,
    _device(primary_key=True),
    sa.Column("day", sa.Integer, primary_key=True, autoincrement=False, index=True),
    sa.Column("session_pk", BIG, primary_key=True, autoincrement=False),  # no foreign key, as above
    sa.Column("t_first", sa.Double, nullable=False),
    sa.Column("t_last", sa.Double, nullable=False),
    sa.Column("sketch", sa.LargeBinary, nullable=False),  # before `rows`: SQLite reads a long row only as far as asked
    sa.Column("rows", sa.LargeBinary, nullable=False),
)

mounts = sa.Table(
    "mounts",
    metadata,
    _device(primary_key=True),
    sa.Column("n", sa.Integer, primary_key=True, autoincrement=False),
    _session(nullable=False, index=True),
    sa.Column("t", sa.Double, nullable=False),
    sa.Column("quaternion", sa.JSON, nullable=False),
    sa.Column("sigma_deg", sa.JSON, nullable=False),
    sa.Column("verification", sa.JSON, nullable=False),
    sa.Column("status", sa.String(16), nullable=False),
    sa.Column("ended_at", Instant),
)
mount_current = mounts.c.status != sa.literal_column("'superseded'")
"""As written in the index, so that queries find it."""
sa.Index(
    "uq_mounts_current",
    mounts.c.device_pk,
    unique=True,
    sqlite_where=mount_current,
    postgresql_where=mount_current,
)
mount_suspect = mounts.c.status == sa.literal_column("'suspect'")
sa.Index("ix_mounts_suspect", mounts.c.device_pk, sqlite_where=mount_suspect, postgresql_where=mount_suspect)

motion_events = sa.Table(
    "motion_events",
    metadata,
    sa.Column("pk", BIG, primary_key=True),
    _device(nullable=False),
    sa.Column("session_pk", BIG, nullable=False),  # no foreign key, as above
    sa.Column("seq", sa.Integer, nullable=False),
    sa.Column("kind", sa.String(32), nullable=False),
    sa.Column("t", sa.Double, nullable=False),
    sa.Column("at", Instant, nullable=False),
    sa.Column("data", sa.JSON, nullable=False),
    sa.Index("ix_motion_events_device_pk_at_pk", "device_pk", "at", "pk"),
    sa.Index("ix_motion_events_device_pk_kind_at_pk", "device_pk", "kind", "at", "pk"),
    sa.Index("ix_motion_events_session_pk_kind_t", "session_pk", "kind", "t"),
    sqlite_autoincrement=True,
)

alerts = sa.Table(
    "alerts",
    metadata,
    sa.Column("pk", BIG, primary_key=True),
    _device(nullable=False),
    sa.Column("kind", sa.String(32), nullable=False),
    sa.Column("severity", sa.String(16), nullable=False),
    sa.Column("state", sa.String(16), nullable=False),
    sa.Column("opened_at", Instant, nullable=False),
    sa.Column("updated_at", Instant, nullable=False),
    sa.Column("occurrences", sa.Integer, nullable=False),
    sa.Column("message", sa.Text, nullable=False),
    sa.Column("data", sa.JSON, nullable=False),
    sa.Column("acknowledged_at", Instant),
    sa.Column("acknowledged_by", NAME),
    sa.Column("acknowledge_note", sa.Text),
    sa.Column("resolved_at", Instant),
    sa.Column("resolved_by", NAME),
    sa.Column("resolve_note", sa.Text),
    sa.Column("resolved_automatically", sa.Boolean),
    _device_id(),
    sa.Index("ix_alerts_opened_at_pk", "opened_at", "pk"),
    sa.Index("ix_alerts_device_pk_opened_at_pk", "device_pk", "opened_at", "pk"),
    sa.Index("ix_alerts_state_opened_at_pk", "state", "opened_at", "pk"),
    sa.Index("ix_alerts_kind_opened_at_pk", "kind", "opened_at", "pk"),
    sa.Index("ix_alerts_severity_opened_at_pk", "severity", "opened_at", "pk"),
    sqlite_autoincrement=True,
)
alert_unresolved = alerts.c.state != sa.literal_column("'resolved'")
"""As written in the index, so that queries find it."""
sa.Index(
    "uq_alerts_unresolved",
    alerts.c.device_pk,
    alerts.c.kind,
    unique=True,
    sqlite_where=alert_unresolved,
    postgresql_where=alert_unresolved,
)
sa.Index(
    "ix_alerts_unresolved_device_id_kind",
    alerts.c.device_id,
    alerts.c.kind,
    alerts.c.state,
    sqlite_where=alert_unresolved,
    postgresql_where=alert_unresolved,
)
"""Whether a device has open alerts, or of which kind, is asked by its id: SQLite would take the number for the index of
all alerts, and the kind alone for that of all devices."""
_of_device = (alerts.c.device_id, alerts.c.device_pk, alerts.c.state)
sa.Index(
    "ix_alerts_unresolved_kind_severity",
    alerts.c.kind,
    alerts.c.severity,
    *_of_device,
    sqlite_where=alert_unresolved,
    postgresql_where=alert_unresolved,
)
sa.Index(
    "ix_alerts_unresolved_severity",
    alerts.c.severity,
    *_of_device,
    sqlite_where=alert_unresolved,
    postgresql_where=alert_unresolved,
)
"""All that is asked about devices with such alerts is in here: `state` too, at which SQLite looks once more."""

events = sa.Table(
    "events",
    metadata,
    sa.Column("pk", BIG, primary_key=True),
    sa.Column("xact", sa.BigInteger, nullable=False),
    sa.Column("device_id", DEVICE_ID, nullable=False),
    sa.Column("type", sa.String(16), nullable=False),
    sa.Column("data", sa.Text, nullable=False),
    sa.Column("created_at", Instant, nullable=False, index=True),
    sa.Index("ix_events_xact_pk", "xact", "pk"),
    sqlite_autoincrement=True,
)

webhooks = sa.Table(
    "webhooks",
    metadata,
    sa.Column("pk", BIG, primary_key=True),
    sa.Column("url", sa.Text, nullable=False),
    sa.Column("name", NAME, nullable=False),
    sa.Column("kinds", sa.JSON(none_as_null=True)),
    sa.Column("severities", sa.JSON(none_as_null=True)),
    sa.Column("secret", sa.Text, nullable=False),
    sa.Column("active", sa.Boolean, nullable=False),
    sa.Column("created_at", Instant, nullable=False),
    sa.Column("created_by", NAME),
    sa.Column("failing_since", Instant),
    sa.Column("last_success_at", Instant),
    sqlite_autoincrement=True,
)

webhook_deliveries = sa.Table(
    "webhook_deliveries",
    metadata,
    sa.Column("pk", BIG, primary_key=True),
    sa.Column("webhook_pk", BIG, sa.ForeignKey("webhooks.pk", ondelete="CASCADE"), nullable=False),
    sa.Column("message_id", sa.String(64), nullable=False, unique=True),
    sa.Column("type", sa.String(64), nullable=False),
    sa.Column("device_id", DEVICE_ID),
    sa.Column("payload", sa.Text, nullable=False),
    sa.Column("state", sa.String(16), nullable=False),
    sa.Column("attempts", sa.Integer, nullable=False),
    sa.Column("created_at", Instant, nullable=False),
    sa.Column("next_attempt_at", Instant),
    sa.Column("last_attempt_at", Instant),
    sa.Column("last_status", sa.Integer),
    sa.Column("last_error", sa.Text),
    sa.Column("duration_ms", sa.Integer),
    sa.Column("give_up_at", Instant, nullable=False),
    sa.Column("claims", sa.Integer, nullable=False),
    sa.Column("claimed_until", Instant),
    sa.Index("ix_webhook_deliveries_webhook_pk_pk", "webhook_pk", "pk"),
    sa.Index("ix_webhook_deliveries_created_at", "created_at"),
    sqlite_autoincrement=True,
)
delivery_pending = webhook_deliveries.c.state == sa.literal_column("'pending'")
"""As written in the index, so that queries find it."""
sa.Index(
    "ix_webhook_deliveries_pending",
    webhook_deliveries.c.webhook_pk,
    webhook_deliveries.c.device_id,
    webhook_deliveries.c.pk,
    sqlite_where=delivery_pending,
    postgresql_where=delivery_pending,
)
sa.Index(
    "ix_webhook_deliveries_due",
    webhook_deliveries.c.webhook_pk,
    webhook_deliveries.c.next_attempt_at,
    webhook_deliveries.c.pk,
    sqlite_where=delivery_pending,
    postgresql_where=delivery_pending,
)

audit = sa.Table(
    "audit",
    metadata,
    sa.Column("pk", BIG, primary_key=True),
    sa.Column("at", Instant, nullable=False, index=True),
    sa.Column("actor", NAME, nullable=False),
    sa.Column("key_pk", BIG),
    sa.Column("role", sa.String(16), nullable=False),
    sa.Column("action", sa.String(64), nullable=False),
    sa.Column("target", NAME),
    sa.Column("detail", sa.JSON(none_as_null=True)),
    sa.Column("request_id", sa.String(64)),
    sqlite_autoincrement=True,
)

leases = sa.Table(
    "leases",
    metadata,
    sa.Column("name", sa.String(64), primary_key=True),
    sa.Column("holder", sa.String(64), nullable=False),
    sa.Column("until", Instant, nullable=False),
)
