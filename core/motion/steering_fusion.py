"""Integrated rates and compared specific forces in one: a Kalman filter of the drift, smoothed backwards.

The integral of the steering rate (F6) is good at once and drifts; the angle by which the specific force on the wheel
is turned about the axis against that in the vehicle (G3-G6) is rough and does not drift. With what is integrated taken
as given, the state is what is wrong with it, x = (drift, bias), and everything is linear: no angle has to be unwrapped
but the innovation.
"""

from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from core import quaternion
from core.motion.steering_alignment import Pair, Rest, plane
from core.motion.steering_terms import Booleans, Floats, SteeringParameters

T = TypeVar("T", bound=np.generic)

FIRST_SIGMA = np.radians(20.0)
"""rad, 1 sigma of what is integrated at the first moment"""
GAP_SIGMA = np.radians(120.0)
"""rad per sqrt(s) by which the wheel may turn unseen in a gap"""
REST_RATE_SIGMA = np.radians(0.05)
"""rad/s, 1 sigma of the rate difference's mean over an interval of rest, vibration included"""


class Compared(NamedTuple):
    """Angle of the wheel by comparing the specific forces of both devices, K intervals."""

    angle: Floats
    """(K,) rad in (-pi, pi], nan where not known"""
    sigma: Floats
    """(K,) rad, 1 sigma; large where gravity is along the axis"""


class Seen(NamedTuple):
    """What is seen in each of K intervals."""

    known: Booleans
    """(K,) both rates are there"""
    resting: Booleans
    """(K,)"""
    rate: Floats
    """(K,) rad/s, mean of the steering rate"""
    angle: Floats
    """(K,) rad, angle by the forces less the integrated one, modulo a turn"""
    sigma: Floats
    """(K,) rad, 1 sigma"""


def compare_forces(
    pair: Pair, axis_w: Floats, q_cw: Floats, integrated: Floats, params: SteeringParameters
) -> Compared:
    """Find the rotation about the axis that best superposes both specific forces (G3-G6), for each interval.

    Weighted least squares in the plane across the axis: with u in the vehicle, v on the wheel, v = exp(-i angle) u, the
    best angle is that of sum(u conj(v)). Within an interval the wheel is turned back by what is integrated.
    """
    across = plane(axis_w)
    u = (pair.f_c @ quaternion.matrix(q_cw)) @ across
    v = (pair.f_w @ across) * np.exp(1j * integrated)
    size = interval_size(pair, params)
    product, lever, rate = (
        _blocks(x, size).mean(axis=1) for x in (u * np.conj(v), np.abs(u) ** 2, np.gradient(integrated, pair.step) ** 2)
    )
    middle = _blocks(integrated, size).mean(axis=1)
    noise = np.hypot(params.force_noise, params.turning_noise * rate)
    angle = np.angle(product * np.exp(1j * middle))
    return Compared(angle, np.minimum(noise / np.sqrt(np.maximum(lever, 1e-6)), np.pi))


def interval_size(pair: Pair, params: SteeringParameters) -> int:
    """Samples of the raster in an interval of comparison."""
    return max(round(params.force_interval / pair.step), 1)


def _blocks(x: NDArray[T], size: int) -> NDArray[T]:
    """(K, size) of a series (N,); the last few samples that fill no block are left out."""
    return x[: x.size // size * size].reshape(-1, size)


def drift(
    pair: Pair, rest: Rest, rate: Floats, integrated: Floats, compared: Compared, params: SteeringParameters
) -> tuple[Floats, Floats]:
    """Give what must be added to the integrated rate, (N,) rad, and its 1 sigma, (N,) rad."""
    size = interval_size(pair, params)
    known = np.asarray(np.isfinite(_blocks(rate, size)).all(axis=1), np.bool_)
    resting = np.asarray(_blocks(rest.resting, size).all(axis=1), np.bool_)
    mean_rate = _blocks(np.nan_to_num(rate), size).mean(axis=1)
    middle = _blocks(integrated, size).mean(axis=1)
    seen = Seen(known, resting, mean_rate, compared.angle - middle, compared.sigma)
    state, covariance = _smooth(size * pair.step, seen, params)
    at = _blocks(pair.t, size).mean(axis=1)
    sigma = np.sqrt(np.maximum(covariance[:, 0, 0], 0.0))
    return np.interp(pair.t, at, state[:, 0]), np.interp(pair.t, at, sigma)


def _smooth(step: float, seen: Seen, params: SteeringParameters) -> tuple[Floats, Floats]:
    """Kalman filter and Rauch-Tung-Striebel smoother over K intervals: states (K, 2), covariances (K, 2, 2)."""
    forth = np.array([[1.0, step], [0.0, 1.0]])
    x, p = np.zeros(2), np.diag([FIRST_SIGMA**2, params.bias_sigma**2])
    before, after = [], []
    for known, resting, rate, angle, sigma in zip(*seen, strict=True):
        spread = params.rate_noise if known else GAP_SIGMA
        x, p = forth @ x, forth @ p @ forth.T
        p[0, 0] += spread**2 * step
        p[1, 1] += params.bias_drift**2 * step
        before.append((x, p.copy()))
        if resting:
            x, p = _update(x, p, 1, -rate - x[1], REST_RATE_SIGMA**2)
        if np.isfinite(angle):
            innovation = (angle - x[0] + np.pi) % (2 * np.pi) - np.pi
            variance = sigma**2 * max(params.force_correlation / step, 1.0)
            if innovation**2 < params.gate**2 * (p[0, 0] + variance):
                x, p = _update(x, p, 0, innovation, variance)
        after.append((x, p))
    return _backwards(before, after, forth)


def _update(x: Floats, p: Floats, row: int, innovation: float, variance: float) -> tuple[Floats, Floats]:
    gain = p[:, row] / (p[row, row] + variance)
    return x + gain * innovation, p - np.outer(gain, p[row])


def _backwards(
    before: list[tuple[Floats, Floats]], after: list[tuple[Floats, Floats]], forth: Floats
) -> tuple[Floats, Floats]:
    x, p = after[-1]
    states, covariances = [x], [p]
    for k in range(len(after) - 2, -1, -1):
        gain = after[k][1] @ forth.T @ np.linalg.inv(before[k + 1][1])
        x = after[k][0] + gain @ (x - before[k + 1][0])
        p = after[k][1] + gain @ (p - before[k + 1][1]) @ gain.T
        states.append(x)
        covariances.append(p)
    return np.array(states[::-1]), np.array(covariances[::-1])
