"""Steering-wheel angle from markers on the wheel that a camera sees (seed 004, phases a-h).

    found = from_markers(t, points)
    found.steering.angle        rad, positive to the left, 0 = as in the first half second (phase a)

Between two frames the rotation is that which best takes one figure of markers to the other after their centroids have
been brought together (e-g). The document adds these rotations up (h), and their errors with them; here each frame is
also matched with one figure learned from all of them, so that errors do not add up. Markers are all alike: which is
which comes from where the last frames predict them. Some may be hidden, and some may be none.

Corrected in the document: (f) X_k+1,c = X_k - T_k+1 must be X_k+1 - T_k+1; (g) minimises over rotations only, a
reflection is excluded.
"""

from collections.abc import Sequence
from math import radians
from typing import NamedTuple

import numpy as np

from core.motion.steering_figure import Figure, Pose, fit_pose
from core.motion.steering_match import DEFAULT, EXTRAPOLATED, MarkerParameters, Track, match, match_anywhere
from core.motion.steering_rectification import Sighting, learn, rectified, rotation_between
from core.motion.steering_terms import Complexes, Floats, Steering, SteeringError

MOST_PARTS = 4
"""between breaks that are looked at"""
RARE = 0.35
"""of the rotations at which the most frequent marker is seen; what is seen at fewer is none"""
ROTATION_BIN = radians(8.0)
FEWEST = 4
"""markers of which none is left out for its misfit"""
ODD_MISFIT, ODD_RATIO = 0.02, 2.0
"""misfit of a marker, and by how much it is that of the usual one, that make it none"""


class Markers(NamedTuple):
    """Steering from markers, and what was found on the way."""

    steering: Steering
    by_increments: Floats
    """(N,) rad, sum of the rotations between neighbouring frames (h)"""
    figure: Complexes
    """(M,) the markers on the wheel, by the radius of their figure"""
    view: Floats
    """(4,) rectification, as `steering_rectification.rectified` takes it"""
    seen: np.ndarray
    """(N,) markers used in each frame"""


class _Pass(NamedTuple):
    """One going through all frames."""

    rotation: Floats
    """(N,) rad, nan where no match was found"""
    misfit: Floats
    """(N,) root mean square by which the markers miss the figure"""
    sightings: list[Sighting]
    figure: Figure


def from_markers(
    t: Floats,
    points: Sequence[Floats],
    params: MarkerParameters = DEFAULT,
    from_behind: bool = False,
    straight: float | None = None,
) -> Markers:
    """Find the steering-wheel angle from the places of markers.

    Parameters
    ----------
    t
        (N,) s
    points
        of each frame (K, 2), pixels to the right and down, in any order
    from_behind
        the camera looks at the wheel from the windscreen
    straight
        s at which the wheel is straight; None = at the start

    Raises
    ------
    SteeringError
        there is no frame with three markers, or hardly any frame matches the others.
    """
    first = next((k for k, z in enumerate(points) if len(z) >= params.least), None)
    if first is None:
        raise SteeringError(f"No frame shows {params.least} markers.")
    frames = _normalised(points, first)
    start = _acquired(t, frames, params)
    for _ in range(params.passes):
        gate = float(np.clip(params.gate_misfits * start.misfit, *params.gates))
        done = _follow(t, frames, start.figure, start.view, gate, params)
        view = start.view
        if not done.sightings:
            break
        start = _learned(done.sightings, start.figure)
    if np.isfinite(done.rotation).mean() < 0.1:
        raise SteeringError("The markers of hardly any frame match those of the others: are they fixed to the wheel?")
    return _found(t, done, view, params, -1.0 if from_behind else 1.0, straight)


def _normalised(points: Sequence[Floats], first: int) -> list[Complexes]:
    """Points as complex numbers, up positive, from the centre of the first figure, by its radius."""
    raw = [np.reshape(z, (-1, 2)) @ np.array([1.0, -1.0j]) for z in points]
    centre = raw[first].mean()
    radius = float(np.sqrt((np.abs(raw[first] - centre) ** 2).mean())) or 1.0
    return [(z - centre) / radius for z in raw]


class _Learned(NamedTuple):
    """What some frames show of markers and camera."""

    view: Floats
    """(4,)"""
    figure: Figure
    misfit: float
    """by which the markers usually miss the figure"""


def _learned(sightings: list[Sighting], known: Figure) -> _Learned:
    """Find view and figure from frames in which it is known which marker is which.

    What was rarely there is no marker, nor is what misses its place by far more than the others: it does not turn
    with the wheel, which was hardly turned.
    """
    view = learn(sightings, known.size)
    mean, kept = _mean_figure(sightings, known, view)
    miss = np.full((len(sightings), known.size), np.nan)
    for row, sighting in zip(miss, sightings, strict=True):
        flat, figure = rectified(view, sighting.point), mean[sighting.member]
        row[sighting.member] = np.abs(fit_pose(figure, flat, sighting.rotation).placed(figure) - flat)
    own = np.array([np.sqrt(np.nanmean(column**2)) if keep else 0.0 for column, keep in zip(miss.T, kept, strict=True)])
    worst = int(np.argmax(own))
    if kept.sum() > FEWEST and own[worst] > max(ODD_MISFIT, ODD_RATIO * float(np.median(own[kept]))):
        return _learned(_without(sightings, worst), known)
    return _Learned(view, Figure.of(mean[kept]), float(np.nanmedian(np.sqrt(np.nanmean(miss**2, axis=1)))))


