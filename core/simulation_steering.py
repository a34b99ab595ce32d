"""Simulated drives with a second device on the steering wheel, each recording on a clock of its own.

The wheel turns about a column that is inclined in the vehicle; the device sits beside the hub, so that it feels the
turning itself. The drive begins at a standstill in which the driver turns the wheel to both sides (seed 004, phase F2).
"""

from dataclasses import dataclass, replace
from math import pi, radians
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from core import quaternion
from core.samples import Samples
from core.simulation_motion import MARGIN, STEP, Motion, Trajectory, smooth_noise, turn_back
from core.simulation_routes import ROUTES, Itinerary, sample_route
from core.simulation_sensors import SENSORS, Receiver, SensorErrors, accelerometer, gps_fixes, gyroscope, vibration

Floats = NDArray[np.float64]

WHEELBASE = 2.7
"""m"""
CHARACTERISTIC_SPEED = 25.0
"""m/s at which twice the steering is needed that the bend asks for at walking pace"""
HUB = np.array([1.7, 0.37, 0.55])
"""m from the turning point, vehicle axes"""
CAR_DEVICE = np.array([2.0, 0.0, 0.5])
"""m from the turning point, vehicle axes"""
GYRO_GAIN = 0.005
"""1 sigma of the errors of gain of a gyroscope, and in rad of its axes' against those of the accelerometer"""
OWN_VIBRATION = 0.3
"""share of the vibration that the wheel adds of its own"""


@dataclass(frozen=True)
class SteeringScenario:
    """What to simulate; what is None comes from the seed."""

    route: str = "city"
    seconds: float = 300.0
    seed: int = 0
    sensor: str = "mems"
    rate: float = 100.0
    """Hz of the device in the vehicle"""
    wheel_rate: float = 104.0
    """Hz of the device on the wheel"""
    inclination: float | None = None
    """rad of the column above the plan; pi/2: the wheel lies flat, as in a bus"""
    ratio: float = 15.0
    """angle of the wheel by that of the road wheels"""
    parked_turns: float = radians(150.0)
    """rad the wheel is turned to either side at the standstill; 0 = not"""
    clock_offset: float | None = None
    """s on the vehicle device's clock when the clock of the wheel's device shows zero"""
    clock_skew: float | None = None
    """share by which the clock of the wheel's device is slow"""


class SteeringDrive(NamedTuple):
    """A drive as both devices record it, and what is true of it."""

    car: Samples
    wheel: Samples
    t: Floats
    """(N,) s on the vehicle device's clock"""
    angle: Floats
    """(N,) rad at the wheel, positive to the left"""
    axis_w: Floats
    """(3,) unit vector of the column in the axes of the device on the wheel, towards the driver"""
    q_cw: Floats
    """(4,) attitude of the device on the wheel to that in the vehicle, the wheel straight"""
    clock_offset: float
    clock_skew: float


class _Column(NamedTuple):
    axis_v: Floats
    q_vw: Floats
    """wheel straight"""
    arm_v: Floats
    """m from the hub to the device, the wheel straight"""
    angle: CubicSpline


def simulate_steering(scenario: SteeringScenario) -> SteeringDrive:
    """Simulate a drive whose steering wheel carries a second device."""
    choosing, routing, riding, sensing, receiving = (
        np.random.default_rng(s) for s in np.random.SeedSequence([scenario.seed, 4]).spawn(5)
    )
    scenario = _settled(scenario, choosing)
    plan = _plan(scenario, routing)
    trajectory = Trajectory.of(plan, ROUTES[scenario.route].road, scenario.seconds, riding)
    column = _column(scenario, plan, choosing)
    q_vc = quaternion.random(choosing)
    t = np.arange(0.0, scenario.seconds, 1 / scenario.rate)
    shaking = vibration(t, trajectory.at(t).speed, ROUTES[scenario.route].road.roughness, riding)
    car = _car_samples(scenario, trajectory, q_vc, t, shaking, (sensing, receiving))
    offset, skew = float(scenario.clock_offset or 0.0), float(scenario.clock_skew or 0.0)
    wheel = _wheel_samples(scenario, trajectory, column, (t, *shaking), riding, sensing)
    return SteeringDrive(
        car,
        replace(wheel, t=(wheel.t - offset) / (1 + skew)),
        t,
        column.angle(t),
        quaternion.rotate(quaternion.conjugate(column.q_vw), column.axis_v),
        quaternion.normalise(quaternion.multiply(quaternion.conjugate(q_vc), column.q_vw)),
        offset,
        skew,
    )


def _settled(scenario: SteeringScenario, rng: np.random.Generator) -> SteeringScenario:
    """Draw what the scenario leaves open; each draw is made always."""
    inclination, offset, skew = rng.uniform([radians(18.0), -20.0, -4e-5], [radians(40.0), 20.0, 4e-5]).tolist()
    return replace(
        scenario,
        inclination=inclination if scenario.inclination is None else scenario.inclination,
        clock_offset=offset if scenario.clock_offset is None else scenario.clock_offset,
        clock_skew=skew if scenario.clock_skew is None else scenario.clock_skew,
    )


def _plan(scenario: SteeringScenario, rng: np.random.Generator) -> Itinerary:
    plan = Itinerary(rng)
    plan.hold(30.0)
    while plan.t < scenario.seconds + MARGIN:
        ROUTES[scenario.route].stretch(plan)
    return plan


