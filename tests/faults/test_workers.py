"""Several server processes on one database: an upload may land anywhere."""

import threading
import time
from collections.abc import Iterable
from pathlib import Path

import httpx
import pytest

from storage.database import Database
from tests.drives import remounted
from tests.faults import stored
from tests.server import ServerProcess, running
from tests.service import Api, Device

CHUNKS = 20


def send_all(url: str, device: Device, chunks: Iterable[tuple[int, bytes]], ready: threading.Barrier) -> None:
    """Send chunks, each over a connection of its own, so that any process may get it, also one that is starting."""
    ready.wait()
    for seq, body in chunks:
        while (status := send(url, device, seq, body)) == 503:
            time.sleep(0.05)
        assert status in {200, 202}


def send(url: str, device: Device, seq: int, body: bytes) -> int:
    with httpx.Client(base_url=url, timeout=30.0) as client:
        return Device(Api(client), device.id, device.key).send(body, seq).status_code


def race(url: str, device: Device, *senders: Iterable[tuple[int, bytes]]) -> None:
    ready = threading.Barrier(len(senders))
    threads = [threading.Thread(target=send_all, args=(url, device, chunks, ready)) for chunks in senders]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(120)
        assert not thread.is_alive()


@pytest.mark.slow
def test_two_processes_and_two_clients_give_what_one_gives(
    database_url: str, database: Database, tmp_path: Path
) -> None:
    bodies = list(enumerate(remounted().chunks[:CHUNKS]))
    server = ServerProcess(database_url, tmp_path, workers=2)
    with running(server) as api:
        calm, twice, shared = (api.add_device(name) for name in ("calm", "twice", "shared"))
        calm.send_all(remounted().chunks[:CHUNKS])
        race(server.url, twice, bodies, bodies)
        race(server.url, shared, bodies[::2], bodies[1::2])
    expected = stored.of_device(database, "calm")
    assert len(expected["chunks"]) == CHUNKS
    assert stored.of_device(database, "twice") == expected
    assert stored.of_device(database, "shared") == expected
