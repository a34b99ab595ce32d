"""Steering-wheel angle from two devices, one in the vehicle and one on the wheel (seed 004, phases F1-F6 and G1-G6).

    found = two_devices(car, wheel)
    found.steering.angle        rad at the wheel, positive to the left, on the clock of the vehicle's device

Each device records on a clock of its own, at a rate of its own, at any attitude. While the vehicle stands, the
wheel has to be turned a quarter turn to each side or more. Frames: c the vehicle's device, w the wheel's.

Corrected in the document: phase G6 names the matrix of G4, it is that of G5; F4 refers only one device to the other's
axes, the difference needs both components along the same axis with the same sense; the rotation of G5 is not free but
about the axis of G2, else the motion along gravity makes it vague.
"""

from typing import NamedTuple

import numpy as np

from core import quaternion
from core.motion import steering_alignment, steering_fusion, steering_zero
from core.motion.steering_alignment import Pair
from core.motion.steering_clocks import Clock, align, averages, even_raster
from core.motion.steering_terms import DEFAULT, Floats, Steering, SteeringError, SteeringParameters
from core.samples import Samples

__all__ = ["DEFAULT", "Steering", "SteeringError", "SteeringParameters", "TwoDevices", "two_devices"]


class TwoDevices(NamedTuple):
    """Steering from two devices, and what was found on the way."""

    steering: Steering
    """on an even raster"""
    by_rates: Floats
    """(N,) rad by the rates alone (F1-F6)"""
    by_forces: Floats
    """(N,) rad by the specific forces alone (G1-G6), in (-pi, pi]"""
    clock: Clock
    axis_w: Floats
    """(3,) the column towards the driver, axes of the wheel's device"""
    q_cw: Floats
    """(4,) attitude of the wheel's device to the vehicle's, the wheel straight"""
    zero_sigma: float
    """rad, 1 sigma of where straight is; nan = it was given"""


def two_devices(
    car: Samples,
    wheel: Samples,
    params: SteeringParameters = DEFAULT,
    straight: float | None = None,
    q_cw: Floats | None = None,
) -> TwoDevices:
    """Find the steering-wheel angle of a drive.

    Parameters
    ----------
    car, wheel
        of the device in the vehicle and the one on the wheel, both with gyroscopes
    straight
        s on the vehicle device's clock at which the wheel is straight
    q_cw
        attitude of the wheel's device to the vehicle's with the wheel straight, such as q_vc* q_vw of their mountings;
        with neither of both the drive shows it, and where it cannot, the wheel is straight at the first moment

    Raises
    ------
    SteeringError
        a gyroscope is missing, the recordings are not of the same drive, or the wheel was not turned at a standstill.
    """
    clock = _clock(car, wheel, params)
    pair = _on_one_raster(car, wheel, clock, params)
    speed = steering_zero.speed_at(car, pair.t)
    rest = steering_alignment.find_rest(pair, speed, params)
    pair = steering_alignment.without_bias(pair, rest)
    during = steering_alignment.find_standstill(pair, rest, params)
    seat = steering_alignment.find_seat(pair, during, params)
    pair = steering_alignment.without_turning(pair, seat)
    first = steering_alignment.find_attitude(pair, during, seat.axis_w)
    rate = steering_alignment.steering_rate(pair, seat.axis_w, first)
    integrated = steering_alignment.integral(rate, pair.step, during.start)
    compared = steering_fusion.compare_forces(pair, seat.axis_w, first, integrated, params)
    correction, sigma = steering_fusion.drift(pair, rest, rate, integrated, compared, params)
    zero, zero_sigma = _zero(pair, integrated + correction, speed, params, straight, _twist(first, q_cw, seat.axis_w))
    known = np.isfinite(rate)
    steering = Steering(
        pair.t,
        np.where(known, integrated + correction - zero, np.nan),
        rate + np.gradient(correction, pair.step),
        np.sqrt(sigma**2 + params.systematic**2 + np.nan_to_num(zero_sigma) ** 2),
    )
    rough = np.repeat(compared.angle, steering_fusion.interval_size(pair, params))
    by_forces = np.full(pair.t.size, np.nan)
    by_forces[: rough.size] = (rough - zero + np.pi) % (2 * np.pi) - np.pi
    q_straight = quaternion.multiply(first, quaternion.from_rotation_vector(zero * seat.axis_w))
    return TwoDevices(
        steering, integrated - zero, by_forces, clock, seat.axis_w, quaternion.normalise(q_straight), zero_sigma
    )


def _clock(car: Samples, wheel: Samples, params: SteeringParameters) -> Clock:
    for samples, where in ((car, "in the vehicle"), (wheel, "on the steering wheel")):
        if not np.isfinite(samples.w_s).any():
            raise SteeringError(f"The device {where} has no gyroscope, without which its turning does not show.")
    # along the direction it turns about most the wheel's device feels the steering; the rest is shared
    rates = wheel.w_s - np.nanmedian(wheel.w_s, axis=0)
    rates = rates[np.isfinite(rates).all(axis=1)]
    axis = np.linalg.svd(rates.T @ rates)[0][:, 0]
    across = wheel.w_s - np.outer(wheel.w_s @ axis, axis)
    return align((car.t, _lengths(car.f_s, car.w_s)), (wheel.t, _lengths(wheel.f_s, across)), params.rate)


def _lengths(*vectors: Floats) -> Floats:
    return np.stack([np.linalg.norm(v, axis=1) for v in vectors], axis=-1)


def _on_one_raster(car: Samples, wheel: Samples, clock: Clock, params: SteeringParameters) -> Pair:
    t_wheel = clock.on_car(wheel.t)
    overlap = np.array([max(car.t[0], t_wheel[0]), min(car.t[-1], t_wheel[-1])])
    raster = even_raster(overlap, params.rate)
    logs = ((car.t, car.f_s), (car.t, car.w_s), (t_wheel, wheel.f_s), (t_wheel, wheel.w_s))
    return Pair(raster, *(averages(t, x, raster) for t, x in logs))


def _twist(first: Floats, q_cw: Floats | None, axis_w: Floats) -> float | None:
    """Angle at the straight position on the scale whose zero is `first`: the turn about the axis between the two."""
    if q_cw is None:
        return None
    between = quaternion.multiply(quaternion.conjugate(first), q_cw)
    return float((2 * np.arctan2(between[1:] @ axis_w, between[0]) + np.pi) % (2 * np.pi) - np.pi)


def _zero(
    pair: Pair, angle: Floats, speed: Floats, params: SteeringParameters, straight: float | None, twist: float | None
) -> tuple[float, float]:
    """Angle of the straight wheel and its 1 sigma, nan = given."""
    if straight is not None:
        return float(np.interp(straight, pair.t, angle)), float("nan")
    if twist is not None:
        return twist, float("nan")
    yaw = steering_zero.yaw_rate(pair.f_c, pair.w_c)
    shown = steering_zero.straight_angle(angle, yaw, speed, pair.step, params.straight_speed)
    return shown or (float(angle[0]), float("nan"))
