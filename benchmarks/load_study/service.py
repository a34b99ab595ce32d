"""The real service as a process of its own."""

import os
import signal
import subprocess
import sys
import time
import urllib.error
import urllib.request
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from benchmarks.accuracy_study.options import ROOT
from benchmarks.load_study.fleet import ADMIN_KEY
from benchmarks.load_study.slow_disk import Disk
from tests.ports import free_port

START = 300.0
"""s until it must be ready, compiling included"""
STOP = 10.0
"""s it may take to end; what is stored is looked at afterwards in any case"""
STREAK = 20
"""answers in a row, each over a connection of its own, after which every process is taken to be ready"""
PAUSE = 0.1
"""s between them: together longer than from the start of the first process to that of the last"""
WORKERS = 2
SETTINGS: dict[str, str] = {
    "LIVELLA_REQUESTS_PER_MINUTE": "1000000",
    "LIVELLA_DEVICE_REQUESTS_PER_MINUTE": "1000000",
    "LIVELLA_RAW_RETENTION_DAYS": "0",  # the cells tell of the path without samples being kept
}
"""Settings of the service under load that are not the defaults, by name in the environment: no limit on calls may
decide the result."""


class Service(NamedTuple):
    """A running service."""

    port: int
    pid: int

    @property
    def url(self) -> str:
        """Where it is."""
        return f"http://127.0.0.1:{self.port}"


@contextmanager
def running(url: str, directory: Path, disk: Disk) -> Iterator[Service]:
    """Run `livella serve` on a database."""
    command = [sys.executable, "-c", "from api.cli import main; main()", "serve", "--workers", str(WORKERS)]
    own = {"LIVELLA_DATABASE_URL": url, "LIVELLA_ADMIN_KEY": ADMIN_KEY, "LIVELLA_DATA_DIR": str(directory)}
    with serving(command, directory, SETTINGS | own | disk.environment) as service:
        yield service


@contextmanager
def running_naive(url: str, directory: Path, disk: Disk) -> Iterator[Service]:
    """Run the baseline on a database."""
    command = [sys.executable, "-m", "uvicorn", "benchmarks.naive:app", "--workers", str(WORKERS), "--no-access-log"]
    command += ["--timeout-keep-alive", "120", "--log-level", "warning"]
    with serving(command, directory, {"NAIVE_DATABASE_URL": url} | disk.environment) as service:
        yield service


@contextmanager
def serving(command: Sequence[str], directory: Path, environment: dict[str, str]) -> Iterator[Service]:
    """Run a command that takes `--port`, from when it says that it is ready, until it has ended."""
    port = free_port()
    log = directory / f"service-{port}.log"
    everything = os.environ | {"PYTHONPATH": str(ROOT), "OPENBLAS_NUM_THREADS": "1"} | environment
    with log.open("wb") as out:
        process = subprocess.Popen(  # noqa: S603 - our own service
            [*command, "--port", str(port)], cwd=ROOT, env=everything, stdout=out, stderr=out, start_new_session=True
        )
    try:
        _wait(process, f"http://127.0.0.1:{port}/readyz", log)
        yield Service(port, process.pid)
    finally:
        _end(process)


def _wait(process: "subprocess.Popen[bytes]", url: str, log: Path) -> None:
    deadline, streak = time.monotonic() + START, 0
    while streak < STREAK:
        if process.poll() is not None or time.monotonic() > deadline:
            raise RuntimeError(f"the service does not start:\n{log.read_text(encoding='utf-8')}")
        streak = streak + 1 if answers(url) else 0
        time.sleep(PAUSE)


def answers(url: str) -> bool:
    """Tell whether a GET of a URL succeeds."""
    try:
        with urllib.request.urlopen(url, timeout=5.0) as answer:  # noqa: S310 - http of our own
            return bool(answer.status == 200)
    except (urllib.error.URLError, OSError):
        return False


def _end(process: "subprocess.Popen[bytes]") -> None:
    process.terminate()
    try:
        process.wait(STOP)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
