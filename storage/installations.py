"""Where the installation of each device stands: the estimator's snapshot (bytes to us) and what is shown of it."""

from datetime import datetime
from typing import Any, NamedTuple

import sqlalchemy as sa

from storage.database import ReadSession, WriteSession
from storage.models import installations


class Installation(NamedTuple):
    """An installation."""

    device_pk: int
    snapshot: bytes | None
    session_pk: int | None
    """the session the estimator is in"""
    stage: str
    since_session_pk: int | None
    """the session in which the stage began; None: it began at `since_at`"""
    since_t: float | None
    since_at: datetime
    status: dict[str, Any]
    last_data_at: datetime | None
    revision: int


_select = sa.select(*(installations.c[name] for name in Installation._fields))


def get(tx: ReadSession, device_pk: int) -> Installation | None:
    """Find the installation of a device."""
    return tx.one(Installation, _select.where(installations.c.device_pk == device_pk))


def add(tx: WriteSession, installation: Installation) -> None:
    """Store the installation of a new device."""
    tx.execute(sa.insert(installations).values(**installation._asdict()))


def save(tx: WriteSession, installation: Installation) -> None:
    """Store what evolves."""
    values = installation._asdict()
    tx.execute(sa.update(installations).where(installations.c.device_pk == values.pop("device_pk")).values(**values))


def touch(tx: WriteSession, device_pk: int) -> None:
    """Raise the revision: something shown with the installation has changed."""
    tx.execute(
        sa.update(installations)
        .where(installations.c.device_pk == device_pk)
        .values(revision=installations.c.revision + 1)
    )
