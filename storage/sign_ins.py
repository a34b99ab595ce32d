"""Sign-ins to the page. What the browser keeps is never here, only its SHA-256."""

from datetime import datetime
from typing import NamedTuple

import sqlalchemy as sa

from storage.database import ReadSession, WriteSession
from storage.models import sign_ins


class SignIn(NamedTuple):
    """A browser that is signed in, and the key it did so with."""

    pk: int
    key_pk: int
    expires_at: datetime


_select = sa.select(*(sign_ins.c[name] for name in SignIn._fields))
_by_digest = _select.where(sign_ins.c.digest == sa.bindparam("digest"))
_by_pk = _select.where(sign_ins.c.pk == sa.bindparam("pk"))
_add = sa.insert(sign_ins)
_remove = sa.delete(sign_ins).where(sign_ins.c.pk == sa.bindparam("pk"))


def by_digest(tx: ReadSession, digest: bytes) -> SignIn | None:
    """Find a sign-in by the SHA-256 of what the browser keeps."""
    return tx.one(SignIn, _by_digest, digest=digest)


def by_pk(tx: ReadSession, pk: int) -> SignIn | None:
    """Find a sign-in by its number."""
    return tx.one(SignIn, _by_pk, pk=pk)


def add(tx: WriteSession, digest: bytes, key_pk: int, now: datetime, expires_at: datetime) -> None:
    """Store a sign-in."""
    tx.execute(_add, digest=digest, key_pk=key_pk, created_at=now, expires_at=expires_at)


def remove(tx: WriteSession, pk: int) -> None:
    """End a sign-in."""
    tx.execute(_remove, pk=pk)
