"""How a device on the steering wheel sits: its axis of rotation, its place, its attitude to the vehicle's device.

The axis is what the wheel's device turns about while the vehicle stands (seed 004, phases F2 and G2). In the plane
across the axis, written as complex numbers, the device then feels

    f = u exp(-i angle) + offset + arm (-rate^2 + i d rate/dt)

gravity on a circle about the accelerometer's offset, and the forces of its own turning: linear in u, offset and arm.
The attitude (F1, G1) is the rotation that superposes the specific forces of both devices over a whole drive, while the
rates say how the wheel turned meanwhile; that needs no moment at which the wheel is known to be straight.
"""

from typing import NamedTuple

import numpy as np
from scipy.ndimage import uniform_filter1d
from scipy.optimize import least_squares

from core import quaternion
from core.motion.steering_terms import Booleans, Complexes, Floats, SteeringError, SteeringParameters

OFFSET_SIGMA = 0.4
"""m/s2, 1 sigma of an accelerometer's offset before anything is known"""
ARM_SIGMA = 0.15
"""m, 1 sigma of the distance of the device from the axis"""
TURNING_FORCE_SIGMA = 0.1
"""m/s2, 1 sigma of the specific force while the wheel is turned at a standstill"""
LEAST_FIRST = 0.9
"""share of the turning that one axis must explain"""
ALIGNMENT_SPAN = 900.0
"""s of a drive that show the attitude"""
ALIGNMENT_INTERVAL = 0.5
"""s over which specific forces are averaged for it"""
HEADINGS = 24
"""headings about the vertical that are tried at first"""


class Pair(NamedTuple):
    """Both devices on one raster, on the clock of the vehicle's; nan where either has a gap."""

    t: Floats
    """(N,) s, even"""
    f_c: Floats
    """(N, 3) m/s2 of the vehicle's device, its axes"""
    w_c: Floats
    """(N, 3) rad/s"""
    f_w: Floats
    """(N, 3) m/s2 of the wheel's device, its axes"""
    w_w: Floats
    """(N, 3) rad/s"""

    @property
    def step(self) -> float:
        """Interval of the raster, s."""
        return float(self.t[1] - self.t[0])


class Rest(NamedTuple):
    """When what is still."""

    standing: Booleans
    """(N,) the vehicle"""
    resting: Booleans
    """(N,) the wheel as well"""


class Seat(NamedTuple):
    """How the device sits on the wheel."""

    axis_w: Floats
    """(3,) unit vector in its axes, towards the driver: turning to the left is positive about it"""
    offset_w: Floats
    """(3,) m/s2, offset of its accelerometer across the axis"""
    arm_w: Floats
    """(3,) m, its place from the axis"""


def find_rest(pair: Pair, speed: Floats, params: SteeringParameters) -> Rest:
    """Find when vehicle and wheel are still; `speed` (N,) in m/s, nan where not known, has a veto."""
    slow = ~(speed > 0.5)
    standing = slow & _quiet(pair.w_c, pair.step, params.still_rate)
    resting = standing & _quiet(pair.w_w, pair.step, params.still_rate)
    if resting.sum() * pair.step < 2.0:
        raise SteeringError("There is no standstill of two seconds in which the steering wheel is left alone.")
    return Rest(standing, resting)


def _quiet(w: Floats, step: float, limit: float) -> Booleans:
    """(N,) True where a rate scatters little and stays where it is at rest."""
    size = max(round(1.0 / step), 3)
    mean = uniform_filter1d(np.nan_to_num(w, nan=1e3), size, axis=0)
    scatter = np.sqrt(uniform_filter1d(np.nan_to_num((w - mean) ** 2, nan=1e3), size, axis=0).sum(axis=1))
    quiet = scatter < limit
    if not quiet.any():
        return np.zeros(quiet.size, np.bool_)
    usual = np.median(mean[quiet], axis=0)
    still: Booleans = quiet & (np.linalg.norm(mean - usual, axis=1) < limit)
    return still


def without_bias(pair: Pair, rest: Rest) -> Pair:
    """Take off the bias of both gyroscopes, which the rests show."""
    return pair._replace(
        w_c=pair.w_c - pair.w_c[rest.standing].mean(axis=0), w_w=pair.w_w - pair.w_w[rest.resting].mean(axis=0)
    )


def find_standstill(pair: Pair, rest: Rest, params: SteeringParameters) -> slice:
    """Find the standstill in which the wheel is turned most."""
    turning = rest.standing & (np.linalg.norm(pair.w_w, axis=1) > params.turning_rate)
    turned = np.concatenate([[0.0], np.cumsum(np.where(turning, np.linalg.norm(pair.w_w, axis=1), 0.0)) * pair.step])
    edges = np.flatnonzero(np.diff(np.concatenate([[False], rest.standing, [False]]).astype(np.int8)))
    starts, stops = edges[::2], edges[1::2]
    k = int(np.argmax(turned[stops] - turned[starts]))
    if turned[stops[k]] - turned[starts[k]] < params.least_turning:
        raise SteeringError(
            "The axis of the steering wheel does not show: turn it by a quarter turn to each side while the vehicle "
            "stands."
        )
    return slice(int(starts[k]), int(stops[k]))


