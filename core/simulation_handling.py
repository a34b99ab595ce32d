"""Simulated handling manoeuvres, up to the limits of the tyres, with the truth of sideslip, velocity and position.

    drive = simulate_handling(HandlingScenario("double_lane_change", level=0.6, seed=3))
    drive.samples                   what the device records
    drive.truth.at(t).sideslip      what nobody tells the reconstruction

A drive stands, sets off, drives about for a while, then repeats its manoeuvre. Sensors and receiver err as in
`core.simulation_sensors`.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from math import pi, radians, sin
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import make_interp_spline
from scipy.signal import lfilter

from core import quaternion
from core.motion.vehicle import VEHICLES, Vehicle
from core.samples import Samples
from core.simulation_handling_models import MODELS, Planar, steady_steer, step
from core.simulation_motion import (
    BODY_FREQUENCY,
    GRAVITY,
    PITCH_PER_ACCELERATION,
    Trajectory,
    smooth_noise,
    turn_back,
)
from core.simulation_sensors import (
    EARTH_RADIUS,
    ORIGIN,
    SENSORS,
    Receiver,
    SensorErrors,
    accelerometer,
    gps_fixes,
    gyroscope,
    vibration,
)

Floats = NDArray[np.float64]

STEP = 0.01
"""s of the integration and between the knots of the splines"""
STANDING = 4.0
"""s before it sets off"""
MANOEUVRES_BEGIN = 40.0
"""s"""
STEER_NOISE = radians(0.5)
"""rad, white, at the steering wheel"""
STEER_OFFSET = radians(1.5)
"""rad, 1 sigma: zero of the steering wheel"""
MERIDIAN, PARALLEL = 6368132.0, 6389089.0
"""m, radii of curvature of WGS 84 at `ORIGIN`"""


def _double_lane_change(t: float) -> float:
    """As ISO 3888-1 is driven: out within 2.2 s, a second in the other lane, and back; then 4 s straight on."""
    t %= 9.4
    if t < 2.2:
        return sin(2 * pi * t / 2.2)
    if 3.2 < t < 5.4:
        return -sin(2 * pi * (t - 3.2) / 2.2)
    return 0.0


def _constant_radius(t: float) -> float:
    """As ISO 4138: 20 s of a circle, 4 s straight on, then the other way round."""
    side = 1.0 if t % 48.0 < 24.0 else -1.0
    t %= 24.0
    return side * min(max(t / 2.0, 0.0), 1.0, max((20.0 - t) / 2.0, 0.0))


def _slalom(t: float) -> float:
    """0.4 Hz for 20 s, then 5 s straight on."""
    t %= 25.0
    return sin(2 * pi * 0.4 * t) if t < 20.0 else 0.0


class Manoeuvre(NamedTuple):
    """Demand for lateral acceleration over time, share of its level, and the speed for a level in g."""

    demand: Callable[[float], float]
    speed: Callable[[float], float]
    """m/s"""


MANOEUVRES = {
    "double_lane_change": Manoeuvre(_double_lane_change, lambda _: 22.0),
    "constant_radius": Manoeuvre(_constant_radius, lambda level: float(np.sqrt(40.0 * level * GRAVITY))),
    "slalom": Manoeuvre(_slalom, lambda _: 16.0),
}


@dataclass(frozen=True, eq=False)
class HandlingScenario:
    """What to simulate."""

    manoeuvre: str = "double_lane_change"
    """a key of `MANOEUVRES`"""
    model: str = "nonlinear"
    """linear, nonlinear, two_track"""
    level: float = 0.5
    """g, lateral acceleration demanded; tyres that saturate give less"""
    vehicle: Vehicle = field(default_factory=lambda: VEHICLES["sedan"])
    """its `device` is the place of device and antenna; None = anywhere in the cabin, from the seed"""
    seconds: float = 90.0
    seed: int = 0
    mount: ArrayLike | None = None
    """(4,) q_vs; None = any orientation, from the seed"""
    sensor: str = "mems"
    gyro: bool = True
    steer: bool = True
    imu_rate: float = 100.0
    """Hz"""
    gps_rate: float = 5.0
    """Hz"""
    latency: float = 0.0
    """s"""
    outages: tuple[tuple[float, float], ...] = ()
    """(start, end) s without a fix"""
    relief: float = 1.0
    """1 = banks and grades of about a degree, 0 = a flat road"""
    reverse: bool = False
    """back out at walking pace before setting off"""


class TrueMotion(NamedTuple):
    """What is true at N moments, of the centre of gravity; as in `core.motion.Motion`."""

    q_nv: Floats
    velocity_v: Floats
    """(N, 3) m/s"""
    sideslip: Floats
    position_n: Floats
    """(N, 3) m from where the drive starts"""
    w_v: Floats
    a_v: Floats


@dataclass(frozen=True, eq=False)
class HandlingTruth:
    """What is true of a drive."""

    scenario: HandlingScenario
    q_vs: Floats
    device: tuple[float, float, float]
    trajectory: Trajectory

    def at(self, t: Floats) -> TrueMotion:
        """Give the motion at times of the drive."""
        motion = self.trajectory.at(t)
        r_nv = motion.r_nv()
        velocity = turn_back(r_nv, motion.v_n)
        q_nv = np.array([quaternion.from_matrix(r) for r in r_nv])
        return TrueMotion(
            q_nv,
            velocity,
            np.arctan2(velocity[:, 1], velocity[:, 0]),
            self.trajectory.position(t) - self.trajectory.position(np.zeros(1)),
            motion.w_v,
            turn_back(r_nv, motion.a_n),
        )


class HandlingDrive(NamedTuple):
    """A simulated drive."""

    samples: Samples
    truth: HandlingTruth


def simulate_handling(scenario: HandlingScenario) -> HandlingDrive:
    """Simulate a drive.

    Raises
    ------
    KeyError
        an unknown manoeuvre, model or sensor
    """
    choosing, riding, sensing, receiving = (
        np.random.default_rng(s) for s in np.random.SeedSequence(scenario.seed).spawn(4)
    )
    anywhere = choosing.uniform([-0.5, -0.5, 0.1], [1.2, 0.5, 0.6])
    mount = quaternion.random(choosing)
    device = tuple(float(x) for x in (anywhere if scenario.vehicle.device is None else scenario.vehicle.device))
    trajectory, wheel = _drive(scenario, riding)
    q_vs = quaternion.normalise(mount if scenario.mount is None else scenario.mount)
    truth = HandlingTruth(scenario, q_vs, (device[0], device[1], device[2]), trajectory)
    return HandlingDrive(_record(scenario, truth, wheel, riding, sensing, receiving), truth)


def _drive(scenario: HandlingScenario, rng: np.random.Generator) -> tuple[Trajectory, Floats]:
    """Drive the manoeuvre: trajectory, and (K, 2) times and angles of the front wheels."""
    t = np.arange(-1.0, scenario.seconds + 1.0, STEP)
    bank = scenario.relief * radians(1.0) * smooth_noise(rng, t.size, 4.0 / STEP)
    grade = scenario.relief * radians(1.0) * smooth_noise(rng, t.size, 6.0 / STEP)
    moving = np.clip((t - STANDING) / 4.0, 0.0, 1.0)  # it does not rock while it stands
    held = int((STANDING + 1.0) / STEP)
    bank, grade = (values[held] + moving * (values - values[held]) for values in (bank, grade))
    states, wheels, drives = [Planar(0.0, 0.0, 0.7, 0.0, 0.0, 0.0)], [0.0], [0.0]
    for k in range(t.size - 1):
        wheel, drive = _driver(scenario, float(t[k]), states[-1])
        states.append(step(MODELS[scenario.model], scenario.vehicle, states[-1], wheel, drive, float(bank[k]), STEP))
        wheels.append(wheel)
        drives.append(drive)
    return _trajectory(scenario, t, np.array(states), bank, grade), np.column_stack([t, wheels])


def _driver(scenario: HandlingScenario, t: float, state: Planar) -> tuple[float, float]:
    """Angle of the front wheels and longitudinal acceleration that the driver wants."""
    manoeuvre = MANOEUVRES[scenario.manoeuvre]
    if t < STANDING:
        return 0.0, 0.0
    if scenario.reverse and t < STANDING + 10.0:
        wanted = -2.5 if t < STANDING + 7.0 else 0.0
        return 0.1 * min(1.0, t - STANDING), float(np.clip(wanted - state.u, -1.5, 1.5))
    speed, ay = manoeuvre.speed(scenario.level), 0.0
    if t >= MANOEUVRES_BEGIN:
        ay = scenario.level * GRAVITY * manoeuvre.demand(t - MANOEUVRES_BEGIN)
    elif state.u > 5.0:
        ay = 1.5 * sin(2 * pi * t / 11.0)  # ordinary curves
        speed *= 0.85 + 0.15 * sin(2 * pi * t / 13.0)
    drive = float(np.clip(0.8 * (speed - state.u) - state.v * state.r, -5.0, 2.5))
    return steady_steer(scenario.vehicle, state.u, ay), drive


def _trajectory(scenario: HandlingScenario, t: Floats, states: Floats, bank: Floats, grade: Floats) -> Trajectory:
    """Splines through the motion on the plan, with the lean of the body on its springs."""
    yaw, u, v, r = states[:, 2], states[:, 3], states[:, 4], states[:, 5]
    speed = np.where(u < 0, -1.0, 1.0) * np.hypot(u, v)
    slip = np.where(np.abs(u) > 1e-3, np.arctan(v / np.where(np.abs(u) > 1e-3, u, 1.0)), 0.0)
    roll = bank + _suspension(scenario.vehicle.roll_gradient * u * r)
    pitch = -grade - _suspension(PITCH_PER_ACCELERATION * np.gradient(u, STEP))
    signals = np.stack([speed, yaw + slip, grade, np.zeros(t.size), yaw, pitch, roll], axis=-1)
    level = speed * np.cos(grade)
    v_n = np.stack([level * np.cos(yaw + slip), level * np.sin(yaw + slip), speed * np.sin(grade)], axis=-1)
    return Trajectory(make_interp_spline(t, signals, k=5), make_interp_spline(t, v_n, k=3).antiderivative())


def _suspension(static: Floats) -> Floats:
    """Second-order lag of the body behind the force on its springs, damping ratio 0.4."""
    pole = 2 * pi * BODY_FREQUENCY * STEP * (-0.4 + 1j * np.sqrt(1 - 0.4**2))
    a = np.real(np.poly([np.exp(pole), np.exp(np.conj(pole))]))
    lagged: Floats = lfilter([a.sum()], a, static)
    return lagged


def _record(
    scenario: HandlingScenario,
    truth: HandlingTruth,
    wheel: Floats,
    riding: np.random.Generator,
    sensing: np.random.Generator,
    receiving: np.random.Generator,
) -> Samples:
    """What the device reads."""
    sensor = SENSORS[scenario.sensor]
    errors = SensorErrors.draw(sensor, sensing)
    t = np.arange(0.0, scenario.seconds, 1 / scenario.imu_rate)
    motion, arm = truth.trajectory.at(t), np.array(truth.device)
    shaking, rattling = vibration(t, motion.speed, 1.0, riding)
    r_vs = quaternion.matrix(truth.q_vs)
    f_s = accelerometer(
        turn_back(r_vs, motion.specific_force(arm) + shaking), scenario.imu_rate, sensor, errors, sensing
    )
    w_s = gyroscope(turn_back(r_vs, motion.w_v + rattling), scenario.imu_rate, sensor, errors, sensing)
    steer_error = STEER_OFFSET * sensing.normal() + STEER_NOISE * sensing.normal(size=t.size)
    steer = scenario.vehicle.steering_ratio * np.interp(t, *wheel.T) + steer_error
    reported = np.arange(1 / scenario.gps_rate, t[-1], 1 / scenario.gps_rate)
    fix = _on_the_ellipsoid(gps_fixes(truth.trajectory, reported - scenario.latency, arm, Receiver(), receiving))
    valid = np.ones(reported.size, np.bool_)
    for start, end in scenario.outages:
        valid &= (reported < start) | (reported >= end)
    return Samples.make(
        t,
        f_s,
        w_s if scenario.gyro else None,
        np.searchsorted(t, reported - 1e-6),
        valid,
        np.where(valid[:, None], fix, np.nan),
        steer=steer if scenario.steer else None,
    )


def _on_the_ellipsoid(fix: Floats) -> Floats:
    """Scale latitude and longitude, made on a sphere, to WGS 84: a kilometre remains one."""
    fix = fix.copy()
    fix[:, 0] = ORIGIN[0] + (fix[:, 0] - ORIGIN[0]) * EARTH_RADIUS / MERIDIAN
    fix[:, 1] = ORIGIN[1] + (fix[:, 1] - ORIGIN[1]) * EARTH_RADIUS / PARALLEL
    return fix
