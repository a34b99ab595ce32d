"""Poses in which a device lay still, found in what it recorded: the measurements of a calibration (thesis B.3).

A window is still when its readings scatter no more than the sensor's noise, which the quietest windows of the recording
show. A slow turn passes for still; that does no harm, since |f_s| stays g, as long as its mean is not taken over more
than a few degrees.
"""

from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core._kernel import GRAVITY
from core.samples import Samples

Floats = NDArray[np.float64]

WINDOW = 1.0
"""s the readings have to stay where they are"""
STEP = 0.25
"""s from one window to the next"""
MIN_SAMPLES = 8
"""in a window; fewer do not show whether it is still"""
MIN_FILLED = 0.8
"""share of a window from its first to its last sample; emptier ones are at a gap"""
QUIET_SHARE = 0.1
"""share of the windows that are taken to be still: the noisiest of these shows the noise of the sensor"""
STILL_FACTOR = 2.0
"""a window is still whose readings scatter at most by this many times the noise of the sensor"""
STILL_RANGE = (0.05, 0.5)
"""m/s2 of scatter that always is still (coarse counts hide the noise), and that never is (no sensor is so noisy)"""
REST_RANGE = (0.5 * GRAVITY, 1.5 * GRAVITY)
"""m/s2 a device at rest may read, however bad its gains and offsets"""
NEW_POSE = float(np.radians(10.0))
"""rad; a pose nearer than this to one there is says nothing new"""
SAME_POSE = float(np.radians(2.0))
"""rad; readings nearer than this are averaged; the mean of more distant ones would be shorter than they are"""

AXES = "xyz"
PAIRS = ((0, 1), (0, 2), (1, 2))
UPRIGHT_COSINE = float(np.cos(np.radians(35.0)))
"""an axis points up or down when it does within 35 degrees"""
TILTED_PRODUCT = 0.25
"""product of two direction cosines from which on a pose lies between two axes"""


class Pose(NamedTuple):
    """A device that lay still."""

    reading: Floats
    """(3,) m/s2, mean of the readings, sensor axes"""
    sigma: float
    """m/s2, 1 sigma of the mean per axis, from the noise alone"""
    seconds: float
    """s it lay so"""


class _Windows(NamedTuple):
    """Windows of a recording; W of them."""

    first: NDArray[np.intp]
    """(W,) first sample"""
    stop: NDArray[np.intp]
    """(W,) sample after the last"""
    mean: Floats
    """(W, 3) m/s2"""
    scatter: Floats
    """(W,) m/s2, standard deviation, root of the sum of squares over the axes"""


def find_poses(recordings: Iterable[Samples]) -> list[Pose]:
    """Find where a device lay still, each direction once.

    Parameters
    ----------
    recordings
        of one device, specific force in m/s2, sensor axes; each has a clock of its own

    Returns
    -------
    list[Pose]
        at least 10 degrees apart, in the order in which they were taken
    """
    poses: list[Pose] = []
    for recording in recordings:
        for pose in _still(recording):
            _merge(poses, pose)
    return poses


def missing(readings: Floats) -> tuple[str, ...]:
    """Name what is missing of the nine poses that are enough: each axis up, each axis down, and between each two.

    Parameters
    ----------
    readings
        (P, 3) m/s2, mean reading of each pose, sensor axes

    Returns
    -------
    tuple[str, ...]
        what the device should do, in words that follow "lie"
    """
    cosines = readings.reshape(-1, 3) / np.linalg.norm(readings.reshape(-1, 3), axis=1, keepdims=True)
    upright = [
        f"with its {axis} axis {word}"
        for i, axis in enumerate(AXES)
        for word, sign in (("up", 1.0), ("down", -1.0))
        if not (sign * cosines[:, i] > UPRIGHT_COSINE).any()
    ]
    tilted = [
        f"tilted half-way between its {AXES[i]} and {AXES[j]} axes"
        for i, j in PAIRS
        if not (np.abs(cosines[:, i] * cosines[:, j]) > TILTED_PRODUCT).any()
    ]
    return (*upright, *tilted)


def angle_between(a: Floats, b: Floats) -> Floats:
    """Give the angle between vectors (..., 3), rad, exact for small ones too."""
    angle: Floats = np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1), (a * b).sum(axis=-1))
    return angle


