"""What is counted for monitoring and for nothing else."""

import sqlalchemy as sa

from storage.database import ReadSession
from storage.models import delivery_pending, webhook_deliveries

_backlog = sa.select(sa.func.count()).select_from(webhook_deliveries).where(delivery_pending)


def webhook_backlog(tx: ReadSession) -> int:
    """Count the messages to webhooks that are still to be delivered."""
    return int(tx.value(_backlog))
