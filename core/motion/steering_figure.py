"""The figure that the markers form on the steering wheel, and where it lies in a frame. Points are complex numbers."""

from dataclasses import dataclass
from typing import NamedTuple, Self

import numpy as np

from core.motion.steering_rectification import rotation_between
from core.motion.steering_terms import Complexes

TRUSTED_HITS = 8
"""frames in which a point must have been seen before it counts"""
PATIENCE = 4
"""times as often as it was seen a point may be missed before it no longer counts"""
MOST_POINTS = 40
"""of a figure; more are noise"""
SCALE_RANGE = (0.85, 1.18)
"""by which two markers' distance may differ from the figure's, in the search of the whole circle"""
MOST_TRIALS = 4000
NEARNESS = 0.15
"""of a point's worth that a radian of distance to the prediction costs, in the search of the whole circle"""


class Pose(NamedTuple):
    """How a figure lies in a frame."""

    rotation: float
    """rad, anti-clockwise, not limited to a turn"""
    shift: complex

    def placed(self, figure: Complexes) -> Complexes:
        """Give the figure's points in the frame."""
        there: Complexes = figure * np.exp(1j * self.rotation) + self.shift
        return there

    def taken_back(self, points: Complexes) -> Complexes:
        """Give points of the frame as points of the figure."""
        back: Complexes = (points - self.shift) * np.exp(-1j * self.rotation)
        return back


@dataclass
class Figure:
    """Points of a figure, learned while it is followed."""

    point: Complexes
    """(M,)"""
    hits: np.ndarray
    """(M,) frames in which it was seen"""
    misses: np.ndarray
    """(M,) frames in which it was not, though the figure was"""

    @classmethod
    def of(cls, points: Complexes) -> Self:
        """Take the points of a frame, which all count until they are missed."""
        return cls(points.copy(), np.full(points.size, TRUSTED_HITS), np.zeros(points.size, int))

    @property
    def size(self) -> int:
        """Number of points, trusted or not."""
        return self.point.size

    @property
    def trusted(self) -> np.ndarray:
        """Which points count."""
        return np.flatnonzero((self.hits >= TRUSTED_HITS) & (self.misses <= PATIENCE * self.hits))

    def learn(self, pose: Pose, points: Complexes, member: np.ndarray, which: np.ndarray, gate: float) -> None:
        """Take in a frame in which some members were seen; points that belong to nobody may be new ones."""
        back = pose.taken_back(points)
        self.misses += 1
        self._see(member, back[which])
        for point in np.delete(back, which):
            distance = np.abs(self.point - point)
            nearest = int(np.argmin(distance))
            if distance[nearest] < gate / 2 and nearest not in member:
                self._see(np.array([nearest]), np.array([point]))
            elif distance[nearest] > 2 * gate and self.size < MOST_POINTS:
                self.point, self.hits, self.misses = (
                    np.append(x, new) for x, new in ((self.point, point), (self.hits, 1), (self.misses, 0))
                )

    def _see(self, member: np.ndarray, at: Complexes) -> None:
        self.misses[member] -= 1
        self.hits[member] += 1
        self.point[member] += (at - self.point[member]) / self.hits[member]


def fit_pose(figure: Complexes, points: Complexes, near: float) -> Pose:
    """Pose that best takes points of the figure (K,) to points of a frame (K,); the turn nearest to `near`, rad."""
    angle = rotation_between(figure, points)
    angle += 2 * np.pi * round((near - angle) / (2 * np.pi))
    return Pose(angle, complex(points.mean() - figure.mean() * np.exp(1j * angle)))


def search(figure: Complexes, points: Complexes, near: float, gate: float, nearness: float = NEARNESS) -> Pose | None:
    """Find the figure in a frame at any rotation: each pair of its points on each pair of the frame's is tried.

    The pose that explains most points best; among equals, as with markers at even distances, that nearest to `near`.
    """
    k, m = (x.ravel() for x in np.nonzero(~np.eye(figure.size, dtype=bool)))
    i, j = (x.ravel() for x in np.nonzero(~np.eye(points.size, dtype=bool)))
    if not k.size or not i.size:
        return None
    ratio = (points[j] - points[i])[None, :] / (figure[m] - figure[k] + 1e-12)[:, None]
    pairs, others = np.nonzero((np.abs(ratio) > SCALE_RANGE[0]) & (np.abs(ratio) < SCALE_RANGE[1]))
    if not pairs.size:
        return None
    thin = max(pairs.size // MOST_TRIALS, 1)
    pairs, others = pairs[::thin], others[::thin]
    turn = ratio[pairs, others] / np.abs(ratio[pairs, others])
    shift = points[i[others]] - figure[k[pairs]] * turn
    placed = figure[None, :] * turn[:, None] + shift[:, None]
    miss = np.abs(placed[:, :, None] - points[None, None, :]).min(axis=2)
    cost = np.minimum(miss / gate, 1.0) ** 2  # of a point that is not there: 1, however far the next one is
    away = np.abs((np.angle(turn) - near + np.pi) % (2 * np.pi) - np.pi)
    best = int(np.argmin(cost.sum(axis=1) + nearness * away))
    angle = float(np.angle(turn[best]))
    return Pose(angle + 2 * np.pi * round((near - angle) / (2 * np.pi)), complex(shift[best]))
