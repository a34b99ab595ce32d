"""Films of a steering wheel with markers, rendered: perspective, shake, changing light, blur, noise, hands."""

from dataclasses import dataclass
from math import radians
from pathlib import Path
from typing import Any, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from core.motion.steering_terms import Floats

Image = NDArray[Any]

WHEEL_RADIUS = 0.185
"""m"""
MARKERS = (0.0, 47.0, 112.0, 171.0, 238.0, 297.0)
"""degrees about the hub, unevenly spaced"""
MARKER_RADIUS = 0.012
SKIN = (120, 150, 205)
MARKER_COLOURS = {"red": (40, 30, 220), "green": (60, 190, 40), "blue": (220, 110, 20)}
SUBPIXEL = 6
"""bits of a pixel in which shapes are drawn"""


@dataclass(frozen=True)
class Film:
    """What is filmed, and how badly."""

    seed: int = 0
    seconds: float = 20.0
    fps: float = 30.0
    size: tuple[int, int] = (640, 480)
    tilt: float = radians(25.0)
    """rad between the line of sight and the column, the wheel leaning away at its top"""
    aside: float = radians(8.0)
    """rad the camera is to the side"""
    colour: str = "red"
    shake: float = 4.0
    """px, 1 sigma of the camera's shifts at 640 px width"""
    roll: float = radians(0.5)
    """rad, 1 sigma of its turning about the line of sight"""
    light: float = 0.3
    """by which the light changes, 1 sigma of the logarithm of its strength"""
    noise: float = 6.0
    """grey levels, 1 sigma"""
    blur: float = 0.8
    """px"""
    hands: bool = True
    """hands hide one or two markers now and then"""
    turns: float = radians(300.0)
    """rad, most the wheel is turned to either side"""


class Rendered(NamedTuple):
    """What is true of a film."""

    t: Floats
    """(N,) s"""
    angle: Floats
    """(N,) rad, positive to the left"""


def render(film: Film, path: Path) -> Rendered:
    """Write a film as motion JPEG; OpenCV chooses no codec that would need anything else."""
    rng = np.random.default_rng([film.seed, 7])
    t = np.arange(int(film.seconds * film.fps)) / film.fps
    angle = steering(film, t, rng)
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), film.fps, film.size)
    scene = _Scene(film, rng)
    for frame in scene.frames(t, angle, rng):
        writer.write(frame)
    writer.release()
    return Rendered(t, angle)


def steering(film: Film, t: Floats, rng: np.random.Generator) -> Floats:
    """Straight for a second, then bends of all sizes."""
    knots = np.arange(0.0, t[-1] + 4.0, 1.6)
    size = film.turns * rng.choice([0.1, 0.3, 1.0], knots.size) * rng.uniform(-1.0, 1.0, knots.size)
    size[knots < 2.0] = 0.0
    return _smooth(np.interp(t, knots, size), 0.35 * film.fps)


