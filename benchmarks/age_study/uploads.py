"""Uploads of old devices beside those of fresh ones: the same chunks in turn, so that noise falls on both alike."""

import time
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from api.services import ingest, intake
from api.services.context import Context
from benchmarks.accuracy_study.statistics import quantile
from benchmarks.age_study.pair import Pair
from benchmarks.load_study.drives import ARROW, Drive, encode
from benchmarks.load_study.fleet import chunk

AGES = ("old", "fresh")


class Latency(NamedTuple):
    """Of one kind of device, s."""

    median: float
    p99: float


class Uploads(NamedTuple):
    """What uploads took."""

    old: Latency
    fresh: Latency
    number: int
    """of each kind"""


def measure(compared: Pair, drives: Sequence[Drive], rounds: int) -> Uploads:
    """Let every device drive its first minutes, then time so many more of each."""
    generator = np.random.default_rng(0)
    seconds: dict[str, list[float]] = {age: [] for age in AGES}
    for position, (device_id, sent) in enumerate(_sent(compared, drives, rounds)):
        contexts = {"old": compared.old, "fresh": compared.fresh}
        counted = position >= len(compared.senders) * len(drives[0].before)
        for age in generator.permutation(AGES).tolist():
            taken = _time(intake.receive, contexts[age], device_id, sent)
            if counted:
                seconds[age].append(taken)
    return Uploads(_latency(seconds["old"]), _latency(seconds["fresh"]), len(seconds["old"]))


def _sent(compared: Pair, drives: Sequence[Drive], rounds: int) -> Iterator[tuple[str, ingest.Chunk]]:
    """Give what is sent, one device after the other; one whose drive is over is switched on and drives it again."""
    bodies = [[encode(minute, ARROW) for minute in (*drive.before, *drive.during)] for drive in drives]
    for turn in range(len(drives[0].before) + rounds):
        for n, device_id in enumerate(compared.senders):
            minutes = bodies[n % len(bodies)]
            session, seq = divmod(turn, len(minutes))
            yield device_id, chunk(seq, minutes[seq], f"drive {session}")


def _time(
    receive: Callable[[Context, str, ingest.Chunk], object], context: Context, device_id: str, sent: ingest.Chunk
) -> float:
    begun = time.perf_counter()
    receive(context, device_id, sent)
    return time.perf_counter() - begun


def _latency(seconds: Sequence[float]) -> Latency:
    return Latency(quantile(seconds, 0.5), quantile(seconds, 0.99))
