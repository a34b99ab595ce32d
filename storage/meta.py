"""Facts about the database itself, by name."""

import sqlalchemy as sa

from storage.database import ReadSession, WriteSession
from storage.models import meta

_get = sa.select(meta.c.value).where(meta.c.name == sa.bindparam("name"))
_change = sa.update(meta).where(meta.c.name == sa.bindparam("of_name"))
_add = sa.insert(meta)


def get(tx: ReadSession, name: str) -> str | None:
    """Give the value of `name`, or None."""
    value: str | None = tx.value(_get, name=name)
    return value


def put(tx: WriteSession, name: str, value: str) -> None:
    """Set the value of `name`."""
    if tx.execute(_change, of_name=name, value=value).rowcount == 0:
        tx.execute(_add, name=name, value=value)
