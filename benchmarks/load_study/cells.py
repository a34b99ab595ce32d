"""The cells of the study: a database, an encoding, and how many devices are wanted."""

import os
import resource
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import cache, partial
from pathlib import Path
from typing import NamedTuple

import uvloop

from benchmarks.load_study import drives, fleet, processes, service, slow_disk
from benchmarks.load_study.client import Body, Device, Run
from benchmarks.load_study.pacing import Latency, Plan, bracket, errors, measured, quantiles
from benchmarks.load_study.service import Service
from benchmarks.load_study.slow_disk import Disk
from tests.postgres import find_program, running_server

P99_LIMIT = 0.3
"""s a device may wait for its answer in 99 of 100 cases"""
DRAIN = 30.0
"""s after the last chunk was due until what has no answer counts as lost"""
SPARE_FILES = 1000
"""file descriptors that are no connections"""
SQLITE, POSTGRESQL = "SQLite", "PostgreSQL"


class Cell(NamedTuple):
    """What is held against what."""

    database: str
    encoding: str
    wanted: int
    """devices"""
    fsync: float = 0.0
    """s by which every fsync is made slower"""


CELLS = {
    "sqlite-csv": Cell(SQLITE, drives.CSV, 10_000),
    "sqlite-arrow": Cell(SQLITE, drives.ARROW, 30_000),
    "postgres-csv": Cell(POSTGRESQL, drives.CSV, 8_000),
    "postgres-arrow": Cell(POSTGRESQL, drives.ARROW, 15_000),
    "sqlite-csv-fsync": Cell(SQLITE, drives.CSV, 5_000, 5e-3),
}


class Result(NamedTuple):
    """What a run showed."""

    devices: int
    latency: Latency
    chunks: int
    """answered in the time measured"""
    errors: dict[str, int]
    """by status"""
    unanswered: int
    wrong: int
    """devices of which something acknowledged is not stored once"""
    server_cpu: float
    """s per chunk, database included"""
    database_cpu: float
    """s per chunk of PostgreSQL"""
    generator_cpu: float
    """s per chunk"""
    rss: list[float]
    """MiB per process of the service"""
    fsyncs: float
    """per chunk"""
    connections: int
    cores: float
    """that service, database and generator kept busy"""

    def held(self, limit: float = P99_LIMIT) -> bool:
        """Tell whether the service held so many devices."""
        return self.latency.p99 <= limit and not (self.errors or self.unanswered or self.wrong)


class Meter(NamedTuple):
    """Figures that only ever grow."""

    service: float
    database: float
    generator: float
    fsyncs: float


def why_not(cell: Cell) -> str | None:
    """Say why a cell cannot be measured here, None when it can."""
    if cell.fsync and slow_disk.compiler() is None:
        return "gcc is needed to make fsyncs slower"
    if cell.database == POSTGRESQL and None in {find_program("initdb"), find_program("pg_ctl")}:
        return "PostgreSQL is not installed"
    return None


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


def measure(cell: Cell, plan: Plan) -> Result:
    """Run a cell with so many devices on a fresh database."""
    with tempfile.TemporaryDirectory(prefix="livella-load-") as name, database(cell.database, Path(name)) as (url, pid):
        directory = Path(name)
        disk = slow_disk.prepare(directory, cell.fsync)
        context = fleet.open_context(url, directory)
        try:
            bodies = encoded(cell.encoding)
            like = fleet.prototypes(context, driven())
            devices = fleet.settle(context, like, bodies, plan.devices)
            with service.running(url, directory, disk) as running:
                seen = _play(running, pid, disk, devices, plan)
            return seen._replace(wrong=fleet.check(context, devices).wrong)
        finally:
            context.database.close()


def connections_possible() -> int:
    """Give the connections that the limit of open files allows the generator."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if soft < hard:
        resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))
    return hard - SPARE_FILES


def _play(running: Service, database_pid: int | None, disk: Disk, devices: Sequence[Device], plan: Plan) -> Result:
    meters: list[Meter] = []
    memory: list[float] = []
    read = partial(_read, running.pid, database_pid, disk)

    def at_end() -> None:
        meters.append(read())
        memory.extend(processes.rss(running.pid))

    async def play() -> Run:
        run = Run(running.port, devices, connections_possible())
        await run.connect()
        await run.play(plan, lambda: meters.append(read()), at_end, DRAIN)
        unanswered = run.unanswered()
        await run.close()
        assert unanswered == run.unanswered()
        return run

    run = uvloop.run(play())
    return _conclude(run, plan, meters, memory)


def _read(pid: int, database_pid: int | None, disk: Disk) -> Meter:
    own = processes.read(os.getpid())
    database_cpu = 0.0 if database_pid is None else processes.cpu(database_pid)
    return Meter(processes.cpu(pid), database_cpu, 0.0 if own is None else own.cpu, disk.fsyncs())


def _conclude(run: Run, plan: Plan, meters: Sequence[Meter], memory: list[float]) -> Result:
    answers = measured(run.answers, plan)
    first, last = meters[0], meters[-1]
    spent = Meter(*(after - before for before, after in zip(first, last, strict=True)))
    within = [a for a in run.answers if plan.warm_up <= a.due + a.latency < plan.seconds]
    count = max(1, len(within))
    return Result(
        devices=plan.devices,
        latency=quantiles([answer.latency for answer in answers]),
        chunks=len(answers),
        errors=errors(run.answers),
        unanswered=run.unanswered(),
        wrong=0,
        server_cpu=(spent.service + spent.database) / count,
        database_cpu=spent.database / count,
        generator_cpu=spent.generator / count,
        rss=memory,
        fsyncs=spent.fsyncs / count,
        connections=len(run.connections),
        cores=(spent.service + spent.database + spent.generator) / plan.measure,
    )


def search(cell: Cell, plan: Plan, limit: float, most_runs: int, say: "Say") -> list[Result]:
    """Try the count wanted, and if it is missed, look for the largest that is held; give every run."""
    results: list[Result] = []
    tried: dict[int, bool] = {}
    while len(results) < most_runs:
        count = bracket(tried, cell.wanted, max(1, cell.wanted // 16))
        if count is None:
            break
        results.append(measure(cell, plan._replace(devices=count)))
        tried[count] = results[-1].held(limit)
        say(results[-1])
    return results


class Say:
    """Tells of each run as it ends."""

    def __init__(self, name: str, limit: float) -> None:
        self.name = name
        self.limit = limit

    def __call__(self, result: Result) -> None:
        """Print a line."""
        p50, p95, p99, longest = (1e3 * value for value in result.latency)
        verdict = "held" if result.held(self.limit) else "not held"
        print(
            f"{self.name}: {result.devices} devices {verdict}; p50 {p50:.0f} p95 {p95:.0f} p99 {p99:.0f} "
            f"longest {longest:.0f} ms; {1e3 * result.server_cpu:.2f} ms CPU a chunk, generator "
            f"{1e3 * result.generator_cpu:.2f}; {result.cores:.2f} cores; fsyncs {result.fsyncs:.2f}; "
            f"errors {result.errors}, unanswered {result.unanswered}, wrong {result.wrong}; "
            f"RSS {[round(mib) for mib in result.rss]} MiB",
            flush=True,
        )
