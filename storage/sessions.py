"""Sessions of a device (power-up to power-off), numbered by `pk` in the order in which they were first heard of.

`started_at` is the zero of the session's clock in UTC: the least of (arrival - last sample) over its chunks. A chunk
arrives after its samples were taken, so the least delayed one tells best; a log replayed faster than it was driven
then ends now rather than in the future.
"""

from datetime import datetime
from typing import Any, NamedTuple

import sqlalchemy as sa

from storage.database import ReadSession, WriteSession
from storage.models import sessions
from storage.prepared import Prepared


class Session(NamedTuple):
    """A session."""

    pk: int
    name: str
    next_seq: int
    context: dict[str, Any] | None
    started_at: datetime | None


class Beginning(NamedTuple):
    """When a session began."""

    pk: int
    name: str
    started_at: datetime | None
    created_at: datetime
    """when it was first heard of"""


_select = sa.select(*(sessions.c[name] for name in Session._fields))
_find = Prepared(
    _select.where(sessions.c.device_pk == sa.bindparam("device_pk"), sessions.c.name == sa.bindparam("name"))
)
_newest = Prepared(
    sa.select(*(sessions.c[name] for name in Beginning._fields))
    .where(sessions.c.device_pk == sa.bindparam("of_device_pk"), sessions.c.pk < sa.bindparam("before"))
    .order_by(sessions.c.pk.desc())
    .limit(sa.bindparam("limit"))
)
_get = _select.where(sessions.c.pk == sa.bindparam("pk"))
_add = sa.insert(sessions).returning(sessions.c.pk)
_save = Prepared(sa.update(sessions).where(sessions.c.pk == sa.bindparam("of_pk")))


def find(tx: ReadSession, device_pk: int, name: str) -> Session | None:
    """Find a session by its name."""
    return tx.one(Session, _find, device_pk=device_pk, name=name)


def find_or_add(tx: WriteSession, device_pk: int, name: str, now: datetime) -> Session:
    """Find a session by its name; one not heard of before is new."""
    found = find(tx, device_pk, name)
    if found is not None:
        return found
    added = tx.execute(_add, device_pk=device_pk, name=name, next_seq=0, created_at=now)
    return Session(added.scalar_one(), name, 0, None, None)


def newest(tx: ReadSession, device_pk: int, before: int, limit: int) -> list[Beginning]:
    """Give up to `limit` sessions of a device, newest first, from before number `before`."""
    return tx.all(Beginning, _newest, of_device_pk=device_pk, before=before, limit=limit)


def get(tx: ReadSession, pk: int) -> Session:
    """Give the session with this number."""
    return Session(*tx.connection.execute(_get, {"pk": pk}).one())


def save(tx: WriteSession, session: Session) -> None:
    """Store what evolves."""
    tx.run(
        _save,
        of_pk=session.pk,
        next_seq=session.next_seq,
        context=session.context,
        started_at=session.started_at,
    )
