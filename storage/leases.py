"""Leases: a name belongs to one holder until a moment, and to nobody after it."""

from datetime import datetime
from typing import NamedTuple

import sqlalchemy as sa
from sqlalchemy.dialects import postgresql, sqlite

from storage.database import ReadSession, WriteSession
from storage.models import Instant, leases


class Lease(NamedTuple):
    """A lease."""

    holder: str
    until: datetime


_this = leases.c.name == sa.bindparam("of_name")
_find = sa.select(leases.c.holder, leases.c.until).where(_this)
_free = sa.or_(
    leases.c.holder == sa.bindparam("of_holder"),
    leases.c.until <= sa.bindparam("now", type_=Instant),
    leases.c.until > sa.bindparam("latest", type_=Instant),
)
_take = sa.update(leases).where(_this, _free)
_add_sqlite = sqlite.insert(leases).on_conflict_do_nothing().returning(leases.c.name)
_add_postgresql = postgresql.insert(leases).on_conflict_do_nothing().returning(leases.c.name)
_give_up = sa.delete(leases).where(_this, leases.c.holder == sa.bindparam("of_holder"))


def find(tx: ReadSession, name: str) -> Lease | None:
    """Give a lease, run out or not."""
    return tx.one(Lease, _find, of_name=name)


def take(tx: WriteSession, name: str, lease: Lease, now: datetime, latest: datetime) -> bool:
    """Take a lease, or renew one's own; False while it is another's, unless it ends after `latest`, as none can."""
    values = lease._asdict()
    taken = tx.execute(_take, of_name=name, of_holder=lease.holder, now=now, latest=latest, **values).rowcount > 0
    add_here = _add_postgresql if tx.is_postgresql else _add_sqlite
    return taken or tx.execute(add_here, name=name, **values).first() is not None


def give_up(tx: WriteSession, name: str, holder: str) -> None:
    """End a lease early, if it is this holder's."""
    tx.execute(_give_up, of_name=name, of_holder=holder)
