"""The estimator's state is packed by PostgreSQL with lz4: its own way takes a fifth of all that an upload costs it."""

import sqlalchemy as sa
from alembic import op

revision = "0007"
down_revision = "0006"
branch_labels = None
depends_on = None

KNOWS_LZ4 = "SELECT 'lz4' = ANY(enumvals) FROM pg_settings WHERE name = 'default_toast_compression'"
"""not so where the server was built without it, or is older than PostgreSQL 14"""


def upgrade() -> None:
    """States that are there already are packed anew when they change."""
    _pack_by("lz4")


def downgrade() -> None:
    _pack_by("default")


def _pack_by(method: str) -> None:
    connection = op.get_bind()
    if connection.dialect.name == "postgresql" and connection.execute(sa.text(KNOWS_LZ4)).scalar():
        op.execute(f"ALTER TABLE installations ALTER COLUMN snapshot SET COMPRESSION {method}")
