"""Facts about the database itself, by name."""

import sqlalchemy as sa

from storage.database import ReadSession, WriteSession
from storage.models import meta


def get(tx: ReadSession, name: str) -> str | None:
    """Give the value of `name`, or None."""
    value: str | None = tx.value(sa.select(meta.c.value).where(meta.c.name == name))
    return value


def put(tx: WriteSession, name: str, value: str) -> None:
    """Set the value of `name`."""
    if tx.execute(sa.update(meta).where(meta.c.name == name).values(value=value)).rowcount == 0:
        tx.execute(sa.insert(meta).values(name=name, value=value))
