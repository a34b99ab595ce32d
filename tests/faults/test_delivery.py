"""However the network delivers the chunks, the end is that of a delivery in order."""

import gzip
import socket
from itertools import count
from pathlib import Path
from typing import NamedTuple

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from storage.database import Database
from tests.conftest import Clock
from tests.drives import chunks
from tests.faults import stored
from tests.server import ServerProcess, running
from tests.service import Api, Device

WAITING_LIMIT = 600.0
"""s, the service's own"""
EXAMPLES = {"sqlite": 15, "postgresql": 8}


class Attempt(NamedTuple):
    """One transmission of a chunk."""

    seq: int
    cut: float | None
    """part that arrives before the connection breaks; None for all of it"""
    delay: float


@st.composite
def deliveries(draw: st.DrawFn, number: int) -> list[Attempt]:
    """Any order; some attempts cut off, some repeated; every chunk whole in the end, its last attempt."""
    order = draw(st.permutations(range(number)))
    delays = st.floats(0.0, WAITING_LIMIT / (3 * number + 1))
    early = st.builds(Attempt, st.integers(0, number - 1), st.none() | st.floats(0.0, 0.99), delays)
    made: list[Attempt] = []
    for seq in order:
        made += draw(st.lists(early, max_size=2))
        made.append(Attempt(seq, None, draw(delays)))
    return made


def deliver(device: Device, clock: Clock, delivery: list[Attempt], bodies: tuple[bytes, ...]) -> None:
    acknowledged: set[int] = set()
    for attempt in delivery:
        clock.advance(attempt.delay)
        body = gzip.compress(bodies[attempt.seq], mtime=0)
        if attempt.cut is not None:
            device.send(body[: int(attempt.cut * len(body))], attempt.seq, expect=400, Content_Encoding="gzip")
            continue
        answer = device.send(body, attempt.seq, Content_Encoding="gzip")
        assert answer.status_code in {200, 202}
        assert answer.json()["chunk"]["duplicate"] == (attempt.seq in acknowledged)
        acknowledged.add(attempt.seq)


def test_any_delivery_ends_as_the_one_in_order(api: Api, clock: Clock, database: Database, backend: str) -> None:
    bodies, numbers = chunks(), count(1)
    calm = api.add_device("calm")
    calm.send_all(bodies)
    expected = stored.of_device(database, "calm")

    @settings(max_examples=EXAMPLES[backend], deadline=None, suppress_health_check=list(HealthCheck), database=None)
    @given(deliveries(len(bodies)))
    def check(delivery: list[Attempt]) -> None:
        device = api.add_device(f"box-{next(numbers)}")
        deliver(device, clock, delivery, bodies)
        assert stored.of_device(database, device.id) == expected

    check()


def send_part(server: ServerProcess, device: Device, seq: int, body: bytes, part: int) -> None:
    """Begin an upload and hang up in the middle of the body."""
    head = (
        f"POST /api/v1/devices/{device.id}/chunks?session=a&seq={seq} HTTP/1.1\r\nHost: localhost\r\n"
        f"Authorization: Bearer {device.key}\r\nContent-Type: text/csv\r\nContent-Length: {len(body)}\r\n\r\n"
    )
    with socket.create_connection(("127.0.0.1", server.port), timeout=10) as connection:
        connection.sendall(head.encode() + body[:part])


def test_an_upload_that_breaks_off_has_no_effect(database_url: str, database: Database, tmp_path: Path) -> None:
    bodies = chunks()[:4]
    server = ServerProcess(database_url, tmp_path)
    with running(server) as api:
        calm, broken = api.add_device("calm"), api.add_device("broken")
        calm.send_all(bodies)
        for seq, body in enumerate(bodies):
            whole_rows = body.rindex(b"\n", 0, len(body) // 2) + 1
            for part in (0, 1, whole_rows, len(body) - 1):
                send_part(server, broken, seq, body, part)
            assert not broken.send(body, seq, expect=200).json()["chunk"]["duplicate"]
    assert stored.of_device(database, "broken") == stored.of_device(database, "calm")
    assert "Traceback" not in server.log.read_text()
