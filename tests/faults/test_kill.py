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
from tests.service import Device

KILLS = 20
LATEST_KILL = 0.06
"""s after the chunks were sent; an upload takes about a third of it"""


def send_until_applied(server: ServerProcess, device: Device, seq: int, body: bytes, stop: threading.Event) -> None:
    """Send a chunk again and again, as a device does, until it is applied."""
    path = f"{server.url}/api/v1/devices/{device.id}/chunks"
    headers = {"Authorization": f"Bearer {device.key}", "Content-Type": "text/csv"}
    while not stop.is_set():
        try:
            answer = httpx.post(path, params={"session": "a", "seq": seq}, headers=headers, content=body, timeout=20.0)
        except httpx.TransportError:
            time.sleep(0.02)
            continue
        assert answer.status_code in {200, 202, 503}, answer.text
        if answer.status_code == 200:
            return
        time.sleep(0.02)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1])
def test_killing_the_server_changes_nothing(database_url: str, database: Database, tmp_path: Path, seed: int) -> None:
    generator = random.Random(seed)
    server = ServerProcess(database_url, tmp_path)
    bodies = list(enumerate(remounted().chunks))
    with running(server) as api:
        calm, disturbed = api.add_device("calm"), api.add_device("disturbed")
        for n in range(KILLS):
            pair = bodies[n : n + 2]
            generator.shuffle(pair)
            stop = threading.Event()
            senders = [
                threading.Thread(target=send_until_applied, args=(server, disturbed, seq, body, stop))
                for seq, body in pair
            ]
            for sender in senders:
                sender.start()
            time.sleep(generator.uniform(0.0, LATEST_KILL))
            server.kill()
            server.start()
            server.wait_until_ready()
            for sender in senders:
                sender.join(60)
                assert not sender.is_alive()
        for seq, body in bodies[KILLS:]:
            send_until_applied(server, disturbed, seq, body, stop)
        calm.send_all(remounted().chunks)
        assert disturbed.get("estimates")["quaternion"] == calm.get("estimates")["quaternion"]
    assert stored.of_device(database, "disturbed") == stored.of_device(database, "calm")
    assert len(stored.of_device(database, "calm")["mounts"]) == 2