def _smooth(x: Floats, width: float) -> Floats:
    window = np.hanning(max(int(4 * width) | 1, 3))
    padded = np.pad(x, window.size // 2, mode="edge")
    return np.convolve(padded, window / window.sum(), mode="valid")


def _wander(rng: np.random.Generator, size: int, width: float) -> Floats:
    """(N,) smooth noise of unit variance."""
    x = _smooth(rng.normal(size=size), width)
    spread = float(x.std())
    return x / spread if spread else x


class _Scene:
    """A cabin with a wheel in it, and a camera."""

    def __init__(self, film: Film, rng: np.random.Generator) -> None:
        self.film = film
        self.focal = 0.95 * film.size[0]
        self.distance = 0.62 * self.focal / film.size[1] * 0.8
        self.start = rng.uniform(0, 2 * np.pi)
        self.reach = rng.uniform(0.55, 0.95, len(MARKERS)) * WHEEL_RADIUS
        self.background = _cabin(film, rng)

    def frames(self, t: Floats, angle: Floats, rng: np.random.Generator) -> Any:
        """Give the frames one by one."""
        film, fps = self.film, self.film.fps
        shift = film.shake * film.size[0] / 640 * np.stack([_wander(rng, t.size, 0.1 * fps) for _ in range(2)])
        roll = film.roll * _wander(rng, t.size, 0.1 * fps)
        light = np.exp(film.light * _wander(rng, t.size, 0.7 * fps))
        warmth, hidden = 0.06 * _wander(rng, t.size, 1.5 * fps), _wander(rng, t.size, 0.6 * fps)
        for k in range(t.size):
            image = self.background.copy()
            self._draw_wheel(image, float(angle[k]), float(hidden[k]))
            yield self._seen(image, shift[:, k], float(roll[k]), float(light[k]), float(warmth[k]), rng)

    def _draw_wheel(self, image: Image, angle: float, hidden: float) -> None:
        circle = np.linspace(0, 2 * np.pi, 90)
        rim = WHEEL_RADIUS * np.stack([np.cos(circle), np.sin(circle)], axis=-1)
        thick = max(int(0.045 * self.film.size[1]), 3)
        _polyline(image, self._pixels(rim), (45, 45, 50), thick)
        for spoke in (0.0, 180.0, 270.0):
            end = WHEEL_RADIUS * _direction(angle + radians(spoke))
            _polyline(image, self._pixels(np.array([[0.0, 0.0], end])), (70, 68, 66), thick)
        for place, reach in zip(MARKERS, self.reach, strict=True):
            centre = reach * _direction(angle + self.start + radians(place))
            spot = centre + MARKER_RADIUS * np.stack([np.cos(circle), np.sin(circle)], axis=-1)
            _fill(image, self._pixels(spot), MARKER_COLOURS[self.film.colour])
        if self.film.hands:
            for side, there in ((0.55, hidden > 0.3), (2.4, hidden < 0.1)):
                if there:
                    hand = 0.82 * WHEEL_RADIUS * _direction(side + 0.25 * hidden)
                    palm = hand + np.stack([0.05 * np.cos(circle), 0.035 * np.sin(circle)], axis=-1)
                    _fill(image, self._pixels(palm), SKIN)

    def _pixels(self, plane: Floats) -> Floats:
        """Project points (K, 2) of the wheel's plane, m right and up, to pixels (K, 2)."""
        x, y = plane[:, 0], plane[:, 1]
        tilt, aside = self.film.tilt, self.film.aside
        right, up, away = x, y * np.cos(tilt), y * np.sin(tilt)
        right, away = right * np.cos(aside) - away * np.sin(aside), right * np.sin(aside) + away * np.cos(aside)
        depth = self.distance + away
        width, height = self.film.size
        return np.stack([width / 2 + self.focal * right / depth, height / 2 - self.focal * up / depth], axis=-1)

    def _seen(
        self, image: Image, shift: Floats, roll: float, light: float, warmth: float, rng: np.random.Generator
    ) -> Image:
        width, height = self.film.size
        turn = cv2.getRotationMatrix2D((width / 2, height / 2), float(np.degrees(roll)), 1.0)
        turn = np.column_stack([turn[:, :2], turn[:, 2] + shift])
        image = cv2.warpAffine(image, turn, (width, height), borderMode=cv2.BORDER_REPLICATE)
        image = cv2.GaussianBlur(image, (0, 0), self.film.blur) if self.film.blur else image
        shade = np.linspace(0.8, 1.2, width)[None, :, None] * np.array([1 - warmth, 1.0, 1 + warmth])
        noise = self.film.noise * rng.standard_normal(image.shape, np.float32)
        seen: Image = np.clip(image * (light * shade) + noise, 0, 255).astype(np.uint8)
        return seen


def _cabin(film: Film, rng: np.random.Generator) -> Image:
    """A dashboard: dark, with vents, dials and a small lamp of the markers' colour."""
    width, height = film.size
    image = np.full((height, width, 3), (62, 58, 55), np.uint8)
    for _ in range(60):
        x, y = rng.uniform(0, width), rng.uniform(0, height)
        w, h = rng.uniform(0.02, 0.12, 2) * width
        grey = int(rng.uniform(25, 150))
        cv2.rectangle(image, (int(x), int(y)), (int(x + w), int(y + h)), (grey, grey, grey + 5), -1)
    lamp = (int(0.06 * width), int(0.1 * height))
    cv2.circle(image, lamp, max(int(0.008 * width), 2), MARKER_COLOURS[film.colour], -1)
    return image


def _direction(angle: float) -> Floats:
    return np.array([np.cos(angle), np.sin(angle)])


def _fixed(points: Floats) -> Any:
    return np.round(points * (1 << SUBPIXEL)).astype(np.int32)


def _fill(image: Image, points: Floats, colour: tuple[int, int, int]) -> None:
    cv2.fillPoly(image, [_fixed(points)], colour, cv2.LINE_AA, SUBPIXEL)


def _polyline(image: Image, points: Floats, colour: tuple[int, int, int], thickness: int) -> None:
    cv2.polylines(image, [_fixed(points)], False, colour, thickness, cv2.LINE_AA, SUBPIXEL)
