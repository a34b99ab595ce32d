"""How a device moved, and where a push came from, in the words of somebody who sits in the vehicle."""

import numpy as np
from numpy.typing import NDArray

PARTS = (
    ("leaned", "to the right", "to the left"),
    ("tipped", "nose down", "nose up"),
    ("turned", "to the left", "to the right"),
)
"""Turning about the vehicle's x, y and z axis: what it is called, and where to when positive and when negative."""
NOTABLE = 0.25
"""share of the axis' length below which a component is not worth a word: 14 degrees off a vehicle axis"""

SIDES = ("front", "front left", "left", "rear left", "rear", "rear right", "right", "front right")
"""anti-clockwise, an eighth each"""


def side(direction: float) -> str:
    """Say where something came from; `direction` in rad, anti-clockwise from forward."""
    return SIDES[round(direction / (np.pi / 4)) % len(SIDES)]


def movement(angle: float | None, axis: NDArray[np.float64] | None) -> str:
    """Say how a device moved: "turned 14 degrees to the left"; of what is not known nothing is said.

    Of a mix each component of the rotation vector is told, the largest first, and the size of the whole.

    Parameters
    ----------
    angle
        rad, size of the rotation
    axis
        (3,) unit vector, vehicle axes, right-handed with `angle`
    """
    if angle is None:
        return "moved"
    size = degrees_text(np.degrees(abs(angle)))
    if axis is None:
        return f"moved by {size} degrees"
    largest = np.argsort(-np.abs(axis), kind="stable").tolist()
    told = [k for k in largest if abs(axis[k]) >= NOTABLE]
    if len(told) == 1:
        return _part(told[0], size, angle * axis[told[0]] > 0)
    parts = [_part(k, degrees_text(np.degrees(abs(angle * axis[k]))), angle * axis[k] > 0) for k in told]
    return f"{', '.join(parts[:-1])} and {parts[-1]} ({size} degrees in all)"


def _part(k: int, size: str, positive: bool) -> str:
    verb, forth, back = PARTS[k]
    return f"{verb} {size} degrees {forth if positive else back}"


def degrees_text(degrees: float) -> str:
    """Give a number >= 0, of degrees mostly, with the digits worth reading: "3.4" below ten, "94" above."""
    return f"{degrees:.1f}" if degrees < 9.95 else f"{degrees:.0f}"
