"""Lists of devices by name and by last data, and by what their open alerts are; counts of devices."""

import sqlalchemy as sa
from alembic import op

revision = "0005"
down_revision = "0004"
branch_labels = None
depends_on = None

NAME_KEY = sa.Text().with_variant(sa.Text(collation="C"), "postgresql")
DEVICE_INDEXES = {"sqlite": (["name_key", "id", "search"],), "postgresql": (["id"], ["name_key", "id"])}
UNRESOLVED = sa.text("state != 'resolved'")
SUSPECT = sa.text("status = 'suspect'")
FORMER_COLUMNS = ["kind", "severity"]
SEEN = ["device_id", "device_pk", "state"]


def upgrade() -> None:
    op.add_column("devices", sa.Column("name_key", NAME_KEY, nullable=False, server_default=""))
    _fill_keys()
    for columns in DEVICE_INDEXES[op.get_bind().dialect.name]:
        _index("devices", columns, "pk")
    for name in ("ix_installations_last_data_at", "ix_installations_stage_device_id"):
        op.drop_index(name, table_name="installations")
    for column in ("stage", "last_data_at"):
        _index("installations", [column, "device_id"], "device_pk")
    op.drop_index("ix_alerts_unresolved_kind_severity", table_name="alerts")
    _index_unresolved("ix_alerts_unresolved_kind_severity", [*FORMER_COLUMNS, *SEEN])
    _index_unresolved("ix_alerts_unresolved_severity", ["severity", *SEEN])
    op.create_index(
        "ix_mounts_suspect", "mounts", ["device_pk"], unique=False, sqlite_where=SUSPECT, postgresql_where=SUSPECT
    )


def _fill_keys() -> None:
    connection = op.get_bind()
    rows = connection.execute(sa.text("SELECT pk, name FROM devices")).all()
    if rows:
        keys = [{"pk": pk, "key": name.casefold()} for pk, name in rows]
        connection.execute(sa.text("UPDATE devices SET name_key = :key WHERE pk = :pk"), keys)


def _index(table: str, columns: list[str], pk: str) -> None:
    op.create_index(_name(table, columns), table, columns, unique=False, postgresql_include=[pk])


def _name(table: str, columns: list[str]) -> str:
    return f"ix_{table}_{'_'.join(columns)}"


def _index_unresolved(name: str, columns: list[str]) -> None:
    op.create_index(name, "alerts", columns, unique=False, sqlite_where=UNRESOLVED, postgresql_where=UNRESOLVED)


def downgrade() -> None:
    op.drop_index("ix_mounts_suspect", table_name="mounts")
    op.drop_index("ix_alerts_unresolved_severity", table_name="alerts")
    op.drop_index("ix_alerts_unresolved_kind_severity", table_name="alerts")
    _index_unresolved("ix_alerts_unresolved_kind_severity", FORMER_COLUMNS)
    for column in ("stage", "last_data_at"):
        op.drop_index(f"ix_installations_{column}_device_id", table_name="installations")
    op.create_index("ix_installations_last_data_at", "installations", ["last_data_at"], unique=False)
    op.create_index("ix_installations_stage_device_id", "installations", ["stage", "device_id"], unique=False)
    for columns in DEVICE_INDEXES[op.get_bind().dialect.name]:
        op.drop_index(_name("devices", columns), table_name="devices")
    op.drop_column("devices", "name_key")
