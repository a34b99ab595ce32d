"""Connections that send what never becomes a request."""

import socket
import threading
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from typing import cast

import pytest
import uvicorn
from starlette.types import Receive, Scope, Send

from api.protocol import MAX_HEAD, BoundedProtocol

HEAD = b"POST / HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\n"
ANSWER = b"HTTP/1.1 200 OK\r\n"
UNREAD = "/unread"
"""answered before its body is read"""
PATIENCE = 0.5
"""s"""


class Impatient(BoundedProtocol):
    HEAD_SECONDS = PATIENCE


async def app(scope: Scope, receive: Receive, send: Send) -> None:
    body = b""
    while scope["path"] != UNREAD:
        message = await receive()
        body += message.get("body", b"")
        if not message.get("more_body"):
            if message["type"] != "http.request":
                return
            break
    length = str(len(body)).encode()
    await send({"type": "http.response.start", "status": 200, "headers": [(b"content-length", b"0"), (b"got", length)]})
    await send({"type": "http.response.body"})


@pytest.fixture
def server() -> Iterator[uvicorn.Server]:
    server = uvicorn.Server(uvicorn.Config(app, port=0, http=Impatient, lifespan="off", log_config=None))
    thread = threading.Thread(target=server.run)
    thread.start()
    while not server.started:
        time.sleep(0.01)
    yield server
    server.should_exit = True
    thread.join()


@pytest.fixture
def port(server: uvicorn.Server) -> int:
    return int(server.servers[0].sockets[0].getsockname()[1])


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


def kept(server: uvicorn.Server) -> int:
    """Count the bytes of bodies that connections keep."""
    return sum(len(connection.cycle.body) for connection in cast("set[Impatient]", server.server_state.connections))


def posted(path: str, size: int) -> bytes:
    head = f"POST {path} HTTP/1.1\r\nHost: x\r\nContent-Length: {size}\r\n\r\n"
    return head.encode() + b"a" * size


def test_a_body_that_nobody_read_is_not_kept_until_the_next_request(server: uvicorn.Server, port: int) -> None:
    with connection(port) as opened:
        for _ in range(3):
            opened.sendall(posted(UNREAD, 60_000))
            assert opened.recv(65536).startswith(ANSWER)
            until = time.monotonic() + 5  # the answer may be here before the other thread has done all that follows it
            while kept(server) and time.monotonic() < until:
                time.sleep(0.001)
            assert kept(server) == 0
        opened.sendall(posted("/", 60_000))
        assert b"got: 60000\r\n" in opened.recv(65536)


def test_bodies_of_requests_that_come_at_once_are_all_read(port: int) -> None:
    with connection(port) as opened:
        opened.sendall(posted(UNREAD, 1000) + posted("/", 2000) + posted(UNREAD, 10) + posted("/", 3000))
        got = b""
        while got.count(ANSWER) < 4:
            got += opened.recv(65536)
    assert [int(part.split(b"\r\n")[0]) for part in got.split(b"got: ")[1:]] == [0, 2000, 0, 3000]
