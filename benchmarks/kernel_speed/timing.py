"""Times of things that are run in turn, so that what else the machine does falls on all alike."""

import gc
import time
from collections.abc import Callable, Mapping
from typing import NamedTuple, TypeVar

import numpy as np

Name = TypeVar("Name")


class Contender(NamedTuple):
    """What is timed."""

    call: Callable[[], object]
    count: int
    """units of work in a call"""


class Timing(NamedTuple):
    """Seconds per unit of work."""

    median: float
    least: float


def in_turn(contenders: Mapping[Name, Contender], repeats: int) -> dict[Name, Timing]:
    """Call each once to warm up, then all of them in turn, `repeats` times, without garbage collection."""
    seconds = np.empty((repeats, len(contenders)))
    for contender in contenders.values():
        contender.call()
    gc.disable()
    try:
        for repeat in range(repeats):
            for i, contender in enumerate(contenders.values()):
                begin = time.perf_counter()
                contender.call()
                seconds[repeat, i] = (time.perf_counter() - begin) / contender.count
    finally:
        gc.enable()
    columns = zip(contenders, seconds.T, strict=True)
    return {name: Timing(float(np.median(column)), float(column.min())) for name, column in columns}
