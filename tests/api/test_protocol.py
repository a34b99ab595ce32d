"""Connections that send what never becomes a request."""

import socket
import threading
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress

import pytest
import uvicorn
from starlette.types import Receive, Scope, Send

from api.protocol import MAX_HEAD, BoundedProtocol

HEAD = b"POST / HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\n"
ANSWER = b"HTTP/1.1 200 OK\r\n"
PATIENCE = 0.5
"""s"""


class Impatient(BoundedProtocol):
    HEAD_SECONDS = PATIENCE


async def app(_: Scope, receive: Receive, send: Send) -> None:
    message = await receive()
    while message.get("more_body"):
        message = await receive()
    if message["type"] == "http.request":
        await send({"type": "http.response.start", "status": 200, "headers": [(b"content-length", b"0")]})
        await send({"type": "http.response.body"})


@pytest.fixture
def port() -> Iterator[int]:
    server = uvicorn.Server(uvicorn.Config(app, port=0, http=Impatient, lifespan="off", log_config=None))
    thread = threading.Thread(target=server.run)
    thread.start()
    while not server.started:
        time.sleep(0.01)
    yield int(server.servers[0].sockets[0].getsockname()[1])
    server.should_exit = True
    thread.join()


@contextmanager
def connection(port: int) -> Iterator[socket.socket]:
    with closing(socket.create_connection(("127.0.0.1", port), timeout=10.0)) as opened:
        yield opened


def pour(opened: socket.socket, part: bytes, size: int) -> int:
    """Send so many bytes, part by part, unless the connection is ended; give how many were sent."""
    sent = 0
    with suppress(ConnectionError):
        while sent < size:
            opened.sendall(part)
            sent += len(part)
    return sent


def ends(opened: socket.socket) -> bytes:
    """Read until the other side ends the connection."""
    got = b""
    with suppress(ConnectionError):
        while part := opened.recv(65536):
            got += part
    return got


def test_headers_that_do_not_come_end_the_connection(port: int) -> None:
    for begun in (b"", b"GE", b"GET / HTTP/1.1\r\nHost: x\r\nX-Slow: a"):
        with connection(port) as opened:
            since = time.monotonic()
            opened.sendall(begun)
            assert ends(opened) == b""
            assert PATIENCE * 0.9 < time.monotonic() - since < 5


def test_a_dribble_of_headers_does_not_buy_time(port: int) -> None:
    with connection(port) as opened:
        opened.sendall(HEAD + b"0\r\n\r\n")
        assert opened.recv(65536).startswith(ANSWER)
        opened.sendall(HEAD[:20])
        since = time.monotonic()
        opened.settimeout(0.05)
        while time.monotonic() - since < 5:
            with suppress(TimeoutError):
                if opened.recv(1) == b"":
                    break
            with suppress(ConnectionError):
                opened.sendall(b"a")
        assert time.monotonic() - since < 5


@pytest.mark.parametrize("part", [b"X-Long: " + b"a" * 1000 + b"\r\n", b"a" * 1000])
@pytest.mark.parametrize("before", [b"GET / HTTP/1.1\r\nHost: x\r\nX: ", HEAD + b"1\r\nx\r\n0\r\nX: "])
def test_headers_and_trailers_have_an_end(port: int, before: bytes, part: bytes) -> None:
    with connection(port) as opened:
        opened.sendall(before)
        assert pour(opened, part, 100 * MAX_HEAD) < 100 * MAX_HEAD


def test_a_body_and_a_pause_between_requests_may_take_longer(port: int) -> None:
    with connection(port) as opened:
        for _ in range(2):
            opened.sendall(HEAD)
            for _ in range(4):
                time.sleep(PATIENCE / 2)
                opened.sendall(b"10000\r\n" + b"a" * 0x10000 + b"\r\n")
            opened.sendall(b"0\r\n\r\n")
            assert opened.recv(65536).startswith(ANSWER)
            time.sleep(PATIENCE * 2)
