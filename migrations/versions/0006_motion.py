"""Samples as they came, events of the vehicle's motion, the class of a vehicle, the end of a mounting."""

from typing import Any

import sqlalchemy as sa
from alembic import op

revision = "0006"
down_revision = "0005"
branch_labels = None
depends_on = None

BIG = sa.BigInteger().with_variant(sa.Integer(), "sqlite")
ADDED = (
    ("devices", "vehicle_class", sa.String(16)),
    ("installations", "motion", sa.LargeBinary()),
    ("mounts", "ended_at", sa.BigInteger()),
)
MAY_GO: dict[str, Any] = {"sqlite_where": sa.text("kept = 0"), "postgresql_where": sa.text("kept = false")}


def upgrade() -> None:
    for table, name, kind in ADDED:
        op.add_column(table, sa.Column(name, kind, nullable=True))
    _raw_chunks()
    _motion_events()


def _raw_chunks() -> None:
    op.create_table(
        "raw_chunks",
        sa.Column("session_pk", BIG, autoincrement=False, nullable=False),
        sa.Column("seq", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("device_pk", BIG, nullable=False),
        sa.Column("t_first", sa.Double(), nullable=False),
        sa.Column("t_last", sa.Double(), nullable=False),
        sa.Column("received_at", sa.BigInteger(), nullable=False),
        sa.Column("kept", sa.Boolean(), nullable=False),
        sa.Column("columns", sa.String(128), nullable=False),
        sa.Column("content", sa.LargeBinary(), nullable=False),
        _of_device("raw_chunks"),
        sa.PrimaryKeyConstraint("session_pk", "seq", name="pk_raw_chunks"),
    )
    op.create_index("ix_raw_chunks_device_pk_received_at", "raw_chunks", ["device_pk", "received_at"], unique=False)
    op.create_index("ix_raw_chunks_may_go", "raw_chunks", ["received_at"], unique=False, **MAY_GO)
    if op.get_bind().dialect.name == "postgresql":  # packed already: nothing is gained by trying once more
        op.execute("ALTER TABLE raw_chunks ALTER COLUMN content SET STORAGE EXTERNAL")


def _motion_events() -> None:
    op.create_table(
        "motion_events",
        sa.Column("pk", BIG, nullable=False),
        sa.Column("device_pk", BIG, nullable=False),
        sa.Column("session_pk", BIG, nullable=False),
        sa.Column("seq", sa.Integer(), nullable=False),
        sa.Column("kind", sa.String(32), nullable=False),
        sa.Column("t", sa.Double(), nullable=False),
        sa.Column("at", sa.BigInteger(), nullable=False),
        sa.Column("data", sa.JSON(), nullable=False),
        _of_device("motion_events"),
        sa.PrimaryKeyConstraint("pk", name="pk_motion_events"),
        sqlite_autoincrement=True,
    )
    for columns in (["device_pk", "at", "pk"], ["device_pk", "kind", "at", "pk"], ["session_pk", "kind", "t"]):
        op.create_index(f"ix_motion_events_{'_'.join(columns)}", "motion_events", columns, unique=False)


def _of_device(table: str) -> sa.ForeignKeyConstraint:
    return sa.ForeignKeyConstraint(["device_pk"], ["devices.pk"], name=f"fk_{table}_device_pk", ondelete="CASCADE")


def downgrade() -> None:
    op.drop_table("motion_events")
    op.drop_table("raw_chunks")
    for table, name, _ in reversed(ADDED):
        op.drop_column(table, name)
