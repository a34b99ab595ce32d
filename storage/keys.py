"""API keys. The key itself is never here, only its SHA-256."""

from collections.abc import Mapping
from datetime import datetime, timedelta
from typing import NamedTuple

import sqlalchemy as sa

from storage.database import ReadSession, WriteSession
from storage.models import api_keys, devices
from storage.prepared import Prepared

USE_INTERVAL = timedelta(minutes=1)
"""A key's last use is not written again before this has passed."""
MADE, ENVIRONMENT = "made", "environment"
"""Where keys come from."""


class Key(NamedTuple):
    """A key as far as it is needed to let somebody in."""

    pk: int
    digest: bytes
    role: str
    name: str
    device_pk: int | None
    device_id: str | None
    expires_at: datetime | None


class Entry(NamedTuple):
    """A key as it is listed."""

    pk: int
    prefix: str | None
    role: str
    name: str
    device_id: str | None
    created_at: datetime
    created_by: str | None
    last_used_at: datetime | None
    expires_at: datetime | None


_from = api_keys.outerjoin(devices)
_select = sa.select(*(devices.c.id if name == "device_id" else api_keys.c[name] for name in Key._fields)).select_from(
    _from
)
_by_digest = Prepared(_select.where(api_keys.c.digest == sa.bindparam("digest")))
_by_pk = _select.where(api_keys.c.pk == sa.bindparam("pk"))
_list = (
    sa.select(*(devices.c.id if name == "device_id" else api_keys.c[name] for name in Entry._fields))
    .select_from(_from)
    .order_by(api_keys.c.pk)
)
_find = _list.where(api_keys.c.pk == sa.bindparam("pk"))
_page = _list.where(api_keys.c.pk > sa.bindparam("after")).limit(sa.bindparam("limit"))
_valid = sa.or_(api_keys.c.expires_at.is_(None), api_keys.c.expires_at > sa.bindparam("now"))
_valid_of_role = sa.select(api_keys.c.pk).where(api_keys.c.role == sa.bindparam("role"), _valid).order_by(api_keys.c.pk)
_lock_valid_of_role = _valid_of_role.with_for_update()
_add = sa.insert(api_keys).returning(api_keys.c.pk)
_remove = sa.delete(api_keys).where(api_keys.c.pk == sa.bindparam("pk"))
_remove_source = sa.delete(api_keys).where(api_keys.c.source == sa.bindparam("source"))
_remove_device = sa.delete(api_keys).where(api_keys.c.device_pk == sa.bindparam("device_pk"))
_use = (
    sa.update(api_keys)
    .where(
        api_keys.c.pk == sa.bindparam("of_pk"),
        sa.or_(api_keys.c.last_used_at.is_(None), api_keys.c.last_used_at <= sa.bindparam("stale")),
    )
    .values(last_used_at=sa.bindparam("used"))
)


def by_digest(tx: ReadSession, digest: bytes) -> Key | None:
    """Find a key by its SHA-256."""
    return tx.one(Key, _by_digest, digest=digest)


def by_pk(tx: ReadSession, pk: int) -> Key | None:
    """Find a key by its number."""
    return tx.one(Key, _by_pk, pk=pk)


def find(tx: ReadSession, pk: int) -> Entry | None:
    """Find a key as it is listed."""
    return tx.one(Entry, _find, pk=pk)


def every(tx: ReadSession) -> list[Entry]:
    """List the keys in the order in which they were made."""
    return tx.all(Entry, _list)


def page(tx: ReadSession, limit: int, after: int | None = None) -> list[Entry]:
    """Give up to `limit` keys in the order in which they were made, from after number `after`."""
    return tx.all(Entry, _page, limit=limit, after=after or 0)


def add(
    tx: WriteSession,
    digest: bytes,
    role: str,
    name: str,
    now: datetime,
    device_pk: int | None = None,
    source: str = MADE,
    prefix: str | None = None,
    expires_at: datetime | None = None,
    created_by: str | None = None,
) -> int:
    """Store a key; give its number."""
    more = {"device_pk": device_pk, "source": source, "prefix": prefix}
    ends = {"expires_at": expires_at, "created_by": created_by}
    return int(tx.execute(_add, digest=digest, role=role, name=name, created_at=now, **more, **ends).scalar_one())


def valid_of_role(tx: ReadSession, role: str, now: datetime) -> list[int]:
    """Give the numbers of the keys of this role that have not expired."""
    return tx.all(int, _valid_of_role, role=role, now=now)


def lock_valid_of_role(tx: WriteSession, role: str, now: datetime) -> list[int]:
    """Give the same; nobody else removes one of them before this transaction ends."""
    return tx.all(int, _lock_valid_of_role, role=role, now=now)


def used(tx: WriteSession, uses: Mapping[int, datetime]) -> None:
    """Write when keys were last used, where what is written is not as new already."""
    rows = [{"of_pk": pk, "used": at, "stale": at - USE_INTERVAL} for pk, at in sorted(uses.items())]
    if rows:
        tx.connection.execute(_use, rows)


def remove_source(tx: WriteSession, source: str) -> None:
    """Revoke every key of this origin."""
    tx.execute(_remove_source, source=source)


def remove_of_device(tx: WriteSession, device_pk: int) -> None:
    """Revoke every key of a device."""
    tx.execute(_remove_device, device_pk=device_pk)


def remove(tx: WriteSession, pk: int) -> bool:
    """Revoke a key; False when there is none."""
    return tx.execute(_remove, pk=pk).rowcount > 0
