"""The first tables."""

import sqlalchemy as sa
from alembic import op

revision = "0001"
down_revision = None
branch_labels = None
depends_on = None

BIG = sa.BigInteger().with_variant(sa.Integer(), "sqlite")
DEVICE_ID = sa.String(64).with_variant(sa.String(64, collation="C"), "postgresql")


def upgrade() -> None:
    op.create_table(
        "devices",
        sa.Column("pk", BIG, nullable=False),
        sa.Column("id", DEVICE_ID, nullable=False),
        sa.Column("name", sa.String(length=128), nullable=False),
        sa.Column("vehicle", sa.String(length=128), nullable=True),
        sa.Column("notes", sa.Text(), nullable=True),
        sa.Column("created_at", sa.BigInteger(), nullable=False),
        sa.PrimaryKeyConstraint("pk", name="pk_devices"),
        sa.UniqueConstraint("id", name="uq_devices_id"),
        sqlite_autoincrement=True,
    )
    op.create_table(
        "events",
        sa.Column("pk", BIG, nullable=False),
        sa.Column("xact", sa.BigInteger(), nullable=False),
        sa.Column("device_id", DEVICE_ID, nullable=False),
        sa.Column("type", sa.String(length=16), nullable=False),
        sa.Column("data", sa.Text(), nullable=False),
        sa.Column("created_at", sa.BigInteger(), nullable=False),
        sa.PrimaryKeyConstraint("pk", name="pk_events"),
        sqlite_autoincrement=True,
    )
    op.create_index("ix_events_created_at", "events", ["created_at"], unique=False)
    op.create_index("ix_events_xact_pk", "events", ["xact", "pk"], unique=False)
    op.create_table(
        "meta",
        sa.Column("name", sa.String(length=64), nullable=False),
        sa.Column("value", sa.Text(), nullable=False),
        sa.PrimaryKeyConstraint("name", name="pk_meta"),
    )
    op.create_table(
        "alerts",
        sa.Column("pk", BIG, nullable=False),
        sa.Column("device_pk", BIG, nullable=False),
        sa.Column("kind", sa.String(length=32), nullable=False),
        sa.Column("severity", sa.String(length=16), nullable=False),
        sa.Column("state", sa.String(length=16), nullable=False),
        sa.Column("opened_at", sa.BigInteger(), nullable=False),
        sa.Column("updated_at", sa.BigInteger(), nullable=False),
        sa.Column("occurrences", sa.Integer(), nullable=False),
        sa.Column("message", sa.Text(), nullable=False),
        sa.Column("data", sa.JSON(), nullable=False),
        sa.Column("acknowledged_at", sa.BigInteger(), nullable=True),
        sa.Column("acknowledged_by", sa.String(length=128), nullable=True),
        sa.Column("acknowledge_note", sa.Text(), nullable=True),
        sa.Column("resolved_at", sa.BigInteger(), nullable=True),
        sa.Column("resolved_by", sa.String(length=128), nullable=True),
        sa.Column("resolve_note", sa.Text(), nullable=True),
        sa.ForeignKeyConstraint(["device_pk"], ["devices.pk"], name="fk_alerts_device_pk", ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("pk", name="pk_alerts"),
        sqlite_autoincrement=True,
    )
    op.create_index("ix_alerts_device_pk_pk", "alerts", ["device_pk", "pk"], unique=False)
    op.create_index(
        "uq_alerts_unresolved",
        "alerts",
        ["device_pk", "kind"],
        unique=True,
        sqlite_where=sa.text("state != 'resolved'"),
        postgresql_where=sa.text("state != 'resolved'"),
    )
    op.create_table(
        "api_keys",
        sa.Column("pk", BIG, nullable=False),
        sa.Column("digest", sa.LargeBinary(length=32), nullable=False),
        sa.Column("role", sa.String(length=16), nullable=False),
        sa.Column("name", sa.String(length=128), nullable=False),
        sa.Column("device_pk", BIG, nullable=True),
        sa.Column("source", sa.String(length=16), nullable=False),
        sa.Column("created_at", sa.BigInteger(), nullable=False),
        sa.ForeignKeyConstraint(["device_pk"], ["devices.pk"], name="fk_api_keys_device_pk", ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("pk", name="pk_api_keys"),
        sa.UniqueConstraint("digest", name="uq_api_keys_digest"),
        sqlite_autoincrement=True,
    )
    op.create_index("ix_api_keys_device_pk", "api_keys", ["device_pk"], unique=False)
    op.create_table(
        "installations",
        sa.Column("device_pk", BIG, nullable=False),
        sa.Column("snapshot", sa.LargeBinary(), nullable=True),
        sa.Column("session_pk", BIG, nullable=True),
        sa.Column("stage", sa.String(length=16), nullable=False),
        sa.Column("since_session_pk", BIG, nullable=True),
        sa.Column("since_t", sa.Double(), nullable=True),
        sa.Column("since_at", sa.BigInteger(), nullable=False),
        sa.Column("status", sa.JSON(), nullable=False),
        sa.Column("last_data_at", sa.BigInteger(), nullable=True),
        sa.Column("revision", sa.BigInteger(), nullable=False),
        sa.ForeignKeyConstraint(["device_pk"], ["devices.pk"], name="fk_installations_device_pk", ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("device_pk", name="pk_installations"),
    )
    op.create_index("ix_installations_stage", "installations", ["stage"], unique=False)
    op.create_table(
        "sessions",
        sa.Column("pk", BIG, nullable=False),
        sa.Column("device_pk", BIG, nullable=False),
        sa.Column("name", sa.String(length=128), nullable=False),
        sa.Column("next_seq", sa.Integer(), nullable=False),
        sa.Column("context", sa.JSON(none_as_null=True), nullable=True),
        sa.Column("started_at", sa.BigInteger(), nullable=True),
        sa.Column("created_at", sa.BigInteger(), nullable=False),
        sa.ForeignKeyConstraint(["device_pk"], ["devices.pk"], name="fk_sessions_device_pk", ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("pk", name="pk_sessions"),
        sa.UniqueConstraint("device_pk", "name", name="uq_sessions_device_pk_name"),
        sqlite_autoincrement=True,
    )
    op.create_table(
        "chunks",
        sa.Column("session_pk", BIG, nullable=False),
        sa.Column("seq", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("digest", sa.String(length=64), nullable=False),
        sa.Column("state", sa.String(length=16), nullable=False),
        sa.Column("samples", sa.Integer(), nullable=False),
        sa.Column("fixes", sa.Integer(), nullable=False),
        sa.Column("rejected", sa.JSON(), nullable=False),
        sa.Column("received_at", sa.BigInteger(), nullable=False),
        sa.Column("body", sa.LargeBinary(), nullable=True),
        sa.Column("content_type", sa.Text(), nullable=True),
        sa.Column("content_encoding", sa.Text(), nullable=True),
        sa.Column("course", sa.String(length=16), nullable=True),
        sa.ForeignKeyConstraint(["session_pk"], ["sessions.pk"], name="fk_chunks_session_pk", ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("session_pk", "seq", name="pk_chunks"),
    )
    op.create_index("ix_chunks_received_at", "chunks", ["received_at"], unique=False)
    op.create_index(
        "ix_chunks_waiting",
        "chunks",
        ["session_pk"],
        unique=False,
        sqlite_where=sa.text("state = 'waiting'"),
        postgresql_where=sa.text("state = 'waiting'"),
    )
    op.create_table(
        "estimates",
        sa.Column("pk", BIG, nullable=False),
        sa.Column("session_pk", BIG, nullable=False),
        sa.Column("t_first", sa.Double(), nullable=False),
        sa.Column("t_last", sa.Double(), nullable=False),
        sa.Column("size", sa.Integer(), nullable=False),
        sa.Column("changes", sa.Integer(), nullable=False),
        sa.Column("rows", sa.LargeBinary(), nullable=False),
        sa.Column("received_at", sa.BigInteger(), nullable=False),
        sa.ForeignKeyConstraint(["session_pk"], ["sessions.pk"], name="fk_estimates_session_pk", ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("pk", name="pk_estimates"),
        sqlite_autoincrement=True,
    )
    op.create_index("ix_estimates_received_at", "estimates", ["received_at"], unique=False)
    op.create_index("ix_estimates_session_pk_pk", "estimates", ["session_pk", "pk"], unique=False)
    op.create_table(
        "mounts",
        sa.Column("device_pk", BIG, nullable=False),
        sa.Column("n", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("session_pk", BIG, nullable=False),
        sa.Column("t", sa.Double(), nullable=False),
        sa.Column("quaternion", sa.JSON(), nullable=False),
        sa.Column("sigma_deg", sa.JSON(), nullable=False),
        sa.Column("verification", sa.JSON(), nullable=False),
        sa.Column("status", sa.String(length=16), nullable=False),
        sa.ForeignKeyConstraint(["device_pk"], ["devices.pk"], name="fk_mounts_device_pk", ondelete="CASCADE"),
        sa.ForeignKeyConstraint(["session_pk"], ["sessions.pk"], name="fk_mounts_session_pk", ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("device_pk", "n", name="pk_mounts"),
    )
    op.create_index("ix_mounts_session_pk", "mounts", ["session_pk"], unique=False)


def downgrade() -> None:
    for table in (
        "mounts",
        "estimates",
        "chunks",
        "sessions",
        "installations",
        "api_keys",
        "alerts",
        "meta",
        "events",
        "devices",
    ):
        op.drop_table(table)
