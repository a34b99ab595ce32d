"""SIGKILL at random moments of an upload, with a client that tries again, leaves what an undisturbed run leaves."""

import random
import threading
import time
from pathlib import Path

import httpx
import pytest

from storage.database import Database
from tests.drives import remounted
from tests.faults import stored
from tests.server import ServerProcess, running
from tests.service import Api, Device

KILLS = 20
LATEST_KILL = 0.06
"""s after the chunks were sent; an upload takes about a third of it"""


def send_until_applied(server: ServerProcess, device: Device, seq: int, body: bytes, ready: threading.Barrier) -> None:
    """Send a chunk again and again, as a device does, until it is applied."""
    with httpx.Client(base_url=server.url, timeout=20.0) as client:
        sender = Device(Api(client), device.id, device.key)
        ready.wait()
        while True:
            try:
                status = sender.send(body, seq).status_code
            except httpx.TransportError:
                status = 503
            assert status in {200, 202, 503}
            if status == 200:
                return
            time.sleep(0.02)


@pytest.mark.slow
def test_killing_the_server_changes_nothing(database_url: str, database: Database, tmp_path: Path) -> None:
    generator = random.Random(1)
    server = ServerProcess(database_url, tmp_path)
    bodies = list(enumerate(remounted().chunks))
    with running(server) as api:
        taken: set[int] = set()  # chunks of this round found after the kill
        calm, disturbed = api.add_device("calm"), api.add_device("disturbed")
        for n in range(KILLS):
            pair = bodies[n : n + 2]
            generator.shuffle(pair)
            ready = threading.Barrier(len(pair) + 1)
            senders = [
                threading.Thread(target=send_until_applied, args=(server, disturbed, seq, body, ready))
                for seq, body in pair
            ]
            for sender in senders:
                sender.start()
            ready.wait()
            time.sleep(generator.uniform(0.0, LATEST_KILL))
            server.kill()
            taken.add(len(stored.of_device(database, "disturbed")["chunks"]) - n)
            server.start()
            server.wait_until_ready()
            for sender in senders:
                sender.join(60)
                assert not sender.is_alive()
        assert len(taken) > 1, "every kill came before, or every kill came after the commit"
        disturbed.send_all(remounted().chunks[KILLS + 1 :], start=KILLS + 1)
        calm.send_all(remounted().chunks)
        assert disturbed.get("estimates")["quaternion"] == calm.get("estimates")["quaternion"]
    assert stored.of_device(database, "disturbed") == stored.of_device(database, "calm")
    assert len(stored.of_device(database, "calm")["mounts"]) == 2