def find_seat(pair: Pair, during: slice, params: SteeringParameters) -> Seat:
    """Find the axis and the device's place on the wheel from turning it at a standstill (F2, G2)."""
    rates = pair.w_w[during]
    rates = rates[np.linalg.norm(rates, axis=1) > params.turning_rate]
    _, spread, directions = np.linalg.svd(rates, full_matrices=False)
    if spread[0] ** 2 < LEAST_FIRST * (spread**2).sum():
        raise SteeringError("The device on the steering wheel does not turn about one axis: it is loose.")
    axis_w = directions[0] * (1.0 if pair.f_w[during].mean(axis=0) @ directions[0] > 0 else -1.0)
    across = plane(axis_w)
    rate = pair.w_w[during] @ axis_w
    turn, force = np.exp(-1j * np.cumsum(rate) * pair.step), pair.f_w[during] @ across
    columns = np.stack([turn, np.ones_like(turn), -(rate**2) + 1j * np.gradient(rate, pair.step)], axis=-1)
    prior = TURNING_FORCE_SIGMA * np.array([[0, 1 / OFFSET_SIGMA, 0], [0, 0, 1 / ARM_SIGMA]])
    _, offset, arm = np.linalg.lstsq(np.vstack([columns, prior]), np.append(force, [0, 0]))[0]
    return Seat(axis_w, np.real(offset * across.conj()), np.real(arm * across.conj()))


def plane(axis: Floats) -> Complexes:
    """(3,) complex p: `v @ p` is the part of a vector across the axis; turning by a about it multiplies by exp(ia)."""
    first = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    first /= np.linalg.norm(first)
    across: Complexes = first + 1j * np.cross(axis, first)
    return across


def without_turning(pair: Pair, seat: Seat) -> Pair:
    """Take off the offset of the wheel's accelerometer and what it feels of its own turning."""
    rate = pair.w_w @ seat.axis_w
    quickening = np.gradient(rate, pair.step)
    own = -(rate**2)[:, None] * seat.arm_w + quickening[:, None] * np.cross(seat.axis_w, seat.arm_w)
    return pair._replace(f_w=pair.f_w - seat.offset_w - own)


def steering_rate(pair: Pair, axis_w: Floats, q_cw: Floats) -> Floats:
    """(N,) rad/s, difference of the rates along the axis (F3-F5)."""
    rate: Floats = pair.w_w @ axis_w - pair.w_c @ quaternion.rotate(q_cw, axis_w)
    return rate


def integral(rate: Floats, step: float, origin: int) -> Floats:
    """(N,) rad, integral of a rate from the sample `origin` on (F6); through gaps as if the wheel did not turn."""
    rate = np.nan_to_num(rate)
    angle = (np.cumsum(rate) - rate / 2) * step
    return np.asarray(angle - angle[origin], np.float64)


def find_attitude(pair: Pair, during: slice, axis_w: Floats) -> Floats:
    """(4,) q_cw, attitude of the wheel's device to the vehicle's when the standstill begins (F1, G1)."""
    span = round(ALIGNMENT_SPAN / pair.step)
    first = max(min(during.start, pair.t.size - span), 0)
    piece, origin = Pair(*(x[first : first + span] for x in pair)), during.start - first
    start, up_c = _superposed_gravity(Pair(*(x[during] for x in pair)), axis_w)
    trials = [
        quaternion.multiply(quaternion.from_rotation_vector(heading * up_c), start)
        for heading in np.arange(HEADINGS) * (2 * np.pi / HEADINGS)
    ]
    best = min(trials, key=lambda q: float(np.abs(_misfit(np.zeros(4), q, piece, axis_w, origin)).sum()))
    fit = least_squares(_misfit, np.zeros(4), loss="soft_l1", f_scale=0.5, args=(best, piece, axis_w, origin))
    return quaternion.normalise(quaternion.multiply(quaternion.from_rotation_vector(fit.x[:3]), best))


def _superposed_gravity(standstill: Pair, axis_w: Floats) -> tuple[Floats, Floats]:
    """A rotation that superposes gravity of both devices, and the vertical about which it is not known yet."""
    turned = integral(standstill.w_w @ axis_w, standstill.step, 0)
    turned_back = quaternion.rotate(quaternion.from_rotation_vector(turned[:, None] * axis_w), standstill.f_w)
    up_w, up_c = (f.mean(axis=0) / np.linalg.norm(f.mean(axis=0)) for f in (turned_back, standstill.f_c))
    half = np.append(1.0 + up_w @ up_c, np.cross(up_w, up_c))
    if half[0] < 1e-6:  # opposite: a half turn about any direction across
        half = np.append(0.0, np.real(plane(up_w)))
    return quaternion.normalise(half), up_c


def _misfit(p: Floats, q_cw: Floats, pair: Pair, axis_w: Floats, origin: int) -> Floats:
    """(M,) m/s2 by which the specific forces miss each other; `p`: small rotation (3,), drift of angle, mrad/s."""
    q_cw = quaternion.multiply(quaternion.from_rotation_vector(p[:3]), q_cw)
    angle = integral(steering_rate(pair, axis_w, q_cw) + 1e-3 * p[3], pair.step, origin)
    cosine, sine = np.cos(angle)[:, None], np.sin(angle)[:, None]
    along = (pair.f_w @ axis_w)[:, None] * axis_w
    turned_back = along + cosine * (pair.f_w - along) + sine * np.cross(axis_w, pair.f_w)
    miss = np.nan_to_num(pair.f_c - turned_back @ quaternion.matrix(q_cw).T)
    size = max(round(ALIGNMENT_INTERVAL / pair.step), 1)
    count = miss.shape[0] // size
    averages: Floats = miss[: count * size].reshape(count, size, 3).mean(axis=1).ravel()
    return averages
