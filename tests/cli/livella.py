"""The real command in a process of its own."""

import json
import os
import re
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import httpx

COMMAND = (sys.executable, "-m", "api.cli")
KEY = re.compile(r"livella_[A-Za-z0-9_-]{43}")
TIMEOUT = 300.0
"""s; compiling the estimator on a busy machine takes long"""


class Result(NamedTuple):
    status: int
    out: str
    err: str

    @property
    def lines(self) -> list[dict[str, Any]]:
        return [json.loads(line) for line in self.out.splitlines()]


def environment(**more: str) -> dict[str, str]:
    """The environment without settings, on a wide terminal that is none."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith("LIVELLA_")}
    return kept | {"COLUMNS": "200"} | more


def run(*arguments: object, **more: str) -> Result:
    done = subprocess.run(
        [*COMMAND, *map(str, arguments)],
        capture_output=True,
        text=True,
        env=environment(**more),
        timeout=TIMEOUT,
        check=False,
    )
    assert "Traceback" not in done.stderr, done.stderr
    return Result(done.returncode, done.stdout, done.stderr)


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


class Running(NamedTuple):
    """A command that runs on until told to end."""

    process: subprocess.Popen[str]
    log: Path

    def output(self) -> str:
        return self.log.read_text()

    def wait_for(self, url: str) -> None:
        """Wait until an address answers well."""
        deadline = time.monotonic() + TIMEOUT
        while time.monotonic() < deadline:
            assert self.process.poll() is None, self.output()
            try:
                if httpx.get(url, timeout=5).is_success:
                    return
            except httpx.TransportError:
                pass
            time.sleep(0.1)
        raise AssertionError(f"{url} does not answer:\n{self.output()}")

    def end(self, signal: int) -> int:
        self.process.send_signal(signal)
        return self.process.wait(timeout=60)


@contextmanager
def running(*arguments: object, log: Path, **more: str) -> Iterator[Running]:
    """A command that is ended after the block if it has not ended by itself."""
    with log.open("a") as out:
        process = subprocess.Popen(
            [*COMMAND, *map(str, arguments)], stdout=out, stderr=out, env=environment(**more), text=True
        )
    try:
        yield Running(process, log)
    finally:
        if process.poll() is None:
            process.kill()
        process.wait()


@contextmanager
def serving(directory: Path, port: int | None = None, **more: str) -> Iterator[tuple[str, Running]]:
    """The service, ready, with its address."""
    port = port or free_port()
    url = f"http://127.0.0.1:{port}"
    with running("serve", "--port", port, "--data-dir", directory / "data", log=directory / "log", **more) as service:
        service.wait_for(f"{url}/readyz")
        yield url, service
