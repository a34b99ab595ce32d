"""Lists of devices by name and by last data, and by what their open alerts are; counts of devices."""

import sqlalchemy as sa
from alembic import op

revision = "0004"
down_revision = "0003"
branch_labels = None
depends_on = None

NAME_KEY = sa.Text().with_variant(sa.Text(collation="C"), "postgresql")
NAME_INDEX = {"sqlite": ["name_key", "id", "search"], "postgresql": ["name_key", "id"]}
UNRESOLVED = sa.text("state != 'resolved'")
SUSPECT = sa.text("status = 'suspect'")
FORMER_COLUMNS = ["kind", "severity"]
SEEN = ["device_id", "device_pk", "state"]


def upgrade() -> None:
    op.add_column("devices", sa.Column("name_key", NAME_KEY, nullable=False, server_default=""))
    _fill_keys()
    columns = _name_columns()
    op.create_index(f"ix_devices_{'_'.join(columns)}", "devices", columns, unique=False)
    op.create_index(
        "ix_installations_last_data_at_device_id", "installations", ["last_data_at", "device_id"], unique=False
    )
    op.drop_index("ix_installations_last_data_at", table_name="installations")
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


def _name_columns() -> list[str]:
    return NAME_INDEX[op.get_bind().dialect.name]


def _index_unresolved(name: str, columns: list[str]) -> None:
    op.create_index(name, "alerts", columns, unique=False, sqlite_where=UNRESOLVED, postgresql_where=UNRESOLVED)


def downgrade() -> None:
    op.drop_index("ix_mounts_suspect", table_name="mounts")
    op.drop_index("ix_alerts_unresolved_severity", table_name="alerts")
    op.drop_index("ix_alerts_unresolved_kind_severity", table_name="alerts")
    _index_unresolved("ix_alerts_unresolved_kind_severity", FORMER_COLUMNS)
    op.create_index("ix_installations_last_data_at", "installations", ["last_data_at"], unique=False)
    op.drop_index("ix_installations_last_data_at_device_id", table_name="installations")
    op.drop_index(f"ix_devices_{'_'.join(_name_columns())}", table_name="devices")
    op.drop_column("devices", "name_key")
