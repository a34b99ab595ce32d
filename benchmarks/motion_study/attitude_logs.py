"""Logs the attitude filters are compared on, and what is made of their errors."""

from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core import quaternion
from core.simulation_marg import MargLog, MargScenario, simulate

Floats = NDArray[np.float64]

SEEDS = range(9001, 9004)
"""none of those the filters were tuned on, which are below 1000"""
SECONDS = 100.0
SETTLED = 5.0
"""s from which errors count: the sensor is taken up after 4 s"""
MOTIONS = {
    "level": "near the level",
    "walk": "walking pace",
    "brisk": "brisk, all ways up",
    "violent": "violent, all ways up",
}


class Cell(NamedTuple):
    """A kind of logs."""

    motion: str
    disturbed: bool

    def logs(self) -> list[MargLog]:
        """Simulate the logs."""
        return [simulate(MargScenario(self.motion, SECONDS, seed, disturbed=self.disturbed)) for seed in SEEDS]


CELLS = [Cell(motion, disturbed) for disturbed in (False, True) for motion in MOTIONS]


class Error(NamedTuple):
    """Root mean square over the logs of a cell, degrees."""

    tilt: float
    heading: float


def angles(found: Floats, log: MargLog) -> tuple[Floats, Floats]:
    """Tilt and heading errors (N,), rad: the rotation left over, parted into one about the vertical and a tilt."""
    off = quaternion.multiply(found, quaternion.conjugate(log.q_ns))
    heading = 2 * np.arctan2(off[:, 3], off[:, 0])
    tilt = 2 * np.arcsin(np.minimum(np.hypot(off[:, 1], off[:, 2]), 1.0))
    return tilt, (heading + np.pi) % (2 * np.pi) - np.pi


def error(find: Callable[[MargLog], Floats], logs: Iterable[MargLog], since: float = SETTLED) -> Error:
    """Error of what finds attitudes (N, 4) in logs, from `since` (s) on."""
    squares = []
    for log in logs:
        settled = log.samples.t >= since
        squares.append([np.mean(angle[settled] ** 2) for angle in angles(find(log), log)])
    tilt, heading = np.degrees(np.sqrt(np.mean(squares, axis=0)))
    return Error(float(tilt), float(heading))
