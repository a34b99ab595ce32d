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
from dataclasses import dataclass
from math import radians
from typing import NamedTuple

import numpy as np
from scipy.optimize import linear_sum_assignment

from core.motion.steering_figure import NEARNESS, Figure, Pose, fit_pose, search
from core.motion.steering_rectification import Sighting, learn, rectified, rotation_between
from core.motion.steering_terms import Complexes, Floats, Steering, SteeringError


@dataclass(frozen=True)
class MarkerParameters:
    """What is tuned. Lengths are by the radius of the figure of markers."""

    first_gate: float = 0.25
    """by which a marker may be off where it is predicted, before the camera's view is known"""
    gates: tuple[float, float] = (0.03, 0.12)
    """the same after that: so many times `gate_misfits` the usual misfit, within these limits"""
    gate_misfits: float = 6.0
    starts: tuple[float, ...] = tuple(radians(a) for a in (0.0, 9.0, -9.0, 18.0, -18.0))
    """rad beside the prediction from which the match is tried when too few markers are where they should be"""
    least: int = 3
    """markers that must be seen; two would do, but could not be told from false ones"""
    share: float = 0.6
    """of the markers that make a match sure"""
    plenty: float = 0.75
    """of the markers that make it needless to look elsewhere"""
    passes: int = 2
    """times all frames are gone through, each with the view that was learned before"""
    surprise: float = radians(25.0)
    """rad from the prediction that a match of few markers may be; by chance three false ones fit anywhere"""
    fastest: float = radians(900.0)
    """rad/s; nobody turns a wheel faster"""
    patience: float = 0.5
    """s without a match after which the whole circle is searched"""
    straight_span: float = 0.5
    """s at the start in which the wheel is held straight"""
    systematic: float = radians(0.4)
    """rad, 1 sigma of what no averaging removes: roll of the camera, the view"""


DEFAULT = MarkerParameters()
EXTRAPOLATED = 0.2
"""s for which the rate of turning is carried on"""
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
        figure, motion = Figure.of(frames[start]), _Motion(Pose(0.0, 0j), 0.0, float(t[start]))
        part: list[Sighting] = []
        for k in range(start, t.size):
            if t[k] - motion.t > EXTRAPOLATED:
                break
            for pose, member, which, _ in _match(figure, frames[k], motion.predicted(t[k]), params.first_gate, params):
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
    motion = _Motion(Pose(0.0, 0j), 0.0, -np.inf)
    for k in range(t.size):
        flat = rectified(view, frames[k])
        for pose, member, which, miss in _match_anywhere(figure, flat, motion, float(t[k]), gate, params):
            motion = motion.then(pose, float(t[k]), params.fastest)
            rotation[k], misfit[k] = pose.rotation, miss
            sightings.append(Sighting(k, member, frames[k][which], pose.rotation))
    return _Pass(rotation, misfit, sightings, figure)


class _Motion(NamedTuple):
    """Where the figure was last, and how fast it turned."""

    pose: Pose
    rate: float
    """rad/s"""
    t: float
    """s"""

    def predicted(self, t: float) -> Pose:
        """Where the figure will be; after a while without a match it is not known how far it turned."""
        return Pose(self.pose.rotation + self.rate * min(t - self.t, EXTRAPOLATED), self.pose.shift)

    def then(self, pose: Pose, t: float, fastest: float) -> "_Motion":
        """Take in where it is."""
        since = t - self.t
        if since <= 0:
            return _Motion(pose, self.rate, t)
        latest = (pose.rotation - self.pose.rotation) / since if since < EXTRAPOLATED else 0.0
        return _Motion(pose, float(np.clip(0.7 * latest + 0.3 * self.rate, -fastest, fastest)), t)


_Match = tuple[Pose, np.ndarray, np.ndarray, float]
"""pose of the figure in a frame, which members are seen in which points, and by how much they miss"""


def _match(figure: Figure, flat: Complexes, predicted: Pose, gate: float, params: MarkerParameters) -> list[_Match]:
    """Find the figure in a frame near the prediction; one match or none.

    A match of few markers must be close: three false ones fit somewhere by chance.
    """
    wanted = max(params.least, round(params.share * figure.trusted.size))
    trials: list[_Match] = []
    for start in params.starts:
        trial = _settle(figure, flat, Pose(predicted.rotation + start, predicted.shift), gate, params)
        trials += [m for m in trial if abs(m[0].rotation - predicted.rotation) < params.surprise]
        if trials and trials[-1][1].size >= wanted:
            return trials[-1:]
    trials = [m for m in trials if m[3] < min(gate, params.gates[1]) / 8]
    return sorted(trials, key=lambda m: -m[1].size * (1 - (m[3] / gate) ** 2))[:1]


def _match_anywhere(
    figure: Figure, flat: Complexes, motion: _Motion, t: float, gate: float, params: MarkerParameters
) -> list[_Match]:
    """Find the figure near the prediction, or anywhere if that explains two markers more, or the prediction is old."""
    trusted, lost = figure.trusted, t - motion.t > params.patience
    near = [] if lost else _match(figure, flat, motion.predicted(t), gate, params)
    if near and near[0][1].size >= params.plenty * trusted.size:
        return near
    nearness = NEARNESS if np.isfinite(motion.t) else 0.0
    pose = search(figure.point[trusted], flat, motion.predicted(t).rotation, gate, nearness)
    enough = near[0][1].size + 2 if near else max(params.least, round(params.share * trusted.size))
    other = _settle(figure, flat, pose, gate, params) if pose and (near or lost) else []
    return other if other and other[0][1].size >= enough else near


def _settle(figure: Figure, flat: Complexes, pose: Pose, gate: float, params: MarkerParameters) -> list[_Match]:
    """Assign and fit in turns; what misses by more than the gate is left out. Gives one match or none."""
    member, which = _assigned(figure, flat, pose, params.first_gate)
    if member.size < 2:
        return []
    # the camera may have been shaken: all are off by the same then
    off = flat[which] - pose.placed(figure.point[member])
    pose = Pose(pose.rotation, pose.shift + complex(np.median(off.real), np.median(off.imag)))
    for width in (3 * gate, gate, gate):
        member, which = _assigned(figure, flat, pose, width)
        if member.size < params.least:
            return []
        pose = fit_pose(figure.point[member], flat[which], pose.rotation)
    miss = np.abs(pose.placed(figure.point[member]) - flat[which])
    return [(pose, member, which, float(np.sqrt((miss**2).mean())))]


def _assigned(figure: Figure, flat: Complexes, pose: Pose, width: float) -> tuple[np.ndarray, np.ndarray]:
    """Which members are seen in which points, each in one at most, within a distance."""
    trusted = figure.trusted
    distance = np.abs(pose.placed(figure.point[trusted])[:, None] - flat[None, :])
    member, which = linear_sum_assignment(np.minimum(distance, width))
    near = distance[member, which] < width
    return trusted[member[near]], which[near]


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
