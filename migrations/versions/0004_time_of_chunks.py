"""First and last time of each chunk on its session's clock, so that the rates at which a device measures are known."""

import sqlalchemy as sa
from alembic import op

revision = "0004"
down_revision = "0003"
branch_labels = None
depends_on = None

COLUMNS = ("t_first", "t_last")


def upgrade() -> None:
    for name in COLUMNS:
        op.add_column("chunks", sa.Column(name, sa.Double(), nullable=True))


def downgrade() -> None:
    for name in reversed(COLUMNS):
        op.drop_column("chunks", name)
