"""Installation angles of the thesis: attitude theta about z, heading phi about y, bank psi about x, in degrees.

The thesis' vehicle frame is forward, right, down; ours is forward, left, up. With D, half a turn about x, between them
R(q_vs) = D Ry(phi) Rz(theta) Rx(psi), thesis (3.9).
"""

import numpy as np
from numpy.typing import NDArray

from core import quaternion

Floats = NDArray[np.float64]
Angles = tuple[float, float, float]
"""theta, phi, psi, degrees"""

D = np.array([0.0, 1.0, 0.0, 0.0])


def from_thesis(angles: Angles) -> Floats:
    """q_vs of installation angles."""
    theta, phi, psi = np.radians(angles)
    y, z, x = (quaternion.from_rotation_vector(turn) for turn in ([0.0, phi, 0.0], [0.0, 0.0, theta], [psi, 0.0, 0.0]))
    return quaternion.normalise(quaternion.multiply(D, quaternion.multiply(y, quaternion.multiply(z, x))))


def to_thesis(q_vs: Floats, near: Angles) -> Angles:
    """Installation angles (C.14)-(C.16); of the sets that mean the same rotation the one nearest to `near`."""
    r = quaternion.matrix(quaternion.multiply(D, q_vs))
    theta = np.arctan2(r[1, 0], np.hypot(r[0, 0], r[2, 0]))
    phi, psi = np.arctan2(-r[2, 0], r[0, 0]), np.arctan2(-r[1, 2], r[1, 1])
    if np.cos(theta) < quaternion.GIMBAL_LOCK_COSINE:  # only phi +- psi is defined: keep psi
        psi = np.radians(near[2])
        phi = np.arctan2(r[0, 2], r[2, 2]) - np.sign(theta) * psi
    centre = np.array(near)
    sets = np.degrees([[theta, phi, psi], [np.pi - theta, phi + np.pi, psi + np.pi]])
    best = min(centre + wrapped(sets - centre), key=lambda s: float(np.linalg.norm(s - centre)))
    return (float(best[0]), float(best[1]), float(best[2]))


def wrapped(degrees: Floats) -> Floats:
    """Angles in [-180, 180)."""
    return (degrees + 180) % 360 - 180


def error(q: Floats, truth: Floats) -> float:
    """Total rotation between two mountings, degrees."""
    return float(np.degrees(quaternion.angle_between(q, truth)))
