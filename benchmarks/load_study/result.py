"""What a run showed. Pure."""

from collections.abc import Sequence
from typing import NamedTuple

from benchmarks.load_study.pacing import OK, PERIOD, Answer, Latency, Plan, errors, measured, quantiles


class Result(NamedTuple):
    """What a run showed."""

    devices: int
    seconds: float
    """measured"""
    latency: Latency
    chunks: int
    """due and answered in the time measured"""
    served: float
    """devices that post as often as was answered"""
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
    """MiB per server process at the end"""
    fsyncs: float
    """per chunk"""
    connections: int
    cores: float
    """that service, database and generator kept busy"""
    loop: tuple[float, float] = (float("nan"), float("nan"))
    """s that `measuring.loop` took before and after: how quick the machine was"""

    def held(self, limit: float) -> bool:
        """Tell whether the service held so many devices."""
        return self.latency.p99 <= limit and not (self.errors or self.unanswered or self.wrong)

    @property
    def generator_share(self) -> float:
        """Share of the CPU that the load generator took."""
        whole = self.server_cpu + self.generator_cpu
        return self.generator_cpu / whole if whole else float("nan")


class Meter(NamedTuple):
    """Figures that only ever grow."""

    service: float
    database: float
    generator: float
    fsyncs: float


class Traffic(NamedTuple):
    """What the generator saw."""

    answers: Sequence[Answer]
    unanswered: int
    connections: int
    ended: float
    """s after the start"""


def conclude(traffic: Traffic, plan: Plan, first: Meter, last: Meter, rss: list[float]) -> Result:
    """Make a result of the traffic, and of the meters after the warm-up and at the end."""
    plan = plan.ended(traffic.ended)
    due = measured(traffic.answers, plan)
    spent = Meter(*(after - before for before, after in zip(first, last, strict=True)))
    count = max(1, sum(plan.warm_up <= a.due + a.latency < plan.seconds for a in traffic.answers if a.status == OK))
    return Result(
        devices=plan.devices,
        seconds=plan.measure,
        latency=quantiles([answer.latency for answer in due]),
        chunks=len(due),
        served=count / plan.measure * PERIOD,
        errors=errors(traffic.answers),
        unanswered=traffic.unanswered,
        wrong=0,
        server_cpu=(spent.service + spent.database) / count,
        database_cpu=spent.database / count,
        generator_cpu=spent.generator / count,
        rss=rss,
        fsyncs=spent.fsyncs / count,
        connections=traffic.connections,
        cores=(spent.service + spent.database + spent.generator) / plan.measure,
    )


def largest_held(results: Sequence[Result], limit: float) -> Result | None:
    """Give the run with the most devices among those held, the quickest of them."""
    held = [result for result in results if result.held(limit)]
    return max(held, key=lambda result: (result.devices, -result.latency.p99), default=None)
