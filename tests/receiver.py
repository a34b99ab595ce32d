"""A receiver of webhooks: a real HTTP server on 127.0.0.1 that remembers what came and answers as told."""

import json
import ssl
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any, NamedTuple


class Call(NamedTuple):
    """A call as it came in."""

    path: str
    headers: dict[str, str]
    body: bytes

    @property
    def json(self) -> Any:
        return json.loads(self.body)

    @property
    def id(self) -> str:
        return self.headers["webhook-id"]


class Answer(NamedTuple):
    """What is answered."""

    status: int = 204
    headers: tuple[tuple[str, str], ...] = ()
    size: int = 0
    drip_seconds: float = 0.0
    """s between two bytes of the answer, when not 0"""


class Receiver:
    """What the server has seen, and what it answers."""

    def __init__(self, url: str) -> None:
        self.url = url
        self.calls: list[Call] = []
        self.answer: Answer | Callable[[Call], Answer] = Answer()
        self.lock = threading.Lock()

    def take(self, call: Call) -> Answer:
        with self.lock:
            self.calls.append(call)
        return self.answer(call) if callable(self.answer) else self.answer

    def wait_for(self, n: int, seconds: float = 20.0) -> list[Call]:
        deadline = time.monotonic() + seconds
        while len(self.calls) < n:
            assert time.monotonic() < deadline, f"{len(self.calls)} calls instead of {n}"
            time.sleep(0.01)
        return self.calls


class Server(ThreadingHTTPServer):
    daemon_threads = True

    def __init__(self, tls: ssl.SSLContext | None) -> None:
        super().__init__(("127.0.0.1", 0), Handler)
        if tls is not None:
            self.socket = tls.wrap_socket(self.socket, server_side=True, do_handshake_on_connect=False)
        scheme = "http" if tls is None else "https"
        self.receiver = Receiver(f"{scheme}://127.0.0.1:{self.server_port}/hook")

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Stay quiet: clients may hang up."""


class Handler(BaseHTTPRequestHandler):
    server: Server

    def do_POST(self) -> None:
        body = self.rfile.read(int(self.headers["content-length"]))
        headers = {name.lower(): value for name, value in self.headers.items()}
        answer = self.server.receiver.take(Call(self.path, headers, body))
        try:
            self._say(answer)
        except OSError:
            self.close_connection = True

    def _say(self, answer: Answer) -> None:
        self.send_response(answer.status)
        for name, value in answer.headers:
            self.send_header(name, value)
        self.end_headers()
        while answer.drip_seconds:
            self.wfile.write(b"x")
            time.sleep(answer.drip_seconds)
        for _ in range(answer.size // 65536):
            self.wfile.write(bytes(65536))

    def log_message(self, format: str, *args: Any) -> None:  # noqa: A002 - the name it has in the library
        """Stay quiet."""


@contextmanager
def running_receiver(tls: ssl.SSLContext | None = None) -> Iterator[Receiver]:
    """Start a receiver and end it."""
    server = Server(tls)
    thread = threading.Thread(target=server.serve_forever, args=(0.02,), daemon=True)
    thread.start()
    try:
        yield server.receiver
    finally:
        server.shutdown()
        server.server_close()
        thread.join()
