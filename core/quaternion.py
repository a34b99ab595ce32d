"""Unit quaternions, scalar first `[w, x, y, z]`, Hamilton product: `R(q * p) = R(q) R(p)`.

`q_vs` turns sensor readings into vehicle readings: `f_v = R(q_vs) f_s`. Every function takes and gives arrays with
the quaternion on the last axis, so that they work on one rotation and on many alike. Angles in radians.
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]

GIMBAL_LOCK_COSINE = 1e-6
"""Below this cosine of pitch, roll and yaw are not told apart; roll is then set to zero."""


def normalise(q: ArrayLike) -> Floats:
    """Scale to unit length with w >= 0 (q and -q are the same rotation)."""
    raw: Floats = np.asarray(q, np.float64)
    unit: Floats = raw / np.linalg.norm(raw, axis=-1, keepdims=True)
    return np.where(unit[..., :1] < 0, -unit, unit)


def conjugate(q: ArrayLike) -> Floats:
    """Give the inverse rotation."""
    inverse: Floats = np.asarray(q, np.float64) * np.array([1.0, -1.0, -1.0, -1.0])
    return inverse


def multiply(q: ArrayLike, p: ArrayLike) -> Floats:
    """Hamilton product: first rotate by `p`, then by `q` (thesis C.6, with its missing factor put in)."""
    w1, x1, y1, z1 = np.moveaxis(np.asarray(q, np.float64), -1, 0)
    w2, x2, y2, z2 = np.moveaxis(np.asarray(p, np.float64), -1, 0)
    return np.stack(
        [
            w1 * w2 - x1 * x2 - y1 * y2 - z1 * z2,
            w1 * x2 + x1 * w2 + y1 * z2 - z1 * y2,
            w1 * y2 - x1 * z2 + y1 * w2 + z1 * x2,
            w1 * z2 + x1 * y2 - y1 * x2 + z1 * w2,
        ],
        axis=-1,
    )


def matrix(q: ArrayLike) -> Floats:
    """Rotation matrix (..., 3, 3) of a unit quaternion (thesis C.3, scalar first)."""
    q = np.asarray(q, np.float64)
    if q.ndim == 1:
        return np.array(_matrix(*q.tolist()))  # plain numbers: numpy's take several times as long for one rotation
    r = np.empty((*q.shape[:-1], 3, 3))
    for i, row in enumerate(_matrix(*(q[..., i] for i in range(4)))):
        r[..., i, 0], r[..., i, 1], r[..., i, 2] = row
    return r


def _matrix(w: Any, x: Any, y: Any, z: Any) -> tuple[tuple[Any, Any, Any], ...]:
    return (
        (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )


def from_matrix(r: ArrayLike) -> Floats:
    """Unit quaternion of one rotation matrix (3, 3), stable at every angle (Bar-Itzhack 2000, largest eigenvector)."""
    r = np.asarray(r, np.float64)
    k = np.array(
        [
            [r[0, 0] + r[1, 1] + r[2, 2], r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]],
            [r[2, 1] - r[1, 2], r[0, 0] - r[1, 1] - r[2, 2], r[0, 1] + r[1, 0], r[0, 2] + r[2, 0]],
            [r[0, 2] - r[2, 0], r[0, 1] + r[1, 0], r[1, 1] - r[0, 0] - r[2, 2], r[1, 2] + r[2, 1]],
            [r[1, 0] - r[0, 1], r[0, 2] + r[2, 0], r[1, 2] + r[2, 1], r[2, 2] - r[0, 0] - r[1, 1]],
        ]
    )
    return normalise(np.linalg.eigh(k)[1][:, -1])


def from_rotation_vector(v: ArrayLike) -> Floats:
    """Quaternion of the rotation by |v| radians about v."""
    v = np.asarray(v, np.float64)
    angle = np.linalg.norm(v, axis=-1, keepdims=True)
    return np.concatenate([np.cos(angle / 2), 0.5 * np.sinc(angle / (2 * np.pi)) * v], axis=-1)


def rotation_vector(q: ArrayLike) -> Floats:
    """Rotation vector (angle in [0, pi] times axis) of a unit quaternion."""
    q = normalise(q)
    sine = np.linalg.norm(q[..., 1:], axis=-1, keepdims=True)
    angle = 2 * np.arctan2(sine, q[..., :1])
    vector: Floats = q[..., 1:] * np.where(sine > 0, angle / np.where(sine > 0, sine, 1.0), 2.0)
    return vector


def angle_between(q: ArrayLike, p: ArrayLike) -> Floats:
    """Angle in [0, pi] of the rotation that takes `p` to `q`."""
    angle: Floats = np.linalg.norm(rotation_vector(multiply(q, conjugate(p))), axis=-1)
    return angle


def rotate(q: ArrayLike, v: ArrayLike) -> Floats:
    """Give R(q) v."""
    return np.squeeze(matrix(q) @ np.asarray(v, np.float64)[..., None], axis=-1)


def from_angles(roll: float, pitch: float, yaw: float) -> Floats:
    """Quaternion of the intrinsic z-y'-x'' angles (ISO 8855): R = Rz(yaw) Ry(pitch) Rx(roll)."""
    z, y, x = (from_rotation_vector(a * axis) for a, axis in zip((yaw, pitch, roll), np.eye(3)[::-1], strict=True))
    return normalise(multiply(z, multiply(y, x)))


def angles(q: ArrayLike) -> tuple[float, float, float]:
    """Roll, pitch, yaw of one quaternion; at pitch = +-90 deg, where they are not unique, roll is zero."""
    r = matrix(q)
    cosine = float(np.hypot(r[0, 0], r[1, 0]))
    pitch = float(np.arctan2(-r[2, 0], cosine))
    if cosine < GIMBAL_LOCK_COSINE:
        return 0.0, pitch, float(np.arctan2(-r[0, 1], r[1, 1]))
    return float(np.arctan2(r[2, 1], r[2, 2])), pitch, float(np.arctan2(r[1, 0], r[0, 0]))


def all_angles(q: ArrayLike) -> Floats:
    """Roll, pitch, yaw of many quaternions, a row each, as `angles` gives them one by one."""
    r = matrix(np.reshape(q, (-1, 4)))
    cosine = np.hypot(r[:, 0, 0], r[:, 1, 0])
    locked = cosine < GIMBAL_LOCK_COSINE
    roll = np.where(locked, 0.0, np.arctan2(r[:, 2, 1], r[:, 2, 2]))
    yaw = np.where(locked, np.arctan2(-r[:, 0, 1], r[:, 1, 1]), np.arctan2(r[:, 1, 0], r[:, 0, 0]))
    return np.column_stack([roll, np.arctan2(-r[:, 2, 0], cosine), yaw])


def random(generator: np.random.Generator, size: int | None = None) -> Floats:
    """Draw rotations uniformly (Shoemake 1992: a normalised Gaussian 4-vector)."""
    return normalise(generator.normal(size=4 if size is None else (size, 4)))
