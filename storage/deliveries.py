"""Deliveries of webhooks: what is to be sent, in the order of their numbers for each webhook and device.

A dispatcher claims a delivery until a moment and counts the claim up; only the latest claim may say how the attempt
ended. A claim that is not settled, because its process died, runs out, and the delivery is claimed anew.
"""

from datetime import datetime
from typing import Any, NamedTuple

import sqlalchemy as sa

from storage.database import ReadSession, WriteSession
from storage.models import Instant, delivery_pending, webhook_deliveries, webhooks

PENDING, DELIVERED, FAILED = "pending", "delivered", "failed"


class Delivery(NamedTuple):
    """A delivery; `give_up_at` is the moment from which a failed attempt is the last one."""

    pk: int
    webhook_pk: int
    message_id: str
    type: str
    device_id: str | None
    payload: str
    state: str
    attempts: int
    created_at: datetime
    next_attempt_at: datetime | None
    last_attempt_at: datetime | None
    last_status: int | None
    last_error: str | None
    duration_ms: int | None
    give_up_at: datetime
    claims: int


_now = sa.bindparam("now", type_=Instant)
_table = webhook_deliveries
_earlier = webhook_deliveries.alias("earlier")
_select = sa.select(*(_table.c[name] for name in Delivery._fields))
_of_webhook = _table.c.webhook_pk == sa.bindparam("webhook_pk")
_changed_webhook = _table.c.webhook_pk == sa.bindparam("of_webhook")
_unclaimed = sa.or_(_table.c.claimed_until.is_(None), _table.c.claimed_until <= _now)
_is_first = _table.c.pk == (  # not NOT EXISTS, which PostgreSQL may compute for all deliveries at once
    sa.select(_earlier.c.pk)
    .where(
        _earlier.c.webhook_pk == _table.c.webhook_pk,
        _earlier.c.device_id == _table.c.device_id,
        _earlier.c.state == sa.literal_column("'pending'"),
    )
    .order_by(_earlier.c.pk)
    .limit(1)
    .scalar_subquery()
)
_due = (delivery_pending, _table.c.next_attempt_at <= _now, _unclaimed, _is_first)
_next = _select.where(_of_webhook, *_due).order_by(_table.c.next_attempt_at, _table.c.pk).limit(1)
_next_free = _next.with_for_update(skip_locked=True, of=_table)
_waiting_webhooks = (
    sa.select(webhooks.c.pk)
    .where(webhooks.c.active, sa.exists().where(_table.c.webhook_pk == webhooks.c.pk, *_due))
    .order_by(webhooks.c.pk)
)
_newest = _select.where(_of_webhook).order_by(_table.c.pk.desc()).limit(sa.bindparam("limit"))
_before = _newest.where(_table.c.pk < sa.bindparam("before"))
_add = sa.insert(webhook_deliveries)
_claim = sa.update(webhook_deliveries).where(_table.c.pk == sa.bindparam("of_pk"))
_settle = _claim.where(_table.c.claims == sa.bindparam("of_claim"), delivery_pending).values(claimed_until=None)
_hasten = (
    sa.update(webhook_deliveries)
    .where(_changed_webhook, delivery_pending, _table.c.next_attempt_at > _now, _unclaimed)
    .values(next_attempt_at=_now)
)
_revive = sa.update(webhook_deliveries).where(
    _changed_webhook, _table.c.state == FAILED, _table.c.device_id.is_not(None)
)
_backlog = sa.select(sa.func.count()).select_from(_table.join(webhooks)).where(delivery_pending, webhooks.c.active)
_forget = sa.delete(webhook_deliveries).where(
    _table.c.created_at < sa.bindparam("before", type_=Instant), ~delivery_pending
)


def add(tx: WriteSession, rows: list[dict[str, Any]]) -> None:
    """Store deliveries."""
    tx.connection.execute(_add, rows)


def waiting_webhooks(tx: ReadSession, now: datetime) -> list[int]:
    """Give the numbers of the webhooks for which a delivery is due."""
    return tx.all(int, _waiting_webhooks, now=now)


def claim(tx: WriteSession, webhook_pk: int, now: datetime, until: datetime) -> Delivery | None:
    """Take the next delivery that is due for oneself; none before an earlier one for its device is settled."""
    found = tx.one(Delivery, _next_free, webhook_pk=webhook_pk, now=now)
    if found is not None:
        found = found._replace(claims=found.claims + 1)
        tx.execute(_claim, of_pk=found.pk, claims=found.claims, claimed_until=until)
    return found


def settle(tx: WriteSession, delivery: Delivery) -> bool:
    """Store how an attempt ended; False, and no effect, when somebody else has claimed the delivery since."""
    names = ("state", "attempts", "next_attempt_at", "last_attempt_at", "last_status", "last_error", "duration_ms")
    values = {name: getattr(delivery, name) for name in names}
    return tx.execute(_settle, of_pk=delivery.pk, of_claim=delivery.claims, **values).rowcount > 0


def hasten(tx: WriteSession, webhook_pk: int, now: datetime) -> None:
    """Make everything due that waits for its next attempt."""
    tx.execute(_hasten, of_webhook=webhook_pk, now=now)


def revive(tx: WriteSession, webhook_pk: int, now: datetime, give_up_at: datetime) -> int:
    """Begin anew with the deliveries that were given up; give their number."""
    values = {"state": PENDING, "attempts": 0, "next_attempt_at": now, "give_up_at": give_up_at}
    return tx.execute(_revive, of_webhook=webhook_pk, **values).rowcount


def page(tx: ReadSession, webhook_pk: int, limit: int, before: int | None) -> list[Delivery]:
    """Give up to `limit` deliveries, newest first, from before number `before`."""
    if before is None:
        return tx.all(Delivery, _newest, webhook_pk=webhook_pk, limit=limit)
    return tx.all(Delivery, _before, webhook_pk=webhook_pk, limit=limit, before=before)


def backlog(tx: ReadSession) -> int:
    """Count the deliveries that webhooks still wait for."""
    return int(tx.value(_backlog))


def forget(tx: WriteSession, before: datetime) -> None:
    """Remove the deliveries from before a moment that are over: delivered or given up."""
    tx.execute(_forget, before=before)
