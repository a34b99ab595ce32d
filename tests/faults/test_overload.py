"""More work than the service can take on, in processes of its own: it says so, stays alive, and stops in good order."""

import socket
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from pathlib import Path

import httpx
import pytest
import sqlalchemy as sa

from storage.database import Database
from storage.models import chunks as chunk_table
from storage.models import devices, sessions
from tests.api.test_metrics import figures, value
from tests.drives import chunks
from tests.server import ServerProcess, running
from tests.service import Api, Device

PARALLEL = 200
DRIBBLERS = 60
SLOWEST_HEALTH = 1.0
"""s"""
MEMORY = 400 * 1024 * 1024
"""bytes more than before, at most"""

CLIENT = httpx.Client(limits=httpx.Limits(max_connections=None, max_keepalive_connections=0))

pytestmark = pytest.mark.slow


def memory(pid: int) -> int:
    """Most bytes a process has ever had."""
    status = Path(f"/proc/{pid}/status").read_text()
    return int(status.partition("VmHWM:")[2].split()[0]) * 1024


def post(server: ServerProcess, device: Device, body: bytes, seq: int = 0, session: str = "a") -> httpx.Response:
    return CLIENT.post(
        f"{server.url}/api/v1/devices/{device.id}/chunks",
        params={"session": session, "seq": seq},
        headers={"Authorization": f"Bearer {device.key}", "Content-Type": "text/csv"},
        content=body,
        timeout=60.0,
    )


def slowest_health(server: ServerProcess, over: threading.Event) -> float:
    slowest = 0.0
    with httpx.Client(base_url=server.url, timeout=30.0) as client:
        while not over.is_set():
            for path in ("/healthz", "/readyz", "/metrics"):
                begun = time.monotonic()
                assert client.get(path).status_code == 200
                if path == "/healthz":
                    slowest = max(slowest, time.monotonic() - begun)
            time.sleep(0.05)
    return slowest


def test_a_storm_is_refused_in_part_and_the_service_stays_awake(
    database_url: str, database: Database, tmp_path: Path
) -> None:
    server = ServerProcess(database_url, tmp_path, max_uploads="4", upload_threads="2")
    with running(server) as api, ThreadPoolExecutor(PARALLEL + 1) as pool:
        made = [api.add_device(f"box-{n}") for n in range(PARALLEL)]
        post(server, made[0], chunks()[0], session="warm")
        assert server.process is not None
        before = memory(server.process.pid)
        over = threading.Event()
        health = pool.submit(slowest_health, server, over)
        answers = list(pool.map(lambda device: post(server, device, chunks()[0], session="storm"), made))
        over.set()
        counts = Counter(answer.status_code for answer in answers)
        assert set(counts) == {200, 503}, counts
        assert health.result() < SLOWEST_HEALTH
        refused = [answer for answer in answers if answer.status_code == 503]
        assert {answer.headers["content-type"] for answer in refused} == {"application/problem+json"}
        waits = {int(answer.headers["retry-after"]) for answer in refused}
        assert len(waits) > 1, "all would come back at once"
        assert max(waits) <= 5
        assert memory(server.process.pid) - before < MEMORY
        told = figures(api.client.get("/metrics").text)
        assert value(told, "livella_overloaded_total", limit="uploads") == counts[503]
        assert value(told, "livella_uploads_in_work") == 0
        assert value(told, "livella_body_bytes") == 0
    assert stored(database, "storm") == {
        device.id for device, answer in zip(made, answers, strict=True) if answer.status_code == 200
    }


def stored(database: Database, session: str) -> set[str]:
    """Give the devices that have a chunk in sessions of this name."""
    query = sa.select(devices.c.id).join(sessions).join(chunk_table).where(sessions.c.name == session)
    with database.read() as tx:
        return {row[0] for row in tx.connection.execute(query)}


def wait_until(happened: Callable[[], bool]) -> None:
    deadline = time.monotonic() + 30
    while not happened():
        assert time.monotonic() < deadline
        time.sleep(0.01)


@pytest.mark.parametrize("workers", [1, 2])
def test_what_was_accepted_before_the_stop_is_stored(
    workers: int, database_url: str, database: Database, tmp_path: Path
) -> None:
    server, bodies = ServerProcess(database_url, tmp_path, workers), chunks() * 50
    with running(server) as api:
        made = [api.add_device(f"box-{n}") for n in range(12)]
        answered: list[tuple[str, int]] = []

        def drive(device: Device) -> None:
            for seq, body in enumerate(bodies):
                try:
                    answer = post(server, device, body, session=f"{device.id}-{seq}")
                except httpx.TransportError:
                    return  # refused, or the connection ended before an answer
                answered.append((f"{device.id}-{seq}", answer.status_code))

        senders = [threading.Thread(target=drive, args=(device,)) for device in made]
        for sender in senders:
            sender.start()
        wait_until(lambda: len(answered) >= 2 * len(made))
        assert server.stop() < 15
        for sender in senders:
            sender.join(60)
            assert not sender.is_alive()
    assert answered
    assert {status for _, status in answered} <= {200, 503}
    with database.read() as tx:
        kept = {row[0] for row in tx.connection.execute(sa.select(sessions.c.name).join(chunk_table))}
    assert {name for name, status in answered if status == 200} <= kept


# ---------------------------------------------------------------- requests that are no requests


@contextmanager
def connection(server: ServerProcess) -> Iterator[socket.socket]:
    with socket.create_connection(("127.0.0.1", server.port), timeout=20.0) as opened:
        yield opened