def _without(sightings: list[Sighting], member: int) -> list[Sighting]:
    rest = [(s, s.member != member) for s in sightings]
    return [s._replace(member=s.member[k], point=s.point[k]) for s, k in rest if k.sum() >= 2]


def _mean_figure(sightings: list[Sighting], known: Figure, view: Floats) -> tuple[Complexes, np.ndarray]:
    """Places of the markers (M,) as a view shows them, and which are seen often enough (M,)."""
    total, count = np.zeros(known.size, np.complex128), np.zeros(known.size)
    for sighting, weight in zip(sightings, _rarity(sightings), strict=True):
        flat, figure = rectified(view, sighting.point), known.point[sighting.member]
        total[sighting.member] += weight * fit_pose(figure, flat, sighting.rotation).taken_back(flat)
        count[sighting.member] += weight
    return total / np.maximum(count, 1e-9), count >= RARE * count.max(initial=1e-9)


def _rarity(sightings: list[Sighting]) -> Floats:
    """(F,) weights by which every rotation counts the same: a lamp in the dashboard goes with a straight wheel only."""
    bins = np.round(np.array([s.rotation for s in sightings]) / ROTATION_BIN).astype(int)
    _, which, frequency = np.unique(bins, return_inverse=True, return_counts=True)
    return np.asarray(1.0 / frequency[which], np.float64)


def _acquired(t: Floats, frames: list[Complexes], params: MarkerParameters) -> _Learned:
    """Learn view and figure from the part of the frames in which the markers are followed longest and best.

    After a break some marker may be taken for another, so that each part has a figure of its own.
    """
    parts = _parts(t, frames, params)
    worth = [sum(s.member.size - 2 for s in part) for part, _ in parts]
    order = sorted(range(len(parts)), key=lambda k: -worth[k])[:MOST_PARTS]
    return min((_learned(*parts[k]) for k in order if worth[k] > worth[order[0]] / 4), key=lambda part: part.misfit)


def _parts(t: Floats, frames: list[Complexes], params: MarkerParameters) -> list[tuple[list[Sighting], Figure]]:
    """Follow the markers, with neither their figure nor the view known, from break to break."""
    parts, start = [], 0
    while start < t.size:
        if frames[start].size < params.least:
            start += 1
            continue
        figure, motion = Figure.of(frames[start]), Track(Pose(0.0, 0j), 0.0, float(t[start]))
        part: list[Sighting] = []
        for k in range(start, t.size):
            if t[k] - motion.t > EXTRAPOLATED:
                break
            for pose, member, which, _ in match(figure, frames[k], motion.predicted(t[k]), params.first_gate, params):
                motion = motion.then(pose, float(t[k]), params.fastest)
                part.append(Sighting(k, member, frames[k][which], pose.rotation))
                figure.learn(pose, frames[k], member, which, params.first_gate)
        parts.append((part, figure))
        start = max(part[-1].frame, start) + 1
    return parts


def _follow(
    t: Floats, frames: list[Complexes], figure: Figure, view: Floats, gate: float, params: MarkerParameters
) -> _Pass:
    """Follow the markers through all frames, their figure known."""
    rotation, misfit = np.full(t.size, np.nan), np.full(t.size, np.nan)
    sightings: list[Sighting] = []
    motion = Track(Pose(0.0, 0j), 0.0, -np.inf)
    for k in range(t.size):
        flat = rectified(view, frames[k])
        for pose, member, which, miss in match_anywhere(figure, flat, motion, float(t[k]), gate, params):
            motion = motion.then(pose, float(t[k]), params.fastest)
            rotation[k], misfit[k] = pose.rotation, miss
            sightings.append(Sighting(k, member, frames[k][which], pose.rotation))
    return _Pass(rotation, misfit, sightings, figure)


def _found(
    t: Floats, done: _Pass, view: Floats, params: MarkerParameters, sign: float, straight: float | None
) -> Markers:
    known = np.isfinite(done.rotation)
    start = t[known][0]
    held = known & ((t <= start + params.straight_span) if straight is None else np.abs(t - straight) <= 0.25)
    zero = (
        float(np.median(done.rotation[held]))
        if held.any()
        else float(np.interp(straight or start, t[known], done.rotation[known]))
    )
    angle = sign * (done.rotation - zero)
    count = np.zeros(t.size, int)
    for sighting in done.sightings:
        count[sighting.frame] = sighting.member.size
    sigma = np.hypot(done.misfit / np.sqrt(np.maximum(count - 1, 1)), params.systematic)
    rate = np.full(t.size, np.nan)
    if known.sum() > 1:
        rate[known] = np.gradient(angle[known], t[known])
    steering = Steering(t, angle, rate, sigma)
    increments = sign * _increments(t.size, done, view) + float(angle[known][0])
    return Markers(steering, increments, done.figure.point[done.figure.trusted], view, count)


def _increments(size: int, done: _Pass, view: Floats) -> Floats:
    """(N,) rad, sum of the rotations between neighbouring frames; 0 in the first one."""
    total, angle = 0.0, np.full(size, np.nan)
    if done.sightings:
        angle[done.sightings[0].frame] = 0.0
    for before, after in zip(done.sightings, done.sightings[1:], strict=False):
        _, i, j = np.intersect1d(before.member, after.member, return_indices=True)
        if i.size >= 2:
            total += rotation_between(rectified(view, before.point[i]), rectified(view, after.point[j]))
        else:
            total += after.rotation - before.rotation
        angle[after.frame] = total
    return angle
