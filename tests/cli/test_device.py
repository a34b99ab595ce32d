"""The client against a real server on this machine that answers as told."""

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from email.utils import formatdate
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import NamedTuple

import pytest

from api.commands import device
from api.commands.device import Device, RefusedError, Service, UnavailableError
from tests.cli import livella

PROBLEM = b'{"title": "No", "detail": "because", "status": 409}'


class Answer(NamedTuple):
    status: int
    body: bytes = b"{}"
    retry_after: str | None = None


HANG_UP = Answer(0)


class Server(NamedTuple):
    url: str
    answers: list[Answer]
    times: list[float]
    bodies: list[bytes]
    paths: list[str]


@contextmanager
def answering(*answers: Answer) -> Iterator[Server]:
    """A server that gives these answers, one after the other, and keeps what it was sent."""
    left, times, bodies, paths = list(answers), [], [], []

    class Handler(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            times.append(time.monotonic())
            bodies.append(self.rfile.read(int(self.headers["Content-Length"])))
            paths.append(self.path)
            answer = left.pop(0)
            if answer.status:
                self.send_response(answer.status)
                if answer.retry_after is not None:
                    self.send_header("Retry-After", answer.retry_after)
                self.end_headers()
                self.wfile.write(answer.body)
            self.close_connection = True

        def log_message(self, *_: object) -> None:
            pass

    with ThreadingHTTPServer(("127.0.0.1", 0), Handler) as server:
        thread = threading.Thread(target=server.serve_forever, args=(0.01,))
        thread.start()
        yield Server(f"http://127.0.0.1:{server.server_port}", left, times, bodies, paths)
        server.shutdown()
        thread.join()


@pytest.fixture(autouse=True)
def short_waits(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(device, "_BACKOFF", lambda _: 0.01)


def send(server: Server, patience: float = 20.0) -> tuple[object, list[str]]:
    said: list[str] = []
    with Service(server.url, "key", said.append, patience) as service:
        answer = Device(service, "box 1/2", "s", "text/csv").send(b"content")
    return answer, said


@pytest.mark.parametrize(
    "trouble", [HANG_UP, Answer(408), Answer(429), Answer(500), Answer(502, b"<html>"), Answer(503, PROBLEM)]
)
def test_tries_again_until_it_works(trouble: Answer) -> None:
    with answering(trouble, trouble, Answer(200, b'{"ok": 1}')) as server:
        answer, said = send(server)
    assert answer == {"ok": 1}
    assert len(said) == 2
    assert len(set(server.bodies)) == 1, "the same bytes each time"
    assert set(server.paths) == {"/api/v1/devices/box%201%2F2/chunks?session=s&seq=0&course=auto"}


@pytest.mark.parametrize("seconds", ["1", formatdate(time.time() + 3600, usegmt=True)], ids=["seconds", "date"])
def test_waits_as_long_as_it_is_told_to(seconds: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(device, "LONGEST_WAIT", 1.0)
    with answering(Answer(503, PROBLEM, seconds), Answer(200)) as server:
        send(server)
    assert server.times[1] - server.times[0] >= 1.0


@pytest.mark.parametrize("value", ["", "soon", "-5", "nan"])
def test_a_senseless_retry_after_is_no_trouble(value: str) -> None:
    with answering(Answer(503, PROBLEM, value), Answer(200)) as server:
        assert send(server)[0] == {}


@pytest.mark.parametrize("status", [400, 401, 403, 404, 409, 413, 415, 422])
def test_gives_up_at_once_when_refused(status: int) -> None:
    with answering(Answer(status, PROBLEM), Answer(200)) as server:
        with pytest.raises(RefusedError, match=f"{status} No: because") as caught:
            send(server)
        assert caught.value.status == status
        assert len(server.times) == 1


def test_gives_up_when_its_patience_ends() -> None:
    with answering(*[Answer(503, PROBLEM)] * 1000) as server, pytest.raises(UnavailableError, match="because"):
        send(server, patience=0.3)
    assert len(server.times) > 2


def test_says_that_nobody_is_there() -> None:
    with (
        Service(f"http://127.0.0.1:{livella.free_port()}", "key", lambda _: None, 0.1) as service,
        pytest.raises(UnavailableError, match="cannot be reached"),
    ):
        service.request("GET", "devices")


def test_a_retry_that_waits_is_cut_short(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(device, "_BACKOFF", lambda _: 60.0)
    end = threading.Event()
    threading.Timer(0.2, end.set).start()
    begin = time.monotonic()
    with (
        answering(*[Answer(503, PROBLEM)] * 3) as server,
        Service(server.url, "key", lambda _: None, end=end) as service,
        pytest.raises(UnavailableError),
    ):
        Device(service, "a", "s", "text/csv").send(b"content")
    assert time.monotonic() - begin < 10
