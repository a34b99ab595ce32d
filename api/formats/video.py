"""Films of a steering wheel with round coloured markers -> places of the markers, frame by frame.

OpenCV is needed, the extra `video`; it is loaded when the first film is read. Frames are read one by one and forgotten.
Markers are found by their colour in the plane of a and b of CIE Lab, where a change of light moves a colour towards
grey or away from it but hardly to another hue. The camera's shaking shows in the cabin around
the wheel and is taken out.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import pi
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from api.formats.errors import FormatError, Problem

Floats = NDArray[np.float64]
Image = NDArray[Any]

HUES = {"red": 40.0, "orange": 65.0, "yellow": 100.0, "green": 140.0, "cyan": 200.0, "blue": 285.0, "pink": 350.0}
"""degrees in the plane of a and b"""
SUFFIXES = frozenset({".avi", ".mp4", ".m4v", ".mov", ".mkv", ".webm", ".mpg", ".mpeg", ".3gp", ".ogv"})
HUE_WIDTH = float(np.tan(np.radians(32.0)))
LEAST_CHROMA = 14.0
"""distance from grey in Lab below which there is no colour"""
CHROMA_SHARE = 0.45
"""of the strongest chroma of the hue in a frame; the edge of a marker is where it falls below"""
BLOB_SHARE = (2e-5, 0.02)
"""of the frame's area that a marker may cover"""
LEAST_PIXELS = 9
ROUNDNESS = 0.5
"""4 pi area / perimeter^2, 1 = a circle; less is hidden in part, blurred, or no marker"""
FILLED = (0.6, 0.9)
"""of the smallest rectangle around it: an ellipse fills pi / 4, a rectangle all of it"""
MOST_BLOBS = 24
LEAST_MARKERS = 3
MOST_MARKERS = 12
"""more spots of one hue in a frame are no markers but a pattern"""
LOOKED_AT = 90
"""frames at the start from which the hue and the frame that all are held against are chosen"""
LOOKED_AT_EVERY = 9
WHEEL_SHARE = 2.4
"""radius around the markers, by that of their figure, beyond which the cabin begins"""
LEAST_CORNERS = 10
CORNERS = 120
PATCH = (13, 13)
LEAST_LIKENESS = 0.85
"""correlation of a corner's surroundings with what they were"""


@dataclass(frozen=True)
class FilmLimits:
    """What is still read."""

    pixels: int = 4096 * 2304
    """of a frame"""
    frames: int = 1_000_000
    width: int = 960
    """px to which larger frames are reduced"""


LIMITS = FilmLimits()


class MarkerFilm(NamedTuple):
    """Places of the markers in N frames."""

    t: Floats
    """(N,) s from the first frame"""
    points: list[Floats]
    """of each frame (K, 2), px to the right and down, the camera's shaking taken out"""
    colour: str
    """a key of `HUES`"""
    steadied: float
    """share of the frames in which the camera's shaking was found"""


def is_film(path: Path) -> bool:
    """Tell whether a file is a film, by its content or else its name."""
    try:
        with path.open("rb") as file:
            head = file.read(16)
    except OSError:
        head = b""
    known = (head[:4] == b"RIFF" and head[8:12] == b"AVI ") or head[4:8] == b"ftyp" or head[:4] == b"\x1aE\xdf\xa3"
    return known or path.suffix.lower() in SUFFIXES


def read_markers(
    path: Path,
    colour: str | None = None,
    limits: FilmLimits = LIMITS,
    seen: Callable[[float, float], None] = lambda t, duration: None,
) -> MarkerFilm:
    """Read a film.

    Parameters
    ----------
    colour
        of the markers, a key of `HUES`; None = that of which there are most round spots
    seen
        called with the time of each frame and of the last one, s

    Raises
    ------
    OSError
        the file cannot be read
    FormatError
        OpenCV is missing; it is no film; it is larger than the limits; it shows no markers.
    """
    cv2 = _opencv()
    with path.open("rb"):
        pass  # OpenCV does not say why it cannot open a file
    colour, cabin = _first_look(cv2, path, colour, limits)
    times: list[float] = []
    points: list[Floats] = []
    steadied = 0
    for t, duration, image in _frames(cv2, path, limits):
        spots = _spots(cv2, image, HUES[colour])[:, :2]
        steady = cabin.steady(image, spots) if cabin else None
        steadied += steady is not None
        times.append(t)
        points.append(spots if steady is None else steady)
        seen(t, duration)
    return MarkerFilm(np.array(times), points, colour, steadied / len(times))


