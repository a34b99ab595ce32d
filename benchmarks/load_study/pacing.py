"""When each device posts, and what is said of the answers. Pure.

Open loop: a chunk is due when its minute is over, however long the answers before it take, and its latency counts from
then. A service that stalls is charged with everything that was due meanwhile.
"""

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

PERIOD = 60.0
"""s between two chunks of a device"""
CAREFUL = 0.8
"""of what an overloaded service answers it is likely to hold so much"""
OK = 200


class Answer(NamedTuple):
    """What became of a chunk."""

    due: float
    """s since the start"""
    latency: float
    """s from then to the last byte of the answer"""
    status: int
    """0: the connection broke"""


class Latency(NamedTuple):
    """Quantiles, s; nan when there was no answer."""

    p50: float
    p95: float
    p99: float
    longest: float


class Plan(NamedTuple):
    """One run."""

    devices: int
    warm_up: float
    """s at the beginning that are not measured"""
    measure: float
    """s"""

    @property
    def seconds(self) -> float:
        """How long chunks become due."""
        return self.warm_up + self.measure

    @property
    def rate(self) -> float:
        """Chunks due per s."""
        return self.devices / PERIOD

    def ended(self, seconds: float) -> "Plan":
        """Give the plan as it was carried out, when it ended after so many s."""
        return self._replace(measure=seconds - self.warm_up)


def schedule(plan: Plan, period: float = PERIOD) -> list[tuple[float, int]]:
    """Give when chunks are due in a run, and of which device: evenly spread, the devices in any order, always the same.

    In the order of their numbers they would come as they were registered and connected. A process accepts several
    connections at a time, so dozens of chunks in a row would go to one process while the other has nothing to do.
    """
    order = np.random.default_rng(0).permutation(plan.devices).tolist()
    count = math.ceil(plan.seconds * plan.devices / period)
    return [(period * place / plan.devices, order[place % plan.devices]) for place in range(count)]


def quantiles(latencies: Sequence[float]) -> Latency:
    """Give the quantiles, each of them one of the values, rounded up in rank."""
    if not latencies:
        return Latency(*[float("nan")] * 4)
    return Latency(*(float(value) for value in np.quantile(latencies, [0.5, 0.95, 0.99, 1.0], method="higher")))


def measured(answers: Iterable[Answer], plan: Plan) -> list[Answer]:
    """Give the answers to the chunks that were due after the warm-up."""
    return [answer for answer in answers if plan.warm_up <= answer.due < plan.seconds]


def errors(answers: Iterable[Answer]) -> dict[str, int]:
    """Count what was no 200, by status."""
    counted = Counter(
        "broken" if answer.status == 0 else str(answer.status) for answer in answers if answer.status != OK
    )
    return dict(sorted(counted.items()))


def halfway(good: int, bad: int, step: int) -> int | None:
    """Give the count to try next between one that was held and one that was not; None when they are close enough."""
    middle = (good + bad) // 2 // step * step
    return middle if good < middle < bad else None


def below(missed: int, served: float, step: int) -> int | None:
    """Give the count to try after one that was missed: somewhat fewer than could be served then."""
    count = max(step, min(int(CAREFUL * served), missed // 2 + missed // 4) // step * step)
    return count if count < missed else None


def next_count(tried: Mapping[int, bool], served: float, first: int, step: int, beyond: bool) -> int | None:
    """Give the count to try next, None when the largest one held is known well enough.

    The first one is given; if it was missed, one that fits what was `served` when the smallest count was missed; then
    between the largest held and the smallest not held. When all were held, that is enough, unless the largest is
    wanted: then half as many again.
    """
    if not tried:
        return first
    held = max((count for count, good in tried.items() if good), default=0)
    missed = min((count for count, good in tried.items() if not good), default=0)
    if not missed:
        return held * 3 // 2 // step * step if beyond else None
    return halfway(held, missed, step) if held else below(missed, served, step)
