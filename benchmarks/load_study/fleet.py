"""A fleet in the database before the service starts, and what is in the database when it has ended.

A few devices send the first minutes of their drives through the service's own functions; every other device is put
where one of them stands.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import sqlalchemy as sa
from pydantic import SecretStr

from api import schemas
from api.services import access, fleet, ingest, intake, startup
from api.services.context import Context
from api.settings import Settings
from benchmarks.load_study.client import Body, Device
from benchmarks.load_study.drives import ARROW, Drive, encode
from storage import chunks, devices, installations, keys, models, mounts, sessions
from storage.database import WriteSession
from storage.installations import Installation
from storage.mounts import Mount
from storage.sessions import Session

ADMIN_KEY = "admin-key-of-the-load-0123456789abcdef"
SESSION = "drive"
BATCH = 1000
"""devices put in by one transaction"""


_ADD_MOUNT = sa.insert(models.mounts)


class NotConfirmedError(Exception):
    """The first minutes of a drive do not confirm the mounting: with less to watch over, a device would cost less."""


class Prototype(NamedTuple):
    """Where a device stands after the first minutes of a drive."""

    installation: Installation
    session: Session
    mount: Mount
    """in force"""


class Stored(NamedTuple):
    """What the database holds of the run."""

    applied: int
    """chunks"""
    wrong: int
    """devices whose number of chunks or next chunk is not what was acknowledged"""


def open_context(url: str, directory: Path) -> Context:
    """Open a database and bring it up to date; as in the service that is measured, samples are not kept."""
    settings = Settings(
        database_url=SecretStr(url), data_dir=directory, admin_key=SecretStr(ADMIN_KEY), raw_retention_days=0
    )
    context = Context.make(settings)
    startup.prepare(context)
    return context


def chunk(seq: int, body: Body, session: str = SESSION) -> ingest.Chunk:
    """Give a chunk as the route hands it on."""
    told = dict(line.split(": ") for line in body.headers.decode().split("\r\n") if line)
    sent = chunks.Body(body.content, told["Content-Type"], told.get("Content-Encoding"), "auto")
    return ingest.Chunk(session, seq, sent)


def prototypes(context: Context, drives: Sequence[Drive]) -> list[Prototype]:
    """Drive the first minutes of every drive.

    Raises
    ------
    NotConfirmedError
        one of them leaves the mounting open.
    """
    return [_prototype(context, f"prototype-{i:03}", drive) for i, drive in enumerate(drives)]


def _prototype(context: Context, name: str, drive: Drive) -> Prototype:
    fleet.register(context, schemas.DeviceDraft(id=name, name=name))
    for seq, minute in enumerate(drive.before):
        intake.receive(context, name, chunk(seq, encode(minute, ARROW)))
    with context.database.write() as tx:
        installation = installations.find(tx, name)
        assert installation is not None
        session = sessions.find_or_add(tx, installation.device_pk, SESSION, context.clock())
        mount = mounts.current(tx, installation.device_pk)
    if mount is None or not mount.in_force:
        raise NotConfirmedError(name)
    return Prototype(installation, session, mount)


def settle(context: Context, models_of: Sequence[Prototype], bodies: Sequence[Sequence[Body]], n: int) -> list[Device]:
    """Put `n` devices in the database, each where a prototype stands, and give them as they will send."""
    made: list[Device] = []
    for first in range(0, n, BATCH):
        with context.database.write() as tx:
            for i in range(first, min(first + BATCH, n)):
                kind = i % len(models_of)
                made.append(_put(tx, context, f"box-{i:06}", models_of[kind], bodies[kind]))
    return made


def _put(tx: WriteSession, context: Context, name: str, like: Prototype, bodies: Sequence[Body]) -> Device:
    now, key = context.clock(), access.new_key()
    pk = devices.add(tx, name, {"name": name}, now)
    keys.add(tx, access.digest(key), access.Role.DEVICE.word, name, now, device_pk=pk)
    session = sessions.find_or_add(tx, pk, SESSION, now)
    sessions.save(tx, like.session._replace(pk=session.pk))
    known = like.installation
    since = None if known.since_session_pk is None else session.pk
    installations.add(tx, known._replace(device_pk=pk, session_pk=session.pk, since_session_pk=since))
    mount = like.mount._asdict()
    del mount["started_at"]  # of its session
    tx.execute(_ADD_MOUNT, device_pk=pk, session_pk=session.pk, **mount)
    return Device(name, key, SESSION, bodies, like.session.next_seq)


def _as_told(device: Device, next_seq: int, count: int) -> bool:
    return next_seq == device.first_seq + count and device.stored_as_told(count)


def check(context: Context, fleet_sent: Sequence[Device]) -> Stored:
    """Compare what is stored with what was acknowledged: each chunk once, its effect once."""
    counted = (
        sa.select(
            models.devices.c.id,
            models.sessions.c.next_seq,
            sa.func.count(models.chunks.c.seq).filter(models.chunks.c.state == chunks.APPLIED),
        )
        .select_from(models.devices.join(models.sessions).outerjoin(models.chunks))
        .where(models.devices.c.id.like("box-%"))
        .group_by(models.devices.c.id, models.sessions.c.next_seq)
    )
    with context.database.read() as tx:
        found = {name: (next_seq, count) for name, next_seq, count in tx.connection.execute(counted)}
    wrong = sum(not _as_told(device, *found[device.name]) for device in fleet_sent)
    return Stored(sum(count for _, count in found.values()), wrong)
