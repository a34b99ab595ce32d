"""The audit trail: who did what, when and to what. Rows are added and, when they are old, forgotten; never changed."""

from collections.abc import Callable
from datetime import datetime
from typing import Any, NamedTuple

import sqlalchemy as sa

from storage.database import ReadSession, WriteSession
from storage.models import audit


class Entry(NamedTuple):
    """Something done."""

    pk: int
    at: datetime
    actor: str
    key_pk: int | None
    role: str
    action: str
    target: str | None
    detail: dict[str, Any] | None
    request_id: str | None


class Filter(NamedTuple):
    """Which entries to list."""

    actor: str | None = None
    action: str | None = None
    target: str | None = None
    since: datetime | None = None
    until: datetime | None = None


_select = sa.select(*(audit.c[name] for name in Entry._fields)).order_by(audit.c.pk.desc())
_add = sa.insert(audit)


def add(tx: WriteSession, **values: Any) -> None:
    """Add an entry, given its columns."""
    tx.execute(_add, **values)


def page(tx: ReadSession, limit: int, before: int | None, wanted: Filter) -> list[Entry]:
    """Give up to `limit` entries, newest first, from before number `before`."""
    compare: dict[str, Callable[[Any], sa.ColumnElement[bool]]] = {
        "actor": audit.c.actor.__eq__,
        "action": audit.c.action.__eq__,
        "target": audit.c.target.__eq__,
        "since": audit.c.at.__ge__,
        "until": audit.c.at.__lt__,
    }
    chosen = [compare[name](value) for name, value in wanted._asdict().items() if value is not None]
    statement = _select.where(*chosen).limit(limit)
    return tx.all(Entry, statement if before is None else statement.where(audit.c.pk < before))
