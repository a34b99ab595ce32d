"""What a fleet needs: expiring keys, webhooks with their deliveries, an audit trail, rules' memory, leases.

History is found by device and time from now on, however many sessions a device has had, and ages into coarse history.
Lists come from an index in their order, and what is searched is one text.
"""

import sqlalchemy as sa
from alembic import op

revision = "0003"
down_revision = "0002"
branch_labels = None
depends_on = None

BIG = sa.BigInteger().with_variant(sa.Integer(), "sqlite")
DEVICE_ID = sa.String(64).with_variant(sa.String(64, collation="C"), "postgresql")

ADDED = (
    ("api_keys", "prefix", sa.String(16)),
    ("api_keys", "last_used_at", sa.BigInteger()),
    ("api_keys", "expires_at", sa.BigInteger()),
    ("api_keys", "created_by", sa.String(128)),
    ("installations", "watch", sa.JSON(none_as_null=True)),
    ("alerts", "resolved_automatically", sa.Boolean()),
)
COPIES = (
    ("devices", "search", sa.Text()),
    ("installations", "device_id", DEVICE_ID),
    ("alerts", "device_id", DEVICE_ID),
)
INDEXES = (
    ("ix_sessions_device_pk_pk", "sessions", ["device_pk", "pk"]),
    ("ix_installations_last_data_at", "installations", ["last_data_at"]),
    ("ix_installations_stage_device_id", "installations", ["stage", "device_id"]),
    ("ix_alerts_opened_at_pk", "alerts", ["opened_at", "pk"]),
    ("ix_alerts_device_pk_opened_at_pk", "alerts", ["device_pk", "opened_at", "pk"]),
    ("ix_alerts_state_opened_at_pk", "alerts", ["state", "opened_at", "pk"]),
    ("ix_alerts_kind_opened_at_pk", "alerts", ["kind", "opened_at", "pk"]),
    ("ix_alerts_severity_opened_at_pk", "alerts", ["severity", "opened_at", "pk"]),
)
SEARCH_INDEX = "ix_devices_id_search"
MOUNT_INDEX = "uq_mounts_current"
NOT_SUPERSEDED = sa.text("status != 'superseded'")
UNRESOLVED = sa.text("state != 'resolved'")
UNRESOLVED_INDEXES = (
    ("ix_alerts_unresolved_device_id", ["device_id", "device_pk"]),
    ("ix_alerts_unresolved_kind_severity", ["kind", "severity"]),
)
FORMER_INDEXES = (
    ("ix_installations_stage", "installations", ["stage"]),
    ("ix_alerts_device_pk_pk", "alerts", ["device_pk", "pk"]),
)
"""Columns and indexes for tables that are there; in a batch only where nothing refers to the table, see 0002."""
AUTOINCREMENT = {"sqlite_autoincrement": True}
"""SQLite's copy of a table has to be told."""


def upgrade() -> None:
    for table, name, kind in ADDED:
        op.add_column(table, sa.Column(name, kind, nullable=True))
    for table, name, kind in COPIES:
        op.add_column(table, sa.Column(name, kind, nullable=False, server_default=""))
    _fill_copies()
    for name, table, columns in INDEXES:
        op.create_index(name, table, columns, unique=False)
    if op.get_bind().dialect.name == "sqlite":
        op.create_index(SEARCH_INDEX, "devices", ["id", "search"], unique=False)
    for name, table, _ in FORMER_INDEXES:
        op.drop_index(name, table_name=table)
    for name, columns in UNRESOLVED_INDEXES:
        op.create_index(name, "alerts", columns, unique=False, sqlite_where=UNRESOLVED, postgresql_where=UNRESOLVED)
    op.create_index(
        MOUNT_INDEX, "mounts", ["device_pk"], unique=True, sqlite_where=NOT_SUPERSEDED, postgresql_where=NOT_SUPERSEDED
    )
    _webhooks()
    _deliveries()
    _audit()
    _history()
    _sign_ins()
    op.execute("DELETE FROM meta WHERE name = 'cookie_secret'")  # signed the cookies that `sign_ins` replaces
    op.create_table(
        "leases",
        sa.Column("name", sa.String(64), nullable=False),
        sa.Column("holder", sa.String(64), nullable=False),
        sa.Column("until", sa.BigInteger(), nullable=False),
        sa.PrimaryKeyConstraint("name", name="pk_leases"),
    )


