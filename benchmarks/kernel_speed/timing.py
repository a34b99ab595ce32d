"""Times of things that are run in turn, in random order, so that what else the machine does falls on all alike."""

import gc
import time
from collections.abc import Callable, Mapping
from typing import NamedTuple, TypeVar

import numpy as np

Name = TypeVar("Name")


class Contender(NamedTuple):
    """What is timed."""

    call: Callable[[], object]
    units: int
    """of work in a call"""


class Timing(NamedTuple):
    """Seconds per unit of work."""

    median: float
    least: float


def in_turn(contenders: Mapping[Name, Contender], repeats: int) -> dict[Name, Timing]:
    """Call each once to warm up, then all of them, `repeats` times, each round in an order of its own."""
    calls, rng = list(contenders.values()), np.random.default_rng(0)
    seconds = np.empty((repeats, len(contenders)))
    for contender in calls:
        contender.call()
    gc.disable()
    try:
        for repeat in range(repeats):
            for i in rng.permutation(len(calls)):
                begin = time.perf_counter()
                calls[i].call()
                seconds[repeat, i] = (time.perf_counter() - begin) / calls[i].units
    finally:
        gc.enable()
    columns = zip(contenders, seconds.T, strict=True)
    return {name: Timing(float(np.median(column)), float(column.min())) for name, column in columns}
