"""A backup of a running service under load: everything acknowledged before it began is in it, and devices go on."""

import itertools
import threading
import time
from collections.abc import Callable
from pathlib import Path

import httpx
import pytest
import sqlalchemy as sa

from storage.database import Database
from storage.models import chunks as receipts
from storage.models import devices, sessions
from tests.cli import livella
from tests.drives import plain
from tests.postgres import Server
from tests.server import ServerProcess, running
from tests.service import Api, Device

DEVICES = 3
GAP_TIMEOUT = 1.0


class Sender(threading.Thread):
    """A device that sends session after session, as fast as it is answered, and never asks for anything."""

    def __init__(self, url: str, device: Device) -> None:
        super().__init__()
        self.url = url
        self.device = device
        self.acknowledged: list[tuple[str, int]] = []
        self.ending = threading.Event()

    def run(self) -> None:
        with httpx.Client(base_url=self.url, timeout=30.0) as client:
            device = Device(Api(client), self.device.id, self.device.key)
            for n in itertools.count():
                for seq, body in enumerate(plain().chunks):
                    if self.ending.is_set():
                        return
                    while (status := device.send(body, seq, f"s{n}").status_code) == 503:
                        time.sleep(0.1)  # the other process is starting
                    assert status == 200
                    self.acknowledged.append((f"s{n}", seq))


@pytest.fixture
def new_url(backend: str, request: pytest.FixtureRequest, tmp_path: Path) -> str:
    """URL of an empty place to restore to."""
    if backend == "sqlite":
        return f"sqlite:///{tmp_path / 'restored.db'}"
    server: Server = request.getfixturevalue("postgres")
    return server.empty_database()


@pytest.mark.slow
def test_a_backup_under_load_has_what_was_acknowledged(database_url: str, new_url: str, tmp_path: Path) -> None:
    copy = tmp_path / "copy"
    plain()  # the drive is made now, not while they wait for it
    server = ServerProcess(database_url, tmp_path, workers=2)
    with running(server) as api:
        senders = [Sender(server.url, api.add_device(f"box-{n}")) for n in range(DEVICES)]
        for sender in senders:
            sender.start()
        wait_until(lambda: all(len(sender.acknowledged) > 10 for sender in senders))
        before = [list(sender.acknowledged) for sender in senders]
        backed_up = livella.run("db", "backup", copy, "--database-url", database_url)
        assert backed_up.status == 0, backed_up.err
        during = [len(sender.acknowledged) for sender in senders]
        wait_until(lambda: all(len(sender.acknowledged) > n + 5 for sender, n in zip(senders, during, strict=True)))
        for sender in senders:
            sender.ending.set()
        for sender in senders:
            sender.join(60)
    assert sum(during) > sum(map(len, before)), "nobody wrote while the backup was made"
    done = livella.run("db", "restore", copy, "--database-url", new_url)
    assert done.status == 0, done.err
    for sender, known in zip(senders, before, strict=True):
        assert set(known) <= kept(new_url, sender.device.id) <= set(sender.acknowledged)
    server = ServerProcess(new_url, tmp_path, gap_timeout=str(GAP_TIMEOUT))
    with running(server) as api:
        for sender in senders:
            go_on(Device(api.as_(sender.device.key), sender.device.id, sender.device.key), sender, new_url)


def wait_until(fact: Callable[[], bool], seconds: float = 60.0) -> None:
    deadline = time.monotonic() + seconds
    while not fact():
        assert time.monotonic() < deadline
        time.sleep(0.1)


def kept(url: str, device_id: str) -> set[tuple[str, int]]:
    """Give the chunks of a device that a database knows as applied."""
    database = Database(url)
    query = (
        sa.select(sessions.c.name, receipts.c.seq)
        .join_from(receipts, sessions)
        .join(devices)
        .where(devices.c.id == device_id, receipts.c.state == "applied")
    )
    try:
        with database.read() as tx:
            return set(tx.all(lambda name, seq: (name, seq), query))
    finally:
        database.close()


def go_on(device: Device, sender: Sender, url: str) -> None:
    """What the backup knows is a duplicate; what it does not know makes a gap, which is declared; then time goes on."""
    known = kept(url, device.id)
    session, seq = sender.acknowledged[-1]
    for name, number in sorted(known)[-3:]:
        assert device.send(plain().chunks[number], number, name, expect=200).json()["chunk"]["duplicate"]
    body = plain().chunks[(seq + 1) % len(plain().chunks)]
    assert device.send(body, seq + 1, session).status_code in {200, 202}
    wait_until(lambda: device.send(body, seq + 1, session).json()["chunk"]["state"] == "applied")
    device.send(plain().chunks[0], 0, "after-the-restore", expect=200)
