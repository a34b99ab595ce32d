"""API keys. The key itself is never here, only its SHA-256."""

from datetime import datetime
from typing import NamedTuple

import sqlalchemy as sa

from storage.database import ReadSession, WriteSession
from storage.models import api_keys, devices
from storage.prepared import Prepared


class Key(NamedTuple):
    """A key as it is known here."""

    pk: int
    digest: bytes
    role: str
    name: str
    device_pk: int | None
    device_id: str | None


_select = sa.select(
    api_keys.c.pk, api_keys.c.digest, api_keys.c.role, api_keys.c.name, api_keys.c.device_pk, devices.c.id
).select_from(api_keys.outerjoin(devices))
_by_digest = Prepared(_select.where(api_keys.c.digest == sa.bindparam("digest")))
_every = _select.order_by(api_keys.c.pk)
_by_pk = _select.where(api_keys.c.pk == sa.bindparam("pk"))
_of_role = sa.select(api_keys.c.pk).where(api_keys.c.role == sa.bindparam("role")).limit(1)
_add = sa.insert(api_keys).returning(api_keys.c.pk)
_remove = sa.delete(api_keys).where(api_keys.c.pk == sa.bindparam("pk"))
_remove_source = sa.delete(api_keys).where(api_keys.c.source == sa.bindparam("source"))


def by_digest(tx: ReadSession, digest: bytes) -> Key | None:
    """Find a key by its SHA-256."""
    return tx.one(Key, _by_digest, digest=digest)


def by_pk(tx: ReadSession, pk: int) -> Key | None:
    """Find a key by its number."""
    return tx.one(Key, _by_pk, pk=pk)


def every(tx: ReadSession) -> list[Key]:
    """List the keys in the order in which they were made."""
    return tx.all(Key, _every)


def add(
    tx: WriteSession,
    digest: bytes,
    role: str,
    name: str,
    now: datetime,
    device_pk: int | None = None,
    source: str = "made",
) -> int:
    """Store a key; give its number."""
    added = tx.execute(_add, digest=digest, role=role, name=name, device_pk=device_pk, source=source, created_at=now)
    return int(added.scalar_one())


def any_of_role(tx: ReadSession, role: str) -> bool:
    """Tell whether there is a key of this role."""
    return tx.value(_of_role, role=role) is not None


def remove_source(tx: WriteSession, source: str) -> None:
    """Revoke every key of this origin."""
    tx.execute(_remove_source, source=source)


def remove(tx: WriteSession, pk: int) -> bool:
    """Revoke a key; False when there is none."""
    return tx.execute(_remove, pk=pk).rowcount > 0
