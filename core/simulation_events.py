"""What happens on simulated drives, with its truth: crashes, and manoeuvres both harsh and not.

A crash is laid over a drive of `core.simulation`: from its first moment on the vehicle moves as the pulse, the tyres'
friction and its own turning make it, and the receiver tells of that motion. What must not be taken for a crash is in
`core.simulation_jolts`.
"""

from collections.abc import Callable
from dataclasses import replace
from math import pi, radians
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core import quaternion
from core.samples import COURSE, LATITUDE, LONGITUDE, SPEED, Samples
from core.simulation import Drive
from core.simulation_motion import GRAVITY, MARGIN, Trajectory, turn_back
from core.simulation_routes import ROUTES, Itinerary
from core.simulation_sensors import Receiver, gps_fixes, vibration

Floats = NDArray[np.float64]

CENTRE = np.array([1.2, 0.0, 0.3])
"""m, centre of gravity from the turning point"""
PEAK, DURATION, VELOCITY_CHANGE = (3 * GRAVITY, 40 * GRAVITY), (0.06, 0.15), (2 / 3.6, 70 / 3.6)
"""m/s2, s, m/s of a crash"""
GYRATION = 1.9
"""m2, square of the radius of gyration about the vertical"""
SHAPES: dict[str, Callable[[Floats], Floats]] = {
    "haversine": lambda x: np.square(np.sin(pi * x)),
    "half-sine": lambda x: np.sin(pi * x),
    "triangle": lambda x: 1 - np.abs(2 * x - 1),
}
"""Pulses of unit peak over [0, 1]."""
AREAS = {"haversine": 0.5, "half-sine": 2 / pi, "triangle": 0.5}
SPIN_TIME = 0.8
"""s in which a vehicle stops spinning"""
BEFORE = 10
"""samples before the first contact whose mean tells what the tyres do"""
WHITE = 0.05
"""m/s2 of noise of a vehicle that has crashed"""


class Crash(NamedTuple):
    """A collision as a pulse of acceleration, vehicle axes."""

    t: float
    """s, first contact"""
    direction: float
    """rad, where the push came from, anti-clockwise from forward"""
    peak: float
    """m/s2"""
    duration: float
    """s"""
    shape: str = "haversine"
    offset: float = 0.0
    """m by which the line of the force misses the centre of gravity, to its left: the vehicle spins"""
    friction: float = 0.6
    """of the tyres afterwards, in units of gravity"""
    ringing: float = 0.2
    """of the structure, share of the peak"""

    @property
    def velocity_change(self) -> Floats:
        """(2,) m/s forward and to the left."""
        size = self.peak * self.duration * AREAS[self.shape]
        return -size * np.array([np.cos(self.direction), np.sin(self.direction)])


def draw_crash(t: float, rng: np.random.Generator) -> Crash:
    """Draw a crash: peak by its logarithm, half of them square on, half oblique, which spin the vehicle."""
    peak, duration, shape = 0.0, 0.0, "haversine"
    while not VELOCITY_CHANGE[0] <= peak * duration * AREAS[shape] <= VELOCITY_CHANGE[1]:
        peak, duration = float(np.exp(rng.uniform(*np.log(PEAK)))), float(rng.uniform(*DURATION))
        shape = str(rng.choice(list(SHAPES)))
    square, side = bool(rng.random() < 0.5), rng.integers(4) * pi / 2
    direction = side + radians(5) * rng.normal() if square else rng.uniform(-pi, pi)
    offset = rng.uniform(-0.1, 0.1) if square else rng.uniform(-0.5, 0.5)
    direction = float((direction + pi) % (2 * pi) - pi)
    return Crash(t, direction, peak, duration, shape, float(offset), rng.uniform(0.4, 0.8), rng.uniform(0.05, 0.3))


