"""What a camera that looks at the steering wheel askew makes of its plane, learned from the markers themselves.

Points of an image are complex numbers, right + i up. Seen askew a circle becomes an ellipse, and its far side smaller
than its near one. Both are undone by

    (x, y) -> ((1 + a) x + b y, b x + (1 - a) y) / (1 + c x + d y)

the part of a homography that is no turn, shift or scale. Under the right (a, b, c, d) the figure of the markers stays
congruent to itself however the wheel is turned; they are found as those for which it does best.
"""

from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

from core.motion.steering_terms import Complexes, Floats

NONE = np.zeros(4)
PRIOR = np.array([0.15, 0.15, 0.1, 0.1])
"""1 sigma of the four numbers before anything is known; they matter where the wheel was hardly turned"""
POINT_SIGMA = 0.01
"""1 sigma of a marker's place, by the radius of the figure"""
FRAMES = 150
"""frames that are looked at"""
LARGEST = 0.6
"""of each number; beyond it the wheel would be seen from the side"""


class Sighting(NamedTuple):
    """Markers of one frame whose identity is known."""

    frame: int
    member: np.ndarray
    """(K,) which of the figure's points"""
    point: Complexes
    """(K,) where in the image"""
    rotation: float
    """rad, as far as it is known"""


def rectified(p: Floats, z: Complexes) -> Complexes:
    """Give points of the image as the wheel's plane would look from straight ahead, turned and shifted somehow."""
    a, b, c, d = p
    x, y = z.real, z.imag
    flat: Complexes = ((1 + a) * x + b * y + 1j * (b * x + (1 - a) * y)) / np.maximum(1 + c * x + d * y, 0.1)
    return flat


def rotation_between(figure: Complexes, points: Complexes) -> float:
    """Angle of the rotation that best takes a figure (K,) to points (K,), both about their centroids (phases e-g).

    Minimises sum |z - mean z - exp(i angle) (m - mean m)|^2: Procrustes in the plane, closed form, no reflection.
    """
    return float(np.angle(np.vdot(figure - figure.mean(), points - points.mean())))


def learn(sightings: list[Sighting], members: int) -> Floats:
    """(4,) Find the rectification from sightings of at least three markers each."""
    chosen = _spread([s for s in sightings if s.member.size >= 3])
    if len(chosen) < 3:
        return NONE
    tables = _tables(chosen, members)
    bounds = (np.full(4, -LARGEST), np.full(4, LARGEST))
    return least_squares(_misfit, NONE, bounds=bounds, loss="soft_l1", args=tables).x


def _spread(sightings: list[Sighting]) -> list[Sighting]:
    """Choose frames evenly over the angles that occur, not over time: wheels are straight mostly."""
    order = sorted(sightings, key=lambda s: s.rotation)
    if len(order) <= FRAMES:
        return order
    rotation = np.array([s.rotation for s in order])
    steps = np.linspace(rotation[0], rotation[-1], FRAMES)
    nearest = np.clip(np.searchsorted(rotation, steps), 0, len(order) - 1)
    evenly = np.linspace(0, len(order) - 1, FRAMES // 3).astype(int)
    return [order[k] for k in np.unique(np.concatenate([nearest, evenly]))]


def _tables(sightings: list[Sighting], members: int) -> tuple[Complexes, Floats, Floats]:
    """Points (F, M), 0 where not seen; whether they are seen (F, M); rotations (F, 1)."""
    points, seen = np.zeros((len(sightings), members), np.complex128), np.zeros((len(sightings), members))
    for row, sighting in enumerate(sightings):
        points[row, sighting.member], seen[row, sighting.member] = sighting.point, 1.0
    return points, seen, np.array([[s.rotation] for s in sightings])


def _misfit(p: Floats, points: Complexes, seen: Floats, rotation: Floats) -> Floats:
    """By how much the figure is not congruent to itself, in sigmas, and the numbers in theirs."""
    flat = rectified(p, points) * seen
    count = seen.sum(axis=1, keepdims=True)
    turn, shift = np.exp(1j * rotation), np.zeros_like(rotation)
    for _ in range(4):  # figure, shifts and rotations in turns, each best for the others
        figure = ((flat - shift * seen) / turn).sum(axis=0) / np.maximum(seen.sum(axis=0), 1.0)
        shift = (flat - turn * figure * seen).sum(axis=1, keepdims=True) / count
        product = ((flat - shift * seen) * np.conj(figure)).sum(axis=1, keepdims=True)
        turn = product / np.maximum(np.abs(product), 1e-12)
    miss = ((flat - shift - turn * figure) * seen)[seen > 0]
    return np.concatenate([miss.real, miss.imag, np.asarray(p) / PRIOR * POINT_SIGMA]) / POINT_SIGMA
