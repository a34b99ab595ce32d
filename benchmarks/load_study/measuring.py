"""One run: a database, a fleet in it, the service on it, the generator against the service."""

import os
import resource
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import cache, partial
from pathlib import Path
from statistics import median

import uvloop

from benchmarks.load_study import baseline, drives, fleet, processes, service, slow_disk
from benchmarks.load_study.cells import SQLITE, Cell
from benchmarks.load_study.client import Body, Device, Run
from benchmarks.load_study.pacing import Plan
from benchmarks.load_study.result import Meter, Result, Traffic, conclude
from benchmarks.load_study.service import Service
from benchmarks.load_study.slow_disk import Disk
from tests.postgres import running_server

DRAIN = 15.0
"""s after the last chunk was due until what has no answer counts as lost"""
SPARE_FILES = 1000
"""file descriptors that are no connections"""


class NotSlowedError(Exception):
    """The library that makes fsyncs slower saw none."""


@contextmanager
def database(kind: str, directory: Path) -> Iterator[tuple[str, int | None]]:
    """Give the URL of an empty database, and its server's process."""
    if kind == SQLITE:
        yield f"sqlite:///{directory / 'livella.db'}", None
        return
    with running_server() as server:
        yield server.empty_database(), server.pid


@cache
def driven() -> list[drives.Drive]:
    """Give the pool of drives."""
    return drives.pool()


@cache
def encoded(encoding: str) -> list[list[Body]]:
    """Give the pool as it is sent."""
    return drives.encode_all(driven(), encoding)


def loop(additions: int = 200_000, times: int = 15) -> float:
    """Give the s that a million additions in Python take, in the median: what others do to the machine shows in it."""
    taken = []
    for _ in range(times):
        begun, total = time.perf_counter(), 0
        for number in range(additions):
            total += number
        taken.append(time.perf_counter() - begun)
    return 1e6 / additions * median(taken)


def measure(cell: Cell, plan: Plan) -> Result:
    """Run a cell with so many devices on a fresh database."""
    before = loop()
    connections_possible()  # before the service is started, which inherits the limit
    with tempfile.TemporaryDirectory(prefix="livella-load-") as name, database(cell.database, Path(name)) as (url, pid):
        directory = Path(name)
        disk = slow_disk.prepare(directory, cell.fsync)
        play = partial(_measure_naive, url) if cell.naive else partial(_measure, url, pid)
        result = play(cell, plan, directory, disk)
    if cell.fsync and not result.fsyncs > 0.0:
        raise NotSlowedError("the fsyncs of this Python's SQLite cannot be made slower")
    return result._replace(loop=(before, loop()))


def _measure(url: str, database_pid: int | None, cell: Cell, plan: Plan, directory: Path, disk: Disk) -> Result:
    context = fleet.open_context(url, directory)
    try:
        bodies = encoded(cell.encoding)
        devices = fleet.settle(context, fleet.prototypes(context, driven()), bodies, plan.devices)
        with service.running(url, directory, disk) as running:
            seen = _play(running, database_pid, disk, devices, plan)
        return seen._replace(wrong=fleet.check(context, devices).wrong)
    finally:
        context.database.close()


def _measure_naive(url: str, cell: Cell, plan: Plan, directory: Path, disk: Disk) -> Result:
    devices = baseline.settle(url, encoded(cell.encoding), plan.devices)
    with service.running_naive(url, directory, disk) as running:
        seen = _play(running, None, disk, devices, plan)
    return seen._replace(wrong=baseline.count_wrong(url, devices))


def connections_possible() -> int:
    """Give the connections that the limit of open files allows the generator."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if soft < hard:
        resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))
    return hard - SPARE_FILES


def _play(running: Service, database_pid: int | None, disk: Disk, devices: Sequence[Device], plan: Plan) -> Result:
    assert plan.seconds <= drives.CHUNK * drives.DURING, "a device would drive its first minute again"
    meters: list[Meter] = []
    memory: list[float] = []
    read = partial(_read, running.pid, database_pid, disk)

    def at_end() -> None:
        meters.append(read())
        memory.extend(processes.rss(running.pid)[: service.WORKERS])

    async def play() -> Traffic:
        run = Run(running.port, devices, connections_possible())
        await run.connect()
        await run.until_ready(service.START)
        ended = await run.play(plan, lambda: meters.append(read()), at_end, DRAIN)
        traffic = Traffic(list(run.answers), run.unanswered(), len(run.connections), ended)
        await run.close()
        return traffic

    return conclude(uvloop.run(play()), plan, meters[0], meters[-1], memory)


def _read(pid: int, database_pid: int | None, disk: Disk) -> Meter:
    own = processes.read(os.getpid())
    database_cpu = 0.0 if database_pid is None else processes.cpu(database_pid)
    seen = disk.fsyncs() if database_pid is None else float("nan")  # those of PostgreSQL are its own
    return Meter(processes.cpu(pid), database_cpu, 0.0 if own is None else own.cpu, seen)
