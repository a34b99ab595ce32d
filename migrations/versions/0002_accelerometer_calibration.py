"""Gains and offset of each device's accelerometer."""

import sqlalchemy as sa
from alembic import op

revision = "0002"
down_revision = "0001"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column("devices", sa.Column("accelerometer_calibration", sa.JSON(none_as_null=True), nullable=True))


def downgrade() -> None:
    # not in a batch, which on SQLite drops the table and with it, by ON DELETE CASCADE, everything of every device
    op.drop_column("devices", "accelerometer_calibration")
