"""500 uploads by several devices while server or database are killed again and again: nothing is lost or done twice."""

import random
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from storage.database import Database
from tests.faults import stored
from tests.faults.sending import Tally, driving, small_chunks
from tests.postgres import Server, running_server
from tests.server import ServerProcess, running
from tests.service import Device

UPLOADS = 500
DEVICES = 4
CHUNKS = UPLOADS // DEVICES
KILLS = 12
"""of the server, which takes a second or two to start"""
STOPS = 6
"""of the database"""
MAX_WAITING = 1024
"""chunks: no gap is declared while a server is down"""

pytestmark = pytest.mark.slow


@pytest.fixture
def own_postgres() -> Iterator[Server]:
    """A PostgreSQL server that may be stopped."""
    with running_server() as server:
        yield server


def disturb_until_done(tally: Tally, times: int, disturb: Callable[[], None]) -> None:
    """Disturb at random moments, spread over the uploads."""
    generator = random.Random(1)
    for n in range(times):
        tally.allowed = UPLOADS * (n + 1) // times - 1
        while tally.acknowledged < UPLOADS * n // times - 1:
            time.sleep(0.005)
        time.sleep(generator.uniform(0.0, 0.1))
        disturb()
    tally.allowed = UPLOADS


def compare(database: Database, devices: list[Device], calm: Device) -> None:
    expected = stored.of_device(database, calm.id)
    assert len(expected["chunks"]) == CHUNKS
    for device in devices:
        assert stored.of_device(database, device.id) == expected


def test_killing_the_server_under_several_devices_changes_nothing(
    database_url: str, database: Database, tmp_path: Path
) -> None:
    server = ServerProcess(database_url, tmp_path, max_waiting_chunks=str(MAX_WAITING))
    bodies = small_chunks(CHUNKS)

    def kill() -> None:
        server.kill()
        server.start()
        server.wait_until_ready()

    with running(server) as api:
        devices, calm = [api.add_device(f"box-{n}") for n in range(DEVICES)], api.add_device("calm")
        with driving(server.url, devices, bodies) as tally:
            disturb_until_done(tally, KILLS, kill)
        assert tally.repeated > 0
        assert tally.acknowledged == UPLOADS
        calm.send_all(bodies)
    compare(database, devices, calm)


@pytest.mark.postgres
def test_the_database_going_away_changes_nothing(own_postgres: Server, tmp_path: Path) -> None:
    url = own_postgres.database()
    server = ServerProcess(url, tmp_path, max_waiting_chunks=str(MAX_WAITING))
    bodies = small_chunks(CHUNKS)

    def crash() -> None:
        own_postgres.stop()
        time.sleep(0.3)
        own_postgres.start()

    with running(server) as api:
        devices, calm = [api.add_device(f"box-{n}") for n in range(DEVICES)], api.add_device("calm")
        with driving(server.url, devices, bodies) as tally:
            disturb_until_done(tally, STOPS, crash)
        assert tally.acknowledged == UPLOADS
        assert 503 in tally.statuses
        assert 500 not in tally.statuses
        calm.send_all(bodies)
    database = Database(url)
    compare(database, devices, calm)
    database.close()