def stack(poses: Sequence[Pose]) -> tuple[Floats, Floats]:
    """Give the readings (P, 3) and their sigmas (P,) of poses, m/s2."""
    return np.array([pose.reading for pose in poses]).reshape(-1, 3), np.array([pose.sigma for pose in poses])


def _still(recording: Samples) -> Iterator[Pose]:
    """Give the stretches in which the readings stay where they are."""
    windows = _windows(recording)
    stretch: list[int] = []
    for window in _still_windows(windows):
        if stretch and not _goes_on(windows, stretch, window):
            yield _pose(recording, windows, stretch)
            stretch = []
        stretch.append(window)
    if stretch:
        yield _pose(recording, windows, stretch)


def _goes_on(windows: _Windows, stretch: list[int], window: int) -> bool:
    """Tell whether a window follows without a break, in the direction in which the stretch began."""
    turned = angle_between(windows.mean[window], windows.mean[stretch[0]])
    return bool(windows.first[window] < windows.stop[stretch[-1]] and turned < SAME_POSE)


def _windows(recording: Samples) -> _Windows:
    """Cut a recording into overlapping windows; those with too few samples are left out."""
    t, f_s = recording.t, recording.f_s
    if not len(recording):
        return _Windows(np.empty(0, np.intp), np.empty(0, np.intp), np.empty((0, 3)), np.empty(0))
    begin = t[0] + STEP * np.unique(np.floor((t - t[0]) / STEP))
    first, stop = np.searchsorted(t, begin), np.searchsorted(t, begin + WINDOW)
    full = (stop - first >= MIN_SAMPLES) & (t[stop - 1] - t[first] >= MIN_FILLED * WINDOW)
    first, stop = first[full], stop[full]
    centre = f_s.mean(axis=0)  # sums of squares about it keep their digits
    sums = np.zeros((len(recording) + 1, 6))
    np.cumsum(np.hstack([f_s - centre, (f_s - centre) ** 2]), axis=0, out=sums[1:])
    means = (sums[stop] - sums[first]) / (stop - first)[:, None]
    variance = np.maximum(means[:, 3:] - means[:, :3] ** 2, 0.0)
    return _Windows(first, stop, centre + means[:, :3], np.sqrt(variance.sum(axis=1)))


def _still_windows(windows: _Windows) -> list[int]:
    """Give the numbers of the windows in which the readings do not move."""
    if not windows.scatter.size:
        return []
    noise = float(np.quantile(windows.scatter, QUIET_SHARE))
    limit = float(np.clip(STILL_FACTOR * noise, *STILL_RANGE))
    size = np.linalg.norm(windows.mean, axis=1)
    at_rest = (size > REST_RANGE[0]) & (size < REST_RANGE[1])
    still: list[int] = np.flatnonzero((windows.scatter <= limit) & at_rest).tolist()
    return still


def _pose(recording: Samples, windows: _Windows, stretch: list[int]) -> Pose:
    start, stop = int(windows.first[stretch[0]]), int(windows.stop[stretch[-1]])
    readings = recording.f_s[start:stop]
    noise = float(np.sqrt(readings.var(axis=0).mean()))
    seconds = float(recording.t[stop - 1] - recording.t[start])
    return Pose(readings.mean(axis=0), noise / float(np.sqrt(stop - start)), seconds)


def _merge(poses: list[Pose], pose: Pose) -> None:
    """Add a pose that is new, average one that is there; one in between says nothing new."""
    angles = [float(angle_between(pose.reading, known.reading)) for known in poses]
    nearest = int(np.argmin(angles)) if angles else -1
    if nearest < 0 or angles[nearest] >= NEW_POSE:
        poses.append(pose)
    elif angles[nearest] < SAME_POSE:
        poses[nearest] = _mean(poses[nearest], pose)


def _mean(a: Pose, b: Pose) -> Pose:
    share = b.seconds / (a.seconds + b.seconds)
    sigma = float(np.hypot((1 - share) * a.sigma, share * b.sigma))
    return Pose((1 - share) * a.reading + share * b.reading, sigma, a.seconds + b.seconds)
