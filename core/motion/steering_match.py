"""One figure of markers in one frame: where it should be, and which of its members are seen in which points."""

from dataclasses import dataclass
from math import radians
from typing import NamedTuple

import numpy as np
from scipy.optimize import linear_sum_assignment

from core.motion.steering_figure import NEARNESS, Figure, Pose, fit_pose, search
from core.motion.steering_terms import Complexes


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


class Track(NamedTuple):
    """Where the figure was last, and how fast it turned."""

    pose: Pose
    rate: float
    """rad/s"""
    t: float
    """s"""

    def predicted(self, t: float) -> Pose:
        """Where the figure will be; after a while without a match it is not known how far it turned."""
        return Pose(self.pose.rotation + self.rate * min(t - self.t, EXTRAPOLATED), self.pose.shift)

    def then(self, pose: Pose, t: float, fastest: float) -> "Track":
        """Take in where it is."""
        since = t - self.t
        if since <= 0:
            return Track(pose, self.rate, t)
        latest = (pose.rotation - self.pose.rotation) / since if since < EXTRAPOLATED else 0.0
        return Track(pose, float(np.clip(0.7 * latest + 0.3 * self.rate, -fastest, fastest)), t)


Match = tuple[Pose, np.ndarray, np.ndarray, float]
"""pose of the figure in a frame, which members are seen in which points, and by how much they miss"""


def match(figure: Figure, flat: Complexes, predicted: Pose, gate: float, params: MarkerParameters) -> list[Match]:
    """Find the figure in a frame near the prediction; one match or none.

    A match of few markers must be close: three false ones fit somewhere by chance.
    """
    wanted = max(params.least, round(params.share * figure.trusted.size))
    trials: list[Match] = []
    for start in params.starts:
        trial = _settle(figure, flat, Pose(predicted.rotation + start, predicted.shift), gate, params)
        trials += [m for m in trial if abs(m[0].rotation - predicted.rotation) < params.surprise]
        if trials and trials[-1][1].size >= wanted:
            return trials[-1:]
    trials = [m for m in trials if m[3] < min(gate, params.gates[1]) / 8]
    return sorted(trials, key=lambda m: -m[1].size * (1 - (m[3] / gate) ** 2))[:1]


def match_anywhere(
    figure: Figure, flat: Complexes, motion: Track, t: float, gate: float, params: MarkerParameters
) -> list[Match]:
    """Find the figure near the prediction, or anywhere if that explains two markers more, or the prediction is old."""
    trusted, lost = figure.trusted, t - motion.t > params.patience
    near = [] if lost else match(figure, flat, motion.predicted(t), gate, params)
    if near and near[0][1].size >= params.plenty * trusted.size:
        return near
    nearness = NEARNESS if np.isfinite(motion.t) else 0.0
    pose = search(figure.point[trusted], flat, motion.predicted(t).rotation, gate, nearness)
    enough = near[0][1].size + 2 if near else max(params.least, round(params.share * trusted.size))
    other = _settle(figure, flat, pose, gate, params) if pose and (near or lost) else []
    return other if other and other[0][1].size >= enough else near


def _settle(figure: Figure, flat: Complexes, pose: Pose, gate: float, params: MarkerParameters) -> list[Match]:
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