def answer_of(opened: socket.socket) -> bytes:
    got = b""
    try:
        while part := opened.recv(65536):
            got += part
    except ConnectionError:
        pass
    return got


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[ServerProcess, Api, Device]]:
    directory = tmp_path_factory.mktemp("overload")
    made = ServerProcess(
        f"sqlite:///{directory}/livella.db", directory, 2, body_timeout="1", max_inflight_bytes="300000"
    )
    with running(made) as api:
        yield made, api, api.add_device()


Running = tuple[ServerProcess, Api, Device]


def test_headers_have_an_end(server: Running) -> None:
    process, api, _ = server
    with connection(process) as opened:
        opened.sendall(b"GET /healthz HTTP/1.1\r\nHost: x\r\n")
        try:
            for _ in range(200):
                opened.sendall(b"X-Long: " + b"a" * 65536 + b"\r\n")
        except ConnectionError:
            pass
    assert httpx.get(f"{process.url}/healthz", headers={"X-Long": "a" * 40_000}).status_code == 431
    assert httpx.get(f"{process.url}/healthz", headers={"X-Long": "a" * 20_000}).status_code == 200
    assert api.client.get("/healthz").status_code == 200


def head_of(device: Device, length: str) -> bytes:
    return (
        f"POST /api/v1/devices/{device.id}/chunks?session=slow&seq=0 HTTP/1.1\r\nHost: x\r\n"
        f"Authorization: Bearer {device.key}\r\nContent-Type: text/csv\r\n{length}\r\n\r\n"
    ).encode()


def test_a_slow_body_is_given_up(server: Running) -> None:
    process, _, device = server
    begun = time.monotonic()
    with connection(process) as opened:
        opened.sendall(head_of(device, "Content-Length: 1000") + b"t,")
        answer = answer_of(opened)
    assert answer.startswith(b"HTTP/1.1 408 ")
    assert b"application/problem+json" in answer
    assert 0.8 < time.monotonic() - begun < 10


def dribble(process: ServerProcess, device: Device) -> tuple[bytes, float]:
    """Send a body that never ends, a byte now and then; give the answer and the seconds it took."""
    begun = time.monotonic()
    with connection(process) as opened:
        opened.sendall(head_of(device, "Transfer-Encoding: chunked"))
        opened.settimeout(0.1)
        while time.monotonic() - begun < 20:
            try:
                return opened.recv(65536), time.monotonic() - begun
            except TimeoutError:
                opened.sendall(b"1\r\n \r\n")
    return b"", time.monotonic() - begun


def test_many_who_dribble_are_given_up_and_hold_nobody_up(tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path}/livella.db"
    process = ServerProcess(url, tmp_path, body_timeout="2", max_uploads="1", upload_threads="1")
    with running(process) as api, ThreadPoolExecutor(DRIBBLERS) as pool:
        device = api.add_device()
        dribbling = [pool.submit(dribble, process, device) for _ in range(DRIBBLERS)]
        time.sleep(1.0)
        begun = time.monotonic()
        assert post(process, device, chunks()[0]).status_code == 200, "they take up neither the thread nor the queue"
        assert api.client.get("/healthz").status_code == 200
        assert time.monotonic() - begun < 5
        for answer, seconds in (waited.result() for waited in dribbling):
            assert answer.startswith(b"HTTP/1.1 408 ")
            assert 1.8 < seconds < 10
        told = figures(api.client.get("/metrics").text)
        assert value(told, "livella_body_bytes") == 0
        assert value(told, "livella_uploads_in_work") == 0


def test_bodies_in_memory_are_bounded(server: Running) -> None:
    process, _, device = server
    sent = {"Content-Type": "text/csv", "Authorization": f"Bearer {device.key}"}
    url = f"{process.url}/api/v1/devices/{device.id}/chunks?session=big&seq=0"
    answers = []
    with ThreadPoolExecutor(8) as pool:
        body = b"t,ax,ay,az,fix\n" + b"x" * 200_000
        answers = [a.status_code for a in pool.map(lambda _: httpx.post(url, content=body, headers=sent), range(40))]
    assert set(answers) <= {422, 503}
    assert 422 in answers, "a body alone is always taken"


def test_a_body_that_is_no_chunk_is_small(server: Running) -> None:
    process, _, _ = server
    url = f"{process.url}/api/v1/devices"

    def endless() -> Iterator[bytes]:
        for _ in range(64):
            yield b" " * 65536

    assert httpx.post(url, content=b" " * 2_000_000).status_code == 413
    with suppress(httpx.TransportError):  # the connection may end while it is still being written to
        assert httpx.post(url, content=endless()).status_code == 413


def test_any_process_answers_for_all(server: Running) -> None:
    process, _, _ = server
    for _ in range(20):
        httpx.get(f"{process.url}/docs")
    seen = set()
    for _ in range(10):
        told = figures(httpx.get(f"{process.url}/metrics").text)
        seen.add(value(told, "livella_http_requests_total", method="GET", route="/docs", status="200"))
    assert seen == {20.0}


def test_the_log_of_a_process_has_no_key(server: Running) -> None:
    process, api, device = server
    device.send(chunks()[0], 0, "logged", expect=200)
    text = process.log.read_text()
    assert "route=/api/v1/devices/{device_id}/chunks status=200" in text
    assert device.key not in text
    assert str(api.key) not in text