def _fill_copies() -> None:
    for table in ("installations", "alerts"):
        op.execute(f"UPDATE {table} SET device_id = (SELECT id FROM devices WHERE devices.pk = {table}.device_pk)")  # noqa: S608
    connection = op.get_bind()
    rows = connection.execute(sa.text("SELECT pk, id, name, vehicle, notes FROM devices")).all()
    texts = [{"pk": pk, "search": "\n".join(filter(None, words)).casefold()[:1000]} for pk, *words in rows]
    if texts:
        connection.execute(sa.text("UPDATE devices SET search = :search WHERE pk = :pk"), texts)


def _webhooks() -> None:
    op.create_table(
        "webhooks",
        sa.Column("pk", BIG, nullable=False),
        sa.Column("url", sa.Text(), nullable=False),
        sa.Column("name", sa.String(128), nullable=False),
        sa.Column("kinds", sa.JSON(none_as_null=True), nullable=True),
        sa.Column("severities", sa.JSON(none_as_null=True), nullable=True),
        sa.Column("secret", sa.Text(), nullable=False),
        sa.Column("active", sa.Boolean(), nullable=False),
        sa.Column("created_at", sa.BigInteger(), nullable=False),
        sa.Column("created_by", sa.String(128), nullable=True),
        sa.Column("failing_since", sa.BigInteger(), nullable=True),
        sa.Column("last_success_at", sa.BigInteger(), nullable=True),
        sa.PrimaryKeyConstraint("pk", name="pk_webhooks"),
        sqlite_autoincrement=True,
    )