def crash(drive: Drive, hit: Crash, rng: np.random.Generator) -> Samples:
    """Lay a crash over a drive; the range of the accelerometer is not looked at (`clipped`)."""
    samples, truth = drive
    first = int(np.searchsorted(samples.t, hit.t))
    after = samples.t[first:] - hit.t
    speed = float(np.interp(hit.t, truth.t, truth.speed))
    r_vs = quaternion.matrix(truth.mount_at(hit.t))
    up_v = quaternion.matrix(truth.q_nv[np.searchsorted(truth.t, hit.t).clip(max=truth.t.size - 1)])[2]
    tyres = (samples.f_s[max(first - BEFORE, 0) : first].mean(axis=0) - truth.bias) @ r_vs.T - GRAVITY * up_v
    path = _slide(hit, after, speed, tyres[:2])
    arm = (truth.lever_arm - CENTRE)[:2]
    a_v = path.a_v + path.spin_change[:, None] * [-arm[1], arm[0]] - path.spin[:, None] ** 2 * arm
    f_v = np.column_stack([a_v, np.zeros(after.size)]) + _ringing(hit, after, rng)
    f_s, w_s = samples.f_s.copy(), samples.w_s.copy()
    f_s[first:] = (f_v + GRAVITY * up_v) @ r_vs + truth.bias + WHITE * rng.normal(size=f_v.shape)
    w_s[first:] = np.where(np.isnan(w_s[first:]), np.nan, path.spin[:, None] * r_vs[2] + truth.gyro_bias)
    return replace(samples, f_s=f_s, w_s=w_s, fix=_crashed_fixes(drive, hit, path, after, rng))


def clipped(samples: Samples, full_scale: float) -> Samples:
    """Give what an accelerometer of this range, m/s2, reads."""
    return replace(samples, f_s=np.clip(samples.f_s, -full_scale, full_scale))


class _Path(NamedTuple):
    """Motion from the first contact on."""

    a_v: Floats
    """(N, 2) m/s2 of the centre of gravity, vehicle axes"""
    velocity: Floats
    """(N, 2) m/s in the axes the vehicle had at the first contact"""
    spin: Floats
    """(N,) rad/s"""
    spin_change: Floats
    """(N,) rad/s2"""


def _slide(hit: Crash, after: Floats, speed: float, tyres: Floats) -> _Path:
    """Pulse, while the tyres do what they did, then friction until the vehicle stands."""
    x = np.clip(after / hit.duration, 0, 1)
    shape = SHAPES[hit.shape](x)
    spin, spin_change = _spin(hit, after, x)
    turn = np.exp(1j * np.concatenate([[0.0], np.cumsum(0.5 * (spin[1:] + spin[:-1]) * np.diff(after))]))
    push = -hit.peak * np.exp(1j * hit.direction) * shape + (x < 1) * complex(*tyres)
    pushed = speed + np.concatenate([[0.0], np.cumsum((push * turn)[1:] * np.diff(after))])
    end = pushed[-1]
    since = np.maximum(after - hit.duration, 0)
    left = np.maximum(1 - hit.friction * GRAVITY * since / max(abs(end), 1e-9), 0)
    sliding = (left > 0) & (since > 0)
    velocity = np.where(since > 0, end * left, pushed)
    a_v = push - sliding * hit.friction * GRAVITY * end / max(abs(end), 1e-9) / turn
    return _Path(_pair(a_v), _pair(velocity), np.where(left > 0, spin, 0.0), np.where(left > 0, spin_change, 0.0))


def _spin(hit: Crash, after: Floats, x: Floats) -> tuple[Floats, Floats]:
    """Yaw rate, built up by the moment of the pulse, and its change with time."""
    full = -hit.offset * float(np.hypot(*hit.velocity_change)) / GYRATION
    grown = _area(hit.shape, x)
    fade = np.exp(-np.maximum(after - hit.duration, 0) / SPIN_TIME)
    spin = full * grown * fade
    change = np.where(x < 1, full * SHAPES[hit.shape](x) / (AREAS[hit.shape] * hit.duration), -spin / SPIN_TIME)
    return spin, change


def _area(shape: str, x: Floats) -> Floats:
    """Share of the pulse that is over."""
    grid = np.linspace(0, 1, 513)
    over = np.concatenate([[0.0], np.cumsum(SHAPES[shape](0.5 * (grid[1:] + grid[:-1])))])
    share: Floats = np.interp(x, grid, over / over[-1])
    return share


def _pair(z: NDArray[np.complex128]) -> Floats:
    return np.column_stack([z.real, z.imag])


