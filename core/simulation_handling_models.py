"""Vehicles of the handling simulation: single-track models, linear and with saturating tyres, and a two-track model.

Independent of the models in `core.motion`: other tyre curves (Pacejka's magic formula), other load dependence.
"""

from collections.abc import Callable
from math import atan, copysign, cos, sin
from typing import NamedTuple

from core.motion.vehicle import Vehicle

GRAVITY = 9.80665
SHAPE = 1.35
"""C of the magic formula"""
LOAD_LOSS = 0.15
"""share of stiffness and of friction lost when the load of a tyre doubles"""
FRONT_ROLL_SHARE = 0.55
"""share of the overturning moment that the front axle takes"""


class Forces(NamedTuple):
    """Forces of the tyres, vehicle axes."""

    fx: float
    """N"""
    fy: float
    """N"""
    mz: float
    """N m"""


Model = Callable[[Vehicle, float, float, float, float, float, float], Forces]
"""(vehicle, u, v, r, wheel angle, longitudinal and lateral acceleration felt) -> forces without the drive"""


def _linear(stiffness: float, limit: float, slip: float) -> float:
    del limit
    return stiffness * slip


def _magic(stiffness: float, limit: float, slip: float) -> float:
    """Magic formula of Pacejka without curvature: the slope at zero is the stiffness, the peak the limit."""
    return limit * sin(SHAPE * atan(stiffness * slip / (SHAPE * limit)))


def _single_track(tyre: Callable[[float, float, float], float]) -> Model:
    def forces(c: Vehicle, u: float, v: float, r: float, wheel: float, _ax: float, _ay: float) -> Forces:
        weight = c.mass * GRAVITY * c.friction / c.wheelbase
        f1 = tyre(c.cornering_stiffness_1, weight * c.a2, wheel - atan((v + c.a1 * r) / u))
        f2 = tyre(c.cornering_stiffness_2, weight * c.a1, -atan((v - c.a2 * r) / u))
        return Forces(-f1 * sin(wheel), f1 * cos(wheel) + f2, c.a1 * f1 * cos(wheel) - c.a2 * f2)

    return forces


def _two_track(c: Vehicle, u: float, v: float, r: float, wheel: float, ax: float, ay: float) -> Forces:
    """Four wheels; the load moves outwards in a curve, forwards when braking."""
    fx = fy = mz = 0.0
    along = c.mass * ax * c.cg_height / c.wheelbase
    axles = (
        (c.a1, c.cornering_stiffness_1, c.mass * GRAVITY * c.a2 / c.wheelbase, -along, FRONT_ROLL_SHARE, wheel),
        (-c.a2, c.cornering_stiffness_2, c.mass * GRAVITY * c.a1 / c.wheelbase, along, 1 - FRONT_ROLL_SHARE, 0.0),
    )
    for x, stiffness, static, moved, share, angle in axles:
        across = c.mass * ay * c.cg_height / c.track * share
        for side in (1.0, -1.0):  # left, right
            load = max((static + moved) / 2 - side * across, 0.02 * static)
            y = side * c.track / 2
            slip = angle - atan((v + x * r) / (u - y * r))
            loss = 1 - LOAD_LOSS * (2 * load / static - 1)
            force = _magic(stiffness * load / static * loss, c.friction * load * loss, slip)
            fx -= force * sin(angle)
            fy += force * cos(angle)
            mz += x * force * cos(angle) + y * force * sin(angle)
    return Forces(fx, fy, mz)


MODELS: dict[str, Model] = {
    "linear": _single_track(_linear),
    "nonlinear": _single_track(_magic),
    "two_track": _two_track,
}


class Planar(NamedTuple):
    """State on the plan."""

    x: float
    y: float
    yaw: float
    u: float
    v: float
    r: float

    def moved(self, rate: "Planar", dt: float) -> "Planar":
        """Give the state carried on at a rate of change."""
        return Planar(*(a + dt * b for a, b in zip(self, rate, strict=True)))


CREEP = 1.0
"""m/s; slip angles are taken at no lower speed, so that a standing vehicle has none"""


def planar_rate(model: Model, c: Vehicle, state: Planar, wheel: float, drive: float, bank: float) -> Planar:
    """Time derivative; `drive` in m/s2 is the longitudinal force over the mass, `bank` right side down, rad."""
    _, _, yaw, u, v, r = state
    force = model(c, max(abs(u), CREEP), v, r, wheel, drive, u * r)
    slow = min(abs(u) / CREEP, 1.0)
    return Planar(
        u * cos(yaw) - v * sin(yaw),
        u * sin(yaw) + v * cos(yaw),
        r,
        drive + slow * force.fx / c.mass + v * r,
        slow * (force.fy / c.mass - GRAVITY * sin(bank)) - u * r,
        slow * force.mz / c.yaw_inertia,
    )


def step(model: Model, c: Vehicle, state: Planar, wheel: float, drive: float, bank: float, dt: float) -> Planar:
    """Carry the state on by the classical Runge-Kutta method, inputs held."""
    k1 = planar_rate(model, c, state, wheel, drive, bank)
    k2 = planar_rate(model, c, state.moved(k1, dt / 2), wheel, drive, bank)
    k3 = planar_rate(model, c, state.moved(k2, dt / 2), wheel, drive, bank)
    k4 = planar_rate(model, c, state.moved(k3, dt), wheel, drive, bank)
    mean = Planar(*((a + 2 * b + 2 * d + e) / 6 for a, b, d, e in zip(k1, k2, k3, k4, strict=True)))
    return state.moved(mean, dt)


def steady_steer(c: Vehicle, u: float, ay: float) -> float:
    """Angle of the front wheels for a lateral acceleration in steady state, tyres linear."""
    understeer = c.mass / c.wheelbase * (c.a2 / c.cornering_stiffness_1 - c.a1 / c.cornering_stiffness_2)
    wheel = ay * (c.wheelbase / max(u, 3.0) ** 2 + understeer)
    return copysign(min(abs(wheel), 0.5), wheel)
