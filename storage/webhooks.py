"""Webhooks: whom to call when an alert changes. The secret is stored as it is, because signing needs it."""

from datetime import datetime
from typing import Any, NamedTuple

import sqlalchemy as sa

from storage.database import ReadSession, WriteSession
from storage.models import webhooks


class Webhook(NamedTuple):
    """A webhook; `kinds` and `severities` are those it wants, None for all."""

    pk: int
    name: str
    url: str
    kinds: list[str] | None
    severities: list[str] | None
    secret: str
    active: bool
    created_at: datetime
    created_by: str | None
    failing_since: datetime | None
    last_success_at: datetime | None

    def wants(self, kind: str, severity: str) -> bool:
        """Tell whether it is to be called for such an alert."""
        return (self.kinds is None or kind in self.kinds) and (self.severities is None or severity in self.severities)


_select = sa.select(*(webhooks.c[name] for name in Webhook._fields))
_find = _select.where(webhooks.c.pk == sa.bindparam("pk"))
_hold_active = _select.where(webhooks.c.active).order_by(webhooks.c.pk).with_for_update(read=True, key_share=True)
_newest = _select.order_by(webhooks.c.pk.desc()).limit(sa.bindparam("limit"))
_before = _newest.where(webhooks.c.pk < sa.bindparam("before"))
_count = sa.select(sa.func.count()).select_from(webhooks)
_add = sa.insert(webhooks).returning(webhooks.c.pk)
_change = sa.update(webhooks).where(webhooks.c.pk == sa.bindparam("of_pk"))
_failed = _change.where(webhooks.c.failing_since.is_(None))
_remove = sa.delete(webhooks).where(webhooks.c.pk == sa.bindparam("pk"))


def find(tx: ReadSession, pk: int) -> Webhook | None:
    """Find a webhook by its number."""
    return tx.one(Webhook, _find, pk=pk)


def hold_active(tx: WriteSession) -> list[Webhook]:
    """Give the webhooks that are switched on; none of them can be removed before this transaction ends."""
    return tx.all(Webhook, _hold_active)


def page(tx: ReadSession, limit: int, before: int | None) -> list[Webhook]:
    """Give up to `limit` webhooks, newest first, from before number `before`."""
    if before is None:
        return tx.all(Webhook, _newest, limit=limit)
    return tx.all(Webhook, _before, limit=limit, before=before)


def count(tx: ReadSession) -> int:
    """Count the webhooks."""
    return int(tx.value(_count))


def add(tx: WriteSession, values: dict[str, Any], secret: str, by: str, now: datetime) -> int:
    """Store a webhook; give its number."""
    added = tx.execute(_add, secret=secret, created_by=by, created_at=now, **values)
    return int(added.scalar_one())


def change(tx: WriteSession, pk: int, values: dict[str, Any]) -> None:
    """Change what is given in `values`."""
    if values:
        tx.execute(_change, of_pk=pk, **values)


def succeeded(tx: WriteSession, pk: int, now: datetime) -> None:
    """A call went well."""
    tx.execute(_change, of_pk=pk, failing_since=None, last_success_at=now)


def failed(tx: WriteSession, pk: int, now: datetime) -> None:
    """A call failed; only the first since the last success is remembered."""
    tx.execute(_failed, of_pk=pk, failing_since=now)


def remove(tx: WriteSession, pk: int) -> bool:
    """Remove a webhook with its deliveries; False when there is none."""
    return tx.execute(_remove, pk=pk).rowcount > 0