def _ringing(hit: Crash, after: Floats, rng: np.random.Generator) -> Floats:
    """(N, 3) damped oscillations of the structure, strongest along the push, and what the pulse lifts or presses."""
    along, across = np.array([np.cos(hit.direction), np.sin(hit.direction), 0]), np.array([0, 0, 1.0])
    sideways = np.cross(across, along)
    total: Floats = np.zeros((after.size, 3))
    for axis, share in ((along, 1.0), (sideways, 0.6), (across, 0.8)):
        for _ in range(2):
            frequency, decay = rng.uniform(30, 90), rng.uniform(0.02, 0.06)
            wave = np.sin(2 * pi * frequency * after + rng.uniform(0, 2 * pi))
            size = share * hit.ringing * hit.peak * rng.uniform(0.5, 1) / 2**0.5
            total += (size * wave * (1 - np.exp(-after / 0.005)) * np.exp(-after / decay))[:, None] * axis
    pulse = SHAPES[hit.shape](np.clip(after / hit.duration, 0, 1))
    lift = rng.normal(0.0, 0.1) * hit.peak * pulse
    rough = 0.05 * hit.peak * pulse[:, None] * rng.normal(size=total.shape)
    total += rough + lift[:, None] * across
    return total


def _crashed_fixes(drive: Drive, hit: Crash, path: _Path, after: Floats, rng: np.random.Generator) -> Floats:
    """(M, 8) fixes that tell of the slide, late as before."""
    samples, truth = drive
    fix, told = samples.fix.copy(), truth.t - truth.latency - hit.t
    late = told > 0
    v = np.column_stack([np.interp(told[late], after, path.velocity[:, axis]) for axis in (0, 1)])
    v += 0.1 * rng.normal(size=v.shape)
    course = float(np.interp(hit.t, truth.t, np.unwrap(fix[:, COURSE])))
    fix[late, SPEED] = np.hypot(v[:, 0], v[:, 1])
    fix[late, COURSE] = (course - np.arctan2(v[:, 1], v[:, 0])) % (2 * pi)
    if late.any():
        fix[late, LATITUDE : LONGITUDE + 1] = fix[np.flatnonzero(late)[0], LATITUDE : LONGITUDE + 1]
    return fix


class Manoeuvres(NamedTuple):
    """A drive full of manoeuvres, and what the vehicle did."""

    samples: Samples
    q_vs: Floats
    """(4,)"""
    t: Floats
    """(N,) s"""
    a_v: Floats
    """(N, 2) m/s2 of the turning point, forward and left, without gravity"""
    metres: float
    """driven"""


def manoeuvres(seed: int, seconds: float = 600.0, rate: float = 100.0, gyro: bool = True) -> Manoeuvres:
    """Drive with brakings, accelerations and bends both harsh and not."""
    routing, riding, sensing, receiving = (np.random.default_rng(s) for s in np.random.SeedSequence(seed).spawn(4))
    plan = Itinerary(routing)
    plan.hold(3.0)
    route = ROUTES["harsh"]
    while plan.t < seconds + MARGIN:
        route.stretch(plan)
    road = route.road
    trajectory = Trajectory.of(plan, road, seconds, riding)
    t = np.arange(0.0, seconds, 1 / rate)
    motion, q_vs = trajectory.at(t), quaternion.random(sensing)
    arm = np.array([1.0, 0.3, 0.3])
    shaking, rattling = vibration(t, motion.speed, road.roughness, riding)
    r_vs = quaternion.matrix(q_vs)
    f_s = turn_back(r_vs, motion.specific_force(arm) + shaking) + 0.2 * sensing.normal(size=3)
    w_s = turn_back(r_vs, motion.w_v + rattling) if gyro else None
    rows = np.arange(int(rate), t.size, int(rate / 4))
    fix = gps_fixes(trajectory, t[rows] - receiving.uniform(0, 0.5), arm, Receiver(), receiving)
    samples = Samples.make(t, f_s, w_s, rows, np.ones(rows.size, np.bool_), fix)
    heading = np.column_stack([np.cos(motion.yaw), np.sin(motion.yaw)])
    left = np.column_stack([-heading[:, 1], heading[:, 0]])
    a_v = np.column_stack([(motion.a_n[:, :2] * axis).sum(axis=1) for axis in (heading, left)])
    return Manoeuvres(samples, q_vs, t, a_v, float(np.abs(motion.speed).sum() / rate))
