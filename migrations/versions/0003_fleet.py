"""What a fleet needs: expiring keys, webhooks with their deliveries, an audit trail, rules' memory, leases."""

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
INDEXES = (
    ("ix_alerts_state_pk", "alerts", ["state", "pk"]),
    ("ix_installations_last_data_at", "installations", ["last_data_at"]),
)
"""Columns and indexes for tables that are there; columns never in a batch, see 0002."""


def upgrade() -> None:
    for table, name, kind in ADDED:
        op.add_column(table, sa.Column(name, kind, nullable=True))
    for name, table, columns in INDEXES:
        op.create_index(name, table, columns, unique=False)
    _webhooks()
    _deliveries()
    _audit()
    _sign_ins()
    op.execute("DELETE FROM meta WHERE name = 'cookie_secret'")  # signed the cookies that `sign_ins` replaces
    op.create_table(
        "leases",
        sa.Column("name", sa.String(64), nullable=False),
        sa.Column("holder", sa.String(64), nullable=False),
        sa.Column("until", sa.BigInteger(), nullable=False),
        sa.PrimaryKeyConstraint("name", name="pk_leases"),
    )


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
    for name, table, _ in reversed(INDEXES):
        op.drop_index(name, table_name=table)
    for table, name, _ in reversed(ADDED):
        op.drop_column(table, name)