def _opencv() -> ModuleType:
    try:
        import cv2  # noqa: PLC0415 -- an extra
    except ImportError:
        raise FormatError.unsupported("reading films needs OpenCV: pip install 'livella[video]'") from None
    return cv2


def _frames(
    cv2: ModuleType, path: Path, limits: FilmLimits, most: int | None = None
) -> Iterator[tuple[float, float, Image]]:
    """Give time (s), duration (s) and picture of each frame, reduced to the widest that is looked at."""
    film = cv2.VideoCapture(str(path))
    try:
        rate, total = film.get(cv2.CAP_PROP_FPS), film.get(cv2.CAP_PROP_FRAME_COUNT)
        width, height = film.get(cv2.CAP_PROP_FRAME_WIDTH), film.get(cv2.CAP_PROP_FRAME_HEIGHT)
        if not film.isOpened() or not 0 < rate < 1e4:
            raise _no_film("a film that OpenCV can read")
        if width * height > limits.pixels or total > limits.frames:
            raise FormatError.too_large(f"expected at most {limits.pixels} pixels a frame and {limits.frames} frames")
        scale, last = min(limits.width / max(width, 1.0), 1.0), -np.inf
        for k in range(most or limits.frames):
            good, image = film.read()
            if not good:
                break
            told = film.get(cv2.CAP_PROP_POS_MSEC) / 1e3
            t = told if told > last else max(k / rate, last + 1 / rate)
            last = t
            yield t, max(total / rate, t), cv2.resize(image, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
        if last == -np.inf:
            raise _no_film("a film with at least one frame")
    finally:
        film.release()


def _no_film(expected: str) -> FormatError:
    return FormatError.unreadable(Problem(None, None, expected, f"expected {expected}"))


def _first_look(cv2: ModuleType, path: Path, colour: str | None, limits: FilmLimits) -> "tuple[str, _Cabin | None]":
    """Choose the colour of which the first seconds show most and most colourful round spots, and the clearest cabin."""
    images = [
        image for k, (_, _, image) in enumerate(_frames(cv2, path, limits, LOOKED_AT)) if k % LOOKED_AT_EVERY == 0
    ]
    worth = {
        name: [_worth(_spots(cv2, image, HUES[name])) for image in images] for name in ([colour] if colour else HUES)
    }
    if max(map(np.median, worth.values())) == 0:
        raise _no_film("at least three round coloured markers in the first seconds")
    chosen = max(worth, key=lambda name: sum(worth[name]))
    shown = [
        _Cabin(cv2, image, _spots(cv2, image, HUES[chosen])[:, :2])
        for image, w in zip(images, worth[chosen], strict=True)
        if w
    ]
    best = max(shown, key=lambda cabin: cabin.corners)
    return chosen, best if best.corners >= LEAST_CORNERS else None


def _worth(spots: Floats) -> float:
    return float(spots[:, 2].sum()) if LEAST_MARKERS <= len(spots) <= MOST_MARKERS else 0.0


def _spots(cv2: ModuleType, image: Image, hue: float) -> Floats:
    """(K, 3) centres of the round spots of a hue, px, and how far they are from grey."""
    lab = cv2.cvtColor(cv2.GaussianBlur(image, (3, 3), 0), cv2.COLOR_BGR2Lab)
    a, b = lab[..., 1].astype(np.float32) - 128, lab[..., 2].astype(np.float32) - 128
    along = a * np.float32(np.cos(np.radians(hue))) + b * np.float32(np.sin(np.radians(hue)))
    across = b * np.float32(np.cos(np.radians(hue))) - a * np.float32(np.sin(np.radians(hue)))
    chroma = np.where(np.abs(across) < HUE_WIDTH * along, along, np.float32(0))
    lit = chroma[chroma > LEAST_CHROMA]
    if lit.size < LEAST_PIXELS:
        return np.empty((0, 3))
    level = max(LEAST_CHROMA, CHROMA_SHARE * float(np.percentile(lit, 90)))
    contours, _ = cv2.findContours((chroma > level).astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    found = [(area, spot) for c in contours for area, spot in _spot(cv2, c, chroma, level)]
    found.sort(key=lambda pair: -pair[0])
    return np.array([spot for _, spot in found[:MOST_BLOBS]]).reshape(-1, 3)


def _spot(cv2: ModuleType, contour: Any, chroma: Image, level: float) -> list[tuple[float, tuple[float, float, float]]]:
    """Area and centre of a contour, weighted by the chroma, if it is a round spot; one or none."""
    x, y, width, height = cv2.boundingRect(contour)
    around = cv2.arcLength(contour, True)
    area = cv2.contourArea(contour) + around / 2 + 1  # of the pixels, not between their centres
    if not max(LEAST_PIXELS, BLOB_SHARE[0] * chroma.size) <= area <= BLOB_SHARE[1] * chroma.size:
        return []
    sides = cv2.minAreaRect(contour)[1]
    filled = area / ((sides[0] + 1) * (sides[1] + 1))
    if 4 * pi * area / (around + 4) ** 2 < ROUNDNESS or not FILLED[0] < filled < FILLED[1]:
        return []
    weight = np.minimum(np.maximum(chroma[y : y + height, x : x + width] - level, 0), level)
    moments = cv2.moments(weight)
    if not moments["m00"]:
        return []
    strength = level + moments["m00"] / area
    return [(area, (x + moments["m10"] / moments["m00"], y + moments["m01"] / moments["m00"], strength))]


class _Cabin:
    """What surrounds the wheel in one of the first frames: against it the camera's shaking shows."""

    def __init__(self, cv2: ModuleType, image: Image, spots: Floats) -> None:
        self._cv2 = cv2
        self._first = self._grey(image)
        centre = np.median(spots, axis=0)
        radius = WHEEL_SHARE * float(np.median(np.linalg.norm(spots - centre, axis=1)))
        mask = np.full(self._first.shape, 255, np.uint8)
        cv2.circle(mask, tuple(np.round(centre).astype(int).tolist()), int(radius), 0, -1)
        corners = cv2.goodFeaturesToTrack(self._first, CORNERS, 0.005, 8, mask=mask)
        self._corners = np.empty((0, 1, 2), np.float32) if corners is None else corners
        self._patches = self._normal_patches(self._first, self._corners)
        self._last = self._corners.copy()
        self.corners = len(self._corners)

    def _grey(self, image: Image) -> Image:
        grey: Image = self._cv2.equalizeHist(self._cv2.cvtColor(image, self._cv2.COLOR_BGR2GRAY))
        return grey

    def _normal_patches(self, grey: Image, corners: Image) -> Floats:
        """(C, P) surroundings of the corners, of zero mean and unit length."""
        patches = [self._cv2.getRectSubPix(grey, PATCH, tuple(corner.tolist())).ravel() for corner in corners[:, 0]]
        raw = np.array(patches, np.float64).reshape(len(corners), PATCH[0] * PATCH[1])
        raw -= raw.mean(axis=1, keepdims=True)
        return np.asarray(raw / np.maximum(np.linalg.norm(raw, axis=1, keepdims=True), 1e-9), np.float64)

    def steady(self, image: Image, spots: Floats) -> Floats | None:
        """Give places in a frame as they would be had the camera not moved; None where the cabin does not show it."""
        cv2, grey = self._cv2, self._grey(image)
        there, known, _ = cv2.calcOpticalFlowPyrLK(
            self._first, grey, self._corners, self._last.copy(), flags=cv2.OPTFLOW_USE_INITIAL_FLOW
        )
        # where the light washed everything out, corners stay where they were last and agree with each other
        alike = (self._normal_patches(grey, there) * self._patches).sum(axis=1) > LEAST_LIKENESS
        good = (known.ravel() == 1) & alike
        if good.sum() < LEAST_CORNERS:
            return None
        back, inside = cv2.estimateAffinePartial2D(there[good], self._corners[good], ransacReprojThreshold=1.5)
        if back is None or inside.sum() < max(LEAST_CORNERS, good.sum() / 2):
            return None
        forth = cv2.invertAffineTransform(back)
        self._last = (self._corners @ forth[:, :2].T + forth[:, 2]).astype(np.float32)
        return np.asarray(spots @ back[:, :2].T + back[:, 2], np.float64)