def _deliveries() -> None:
    op.create_table(
        "webhook_deliveries",
        sa.Column("pk", BIG, nullable=False),
        sa.Column("webhook_pk", BIG, nullable=False),
        sa.Column("message_id", sa.String(64), nullable=False),
        sa.Column("type", sa.String(64), nullable=False),
        sa.Column("device_id", DEVICE_ID, nullable=True),
        sa.Column("payload", sa.Text(), nullable=False),
        sa.Column("state", sa.String(16), nullable=False),
        sa.Column("attempts", sa.Integer(), nullable=False),
        sa.Column("created_at", sa.BigInteger(), nullable=False),
        sa.Column("next_attempt_at", sa.BigInteger(), nullable=True),
        sa.Column("last_attempt_at", sa.BigInteger(), nullable=True),
        sa.Column("last_status", sa.Integer(), nullable=True),
        sa.Column("last_error", sa.Text(), nullable=True),
        sa.Column("duration_ms", sa.Integer(), nullable=True),
        sa.Column("give_up_at", sa.BigInteger(), nullable=False),
        sa.Column("claims", sa.Integer(), nullable=False),
        sa.Column("claimed_until", sa.BigInteger(), nullable=True),
        sa.ForeignKeyConstraint(
            ["webhook_pk"], ["webhooks.pk"], name="fk_webhook_deliveries_webhook_pk", ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("pk", name="pk_webhook_deliveries"),
        sa.UniqueConstraint("message_id", name="uq_webhook_deliveries_message_id"),
        sqlite_autoincrement=True,
    )
    op.create_index("ix_webhook_deliveries_webhook_pk_pk", "webhook_deliveries", ["webhook_pk", "pk"], unique=False)
    pending = sa.text("state = 'pending'")
    for name, columns in (
        ("ix_webhook_deliveries_pending", ["webhook_pk", "device_id", "pk"]),
        ("ix_webhook_deliveries_due", ["webhook_pk", "next_attempt_at", "pk"]),
    ):
        op.create_index(
            name, "webhook_deliveries", columns, unique=False, sqlite_where=pending, postgresql_where=pending
        )
    op.create_index("ix_webhook_deliveries_created_at", "webhook_deliveries", ["created_at"], unique=False)


def _audit() -> None:
    op.create_table(
        "audit",
        sa.Column("pk", BIG, nullable=False),
        sa.Column("at", sa.BigInteger(), nullable=False),
        sa.Column("actor", sa.String(128), nullable=False),
        sa.Column("key_pk", BIG, nullable=True),
        sa.Column("role", sa.String(16), nullable=False),
        sa.Column("action", sa.String(64), nullable=False),
        sa.Column("target", sa.String(128), nullable=True),
        sa.Column("detail", sa.JSON(none_as_null=True), nullable=True),
        sa.Column("request_id", sa.String(64), nullable=True),
        sa.PrimaryKeyConstraint("pk", name="pk_audit"),
        sqlite_autoincrement=True,
    )
    op.create_index("ix_audit_at", "audit", ["at"], unique=False)


def _history() -> None:
    op.add_column("estimates", sa.Column("device_pk", BIG, nullable=True))
    op.execute(
        "UPDATE estimates SET device_pk = (SELECT device_pk FROM sessions WHERE sessions.pk = estimates.session_pk)"
    )
    op.drop_index("ix_estimates_session_pk_pk", table_name="estimates")
    with op.batch_alter_table("estimates", table_kwargs=AUTOINCREMENT) as table:
        table.drop_constraint("fk_estimates_session_pk", type_="foreignkey")
        table.alter_column("device_pk", existing_type=BIG, nullable=False)
        table.create_foreign_key("fk_estimates_device_pk", "devices", ["device_pk"], ["pk"], ondelete="CASCADE")
    op.create_index("ix_estimates_device_pk_received_at", "estimates", ["device_pk", "received_at"], unique=False)
    op.create_table(
        "estimates_coarse",
        sa.Column("device_pk", BIG, nullable=False),
        sa.Column("day", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("session_pk", BIG, autoincrement=False, nullable=False),
        sa.Column("t_first", sa.Double(), nullable=False),
        sa.Column("t_last", sa.Double(), nullable=False),
        sa.Column("sketch", sa.LargeBinary(), nullable=False),
        sa.Column("rows", sa.LargeBinary(), nullable=False),
        sa.ForeignKeyConstraint(
            ["device_pk"], ["devices.pk"], name="fk_estimates_coarse_device_pk", ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("device_pk", "day", "session_pk", name="pk_estimates_coarse"),
    )
    op.create_index("ix_estimates_coarse_day", "estimates_coarse", ["day"], unique=False)


def _history_undone() -> None:
    op.drop_table("estimates_coarse")
    op.drop_index("ix_estimates_device_pk_received_at", table_name="estimates")
    with op.batch_alter_table("estimates", table_kwargs=AUTOINCREMENT) as table:
        table.drop_constraint("fk_estimates_device_pk", type_="foreignkey")
        table.drop_column("device_pk")
        table.create_foreign_key("fk_estimates_session_pk", "sessions", ["session_pk"], ["pk"], ondelete="CASCADE")
    op.create_index("ix_estimates_session_pk_pk", "estimates", ["session_pk", "pk"], unique=False)


def _sign_ins() -> None:
    op.create_table(
        "sign_ins",
        sa.Column("pk", BIG, nullable=False),
        sa.Column("digest", sa.LargeBinary(32), nullable=False),
        sa.Column("key_pk", BIG, nullable=False),
        sa.Column("created_at", sa.BigInteger(), nullable=False),
        sa.Column("expires_at", sa.BigInteger(), nullable=False),
        sa.ForeignKeyConstraint(["key_pk"], ["api_keys.pk"], name="fk_sign_ins_key_pk", ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("pk", name="pk_sign_ins"),
        sa.UniqueConstraint("digest", name="uq_sign_ins_digest"),
        sqlite_autoincrement=True,
    )
    op.create_index("ix_sign_ins_key_pk", "sign_ins", ["key_pk"], unique=False)
    op.create_index("ix_sign_ins_expires_at", "sign_ins", ["expires_at"], unique=False)


def downgrade() -> None:
    for table in ("sign_ins", "leases", "audit", "webhook_deliveries", "webhooks"):
        op.drop_table(table)
    _history_undone()
    op.drop_index(MOUNT_INDEX, table_name="mounts")
    for name, _ in UNRESOLVED_INDEXES:
        op.drop_index(name, table_name="alerts")
    for name, table, columns in FORMER_INDEXES:
        op.create_index(name, table, columns, unique=False)
    if op.get_bind().dialect.name == "sqlite":
        op.drop_index(SEARCH_INDEX, table_name="devices")
    for name, table, _ in reversed(INDEXES):
        op.drop_index(name, table_name=table)
    for table, name, _ in (*reversed(COPIES), *reversed(ADDED)):
        op.drop_column(table, name)
