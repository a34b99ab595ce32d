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
FORMER_UNRESOLVED = {"device_id": ["device_id", "device_pk"], "kind_severity": ["kind", "severity"]}
UNRESOLVED_INDEXES = {
    "device_id_kind": ["device_id", "kind", "state"],
    "kind_severity": ["kind", "severity", "device_id", "device_pk", "state"],
    "severity": ["severity", "device_id", "device_pk", "state"],
}


def upgrade() -> None:
    op.add_column("devices", sa.Column("name_key", NAME_KEY, nullable=False, server_default=""))
    _fill_keys()
    for columns in DEVICE_INDEXES[op.get_bind().dialect.name]:
        _index("devices", columns, "pk")
    for name in ("ix_installations_last_data_at", "ix_installations_stage_device_id"):
        op.drop_index(name, table_name="installations")
    for column in ("stage", "last_data_at"):
        _index("installations", [column, "device_id"], "device_pk")
    _replace_unresolved(FORMER_UNRESOLVED, UNRESOLVED_INDEXES)
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


def _replace_unresolved(former: dict[str, list[str]], new: dict[str, list[str]]) -> None:
    for name in former:
        op.drop_index(f"ix_alerts_unresolved_{name}", table_name="alerts")
    for name, columns in new.items():
        op.create_index(
            f"ix_alerts_unresolved_{name}",
            "alerts",
            columns,
            unique=False,
            sqlite_where=UNRESOLVED,
            postgresql_where=UNRESOLVED,
        )


def downgrade() -> None:
    op.drop_index("ix_mounts_suspect", table_name="mounts")
    _replace_unresolved(UNRESOLVED_INDEXES, FORMER_UNRESOLVED)
    for column in ("stage", "last_data_at"):
        op.drop_index(f"ix_installations_{column}_device_id", table_name="installations")
    op.create_index("ix_installations_last_data_at", "installations", ["last_data_at"], unique=False)
    op.create_index("ix_installations_stage_device_id", "installations", ["stage", "device_id"], unique=False)
    for columns in DEVICE_INDEXES[op.get_bind().dialect.name]:
        op.drop_index(_name("devices", columns), table_name="devices")
    op.drop_column("devices", "name_key")
