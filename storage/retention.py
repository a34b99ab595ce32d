"""Removal of what is kept no longer, a bounded number of rows at a time, oldest first."""

from datetime import datetime

import sqlalchemy as sa

from storage.chunks import APPLIED
from storage.database import WriteSession
from storage.models import audit, chunks, delivery_pending, estimates_coarse, sign_ins, webhook_deliveries


def _removal(column: sa.Column[datetime] | sa.Column[int], *kept: sa.ColumnElement[bool]) -> sa.Delete:
    table = column.table
    keys = tuple(table.primary_key)
    oldest = (
        sa.select(*keys)
        .where(column < sa.bindparam("before", type_=column.type), *kept)
        .order_by(column)
        .limit(sa.bindparam("limit"))
    )
    return sa.delete(table).where(sa.tuple_(*keys).in_(oldest))


_receipts = _removal(chunks.c.received_at, chunks.c.state == APPLIED)
_deliveries = _removal(webhook_deliveries.c.created_at, ~delivery_pending)
_audit = _removal(audit.c.at)
_sign_ins = _removal(sign_ins.c.expires_at)
_coarse = _removal(estimates_coarse.c.day)


def receipts(tx: WriteSession, before: datetime, limit: int) -> int:
    """Remove receipts of chunks that were applied."""
    return tx.execute(_receipts, before=before, limit=limit).rowcount


def deliveries(tx: WriteSession, before: datetime, limit: int) -> int:
    """Remove deliveries of webhooks that are over: delivered or given up."""
    return tx.execute(_deliveries, before=before, limit=limit).rowcount


def audit_trail(tx: WriteSession, before: datetime, limit: int) -> int:
    """Remove entries of the audit trail."""
    return tx.execute(_audit, before=before, limit=limit).rowcount


def ended_sign_ins(tx: WriteSession, now: datetime, limit: int) -> int:
    """Remove sign-ins whose time is over."""
    return tx.execute(_sign_ins, before=now, limit=limit).rowcount


def coarse_history(tx: WriteSession, before_day: int, limit: int) -> int:
    """Remove days of the coarse history."""
    return tx.execute(_coarse, before=before_day, limit=limit).rowcount
