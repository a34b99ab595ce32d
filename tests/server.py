"""The service as a process of its own, which can be stopped and killed."""

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx

from api.app import READY
from tests.service import ADMIN_KEY, COMPILE_SECONDS, NO_LIMITS, Api

ROOT = Path(__file__).parent.parent


class ServerProcess:
    """A server on a port of its own; the port stays the same when it is started again."""

    def __init__(self, database_url: str, directory: Path, workers: int = 1, **settings: str) -> None:
        with socket.socket() as listener:
            listener.bind(("127.0.0.1", 0))
            self.port = int(listener.getsockname()[1])
        self.url = f"http://127.0.0.1:{self.port}"
        self.workers = workers
        self.log = directory / "server.log"
        self.environment = os.environ | {
            "LIVELLA_DATABASE_URL": database_url,
            "LIVELLA_ADMIN_KEY": ADMIN_KEY,
            **{f"LIVELLA_{name.upper()}": str(value) for name, value in NO_LIMITS.items()},
            **{f"LIVELLA_{name.upper()}": value for name, value in settings.items()},
        }
        self.process: subprocess.Popen[bytes] | None = None
        self._begun = 0

    def start(self) -> None:
        """Start without waiting."""
        command = [sys.executable, "-m", "api.cli", "serve", "--port", str(self.port), "--workers", str(self.workers)]
        with self.log.open("ab") as log:
            self._begun = log.tell()
            self.process = subprocess.Popen(
                command, cwd=ROOT, env=self.environment, stdout=log, stderr=log, start_new_session=True
            )

    def wait_until_ready(self) -> None:
        """Wait until every process has compiled the estimator; `/readyz` speaks only for the one that answers."""
        deadline = time.monotonic() + COMPILE_SECONDS
        while not (self._ready_processes() >= self.workers and self._is_ready()):
            assert self.process is not None
            assert self.process.poll() is None, self.log.read_text()
            assert time.monotonic() < deadline, self.log.read_text()
            time.sleep(0.02)

    def _ready_processes(self) -> int:
        """Count the processes that were ready since the last start; one that was replaced counts twice."""
        return self.log.read_bytes()[self._begun :].count(READY.encode())

    def _is_ready(self) -> bool:
        try:
            return httpx.get(f"{self.url}/readyz", timeout=1.0).status_code == 200
        except httpx.TransportError:
            return False

    def kill(self) -> None:
        """End it with no chance to tidy up."""
        assert self.process is not None
        os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()

    def stop(self, seconds: float = 15.0) -> float:
        """Ask it to end; give the seconds that took."""
        assert self.process is not None
        begun = time.monotonic()
        self.process.terminate()
        try:
            self.process.wait(seconds)
        except subprocess.TimeoutExpired:
            raise AssertionError(self.log.read_text()) from None
        return time.monotonic() - begun


@contextmanager
def running(server: ServerProcess) -> Iterator[Api]:
    """Start a server and end it; give it for an administrator."""
    server.start()
    try:
        server.wait_until_ready()
        with httpx.Client(base_url=server.url, timeout=20.0) as client:
            yield Api(client)
    finally:
        if server.process is not None and server.process.poll() is None:
            server.kill()