def _column(scenario: SteeringScenario, plan: Itinerary, rng: np.random.Generator) -> _Column:
    incline, aside = float(scenario.inclination or 0.0), rng.normal(0.0, radians(1.5))
    axis_v = np.array([-np.cos(incline) * np.cos(aside), np.sin(aside) * np.cos(incline), np.sin(incline)])
    in_plane = np.cross(axis_v, rng.normal(size=3))
    arm_v = rng.uniform(0.03, 0.12) * in_plane / np.linalg.norm(in_plane)
    return _Column(axis_v, quaternion.random(rng), arm_v, _steering(scenario, plan, rng))


def _steering(scenario: SteeringScenario, plan: Itinerary, rng: np.random.Generator) -> CubicSpline:
    """Angle of the wheel over time: turned at the standstill, then as the bends need it, never quite quiet."""
    t = np.arange(-MARGIN, scenario.seconds + MARGIN, STEP)
    speed, curvature = sample_route(plan, t)
    window = np.hanning(int(1.6 / STEP) | 1)
    bend = np.convolve(curvature, window / window.sum(), mode="same")
    angle = scenario.ratio * np.arctan(WHEELBASE * bend) * (1 + (speed / CHARACTERISTIC_SPEED) ** 2)
    angle += radians(1.0) * smooth_noise(rng, t.size, 1.0 / STEP) * np.clip(speed / 3.0, 0.0, 1.0)
    turning = np.clip((t - 5.0) / 14.0, 0.0, 1.0)
    # two sine periods whose rate fades in and out, and a wheel that is not quite straight while it is parked
    fade = np.clip(np.minimum(turning, 1 - turning) * 8, 0.0, 1.0)
    parked = rng.uniform(-0.4, 0.4) * np.clip((27.0 - t) / 4.0, 0.0, 1.0)
    return CubicSpline(t, angle + scenario.parked_turns * np.sin(4 * pi * turning) * fade**2 * (3 - 2 * fade) + parked)


def _car_samples(
    scenario: SteeringScenario,
    trajectory: Trajectory,
    q_vc: Floats,
    t: Floats,
    shaking: tuple[Floats, Floats],
    rngs: tuple[np.random.Generator, np.random.Generator],
) -> Samples:
    motion, sensor = trajectory.at(t), SENSORS[scenario.sensor]
    errors, r_vc = SensorErrors.draw(sensor, rngs[0]), quaternion.matrix(q_vc)
    f_c = turn_back(r_vc, motion.specific_force(CAR_DEVICE) + shaking[0])
    w_c = turn_back(r_vc, motion.w_v + shaking[1])
    raster = np.arange(1.0, t[-1], 1.0)
    fix = gps_fixes(trajectory, raster - 0.2, CAR_DEVICE, Receiver(), rngs[1])
    return Samples.make(
        t,
        accelerometer(f_c, scenario.rate, sensor, errors, rngs[0]),
        gyroscope(_skewed(w_c, rngs[0]), scenario.rate, sensor, errors, rngs[0]),
        np.searchsorted(t, raster),
        np.ones(raster.size, np.bool_),
        fix,
    )


def _wheel_samples(
    scenario: SteeringScenario,
    trajectory: Trajectory,
    column: _Column,
    shaking: tuple[Floats, Floats, Floats],
    riding: np.random.Generator,
    sensing: np.random.Generator,
) -> Samples:
    """Readings of the device on the wheel; its times are those of the vehicle's device, beyond whose ends it looks."""
    t = np.arange(1.0, scenario.seconds - 1.5, 1 / scenario.wheel_rate)
    motion, sensor = trajectory.at(t), SENSORS[scenario.sensor]
    common = [np.stack([np.interp(t, shaking[0], x) for x in signal.T], axis=-1) for signal in shaking[1:]]
    own = vibration(t, motion.speed, ROUTES[scenario.route].road.roughness, riding)
    f_v, w_v = _on_wheel(motion, column, t)
    q_vw = quaternion.multiply(_turned(column, t), column.q_vw)
    r_vw, errors = quaternion.matrix(q_vw), SensorErrors.draw(sensor, sensing)
    f_w = turn_back(r_vw, f_v + common[0] + OWN_VIBRATION * own[0])
    w_w = turn_back(r_vw, w_v + common[1] + OWN_VIBRATION * own[1])
    return Samples.make(
        t,
        accelerometer(f_w, scenario.wheel_rate, sensor, errors, sensing),
        gyroscope(_skewed(w_w, sensing), scenario.wheel_rate, sensor, errors, sensing),
    )


def _on_wheel(motion: Motion, column: _Column, t: Floats) -> tuple[Floats, Floats]:
    """(N, 3) specific force and (N, 3) angular rate of the device on the wheel, vehicle axes, rigid-body exact."""
    rate, acceleration = (column.angle(t, k)[:, None] * column.axis_v for k in (1, 2))
    w_v = motion.w_v + rate
    dw_v = motion.dw_v + acceleration + np.cross(motion.w_v, rate)
    arm_v = quaternion.rotate(_turned(column, t), column.arm_v)
    f_v = motion.specific_force(HUB) + np.cross(dw_v, arm_v) + np.cross(w_v, np.cross(w_v, arm_v))
    return f_v, w_v


def _turned(column: _Column, t: Floats) -> Floats:
    """(N, 4) turn of the wheel from straight, vehicle axes."""
    return quaternion.from_rotation_vector(column.angle(t)[:, None] * column.axis_v)


def _skewed(w: Floats, rng: np.random.Generator) -> Floats:
    """Give rates with errors of gain and of the axes' directions."""
    skewed: Floats = w @ (np.eye(3) + GYRO_GAIN * rng.normal(size=(3, 3)))
    return skewed
