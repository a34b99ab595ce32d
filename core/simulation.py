"""Simulated drives with a known mounting: rigid-body exact, random from a seed, no clock and no files.

    drive = simulate(Scenario(route="city", seconds=600, seed=3))
    drive.samples   what the device records
    drive.truth     what nobody tells the estimator

The GPS antenna sits in the device unless the scenario says otherwise: the receiver's speed and course are those of the
device's place, not of the vehicle's turning point.
"""

from dataclasses import asdict, dataclass, field, fields, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core import quaternion
from core.samples import Samples
from core.simulation_faults import Disturbances, disturb
from core.simulation_motion import MARGIN, Motion, Trajectory, turn_back
from core.simulation_routes import ROUTES, plan_route
from core.simulation_sensors import (
    SENSORS,
    Receiver,
    SensorErrors,
    accelerometer,
    gps_fixes,
    gyroscope,
    vibration,
)

Floats = NDArray[np.float64]

REMOUNT_SECONDS = 1.0
"""s it takes to turn the device into another mounting"""


@dataclass(frozen=True, eq=False)
class Scenario:
    """What to simulate. Rotations are quaternions q_vs, places are m from the turning point in vehicle axes."""

    route: str = "city"
    """city, hills, straight, motorway, parked, roundabout, curves, constant, steep, crawl, harsh, towed, ferry"""
    seconds: float = 600.0
    seed: int = 0
    mount: ArrayLike | None = None
    """(4,) q_vs; None = any orientation, from the seed"""
    sensor: str = "mems"
    """tmd2, mems, calibrated"""
    gyro: bool | None = None
    """None = as the sensor has it"""
    imu_rate: float = 200.0
    """Hz"""
    gps_rate: float = 4.0
    """Hz"""
    latency: float | None = None
    """s between the moment a fix tells of and its arrival; None = 0 to 0.5 s, from the seed"""
    lever_arm: ArrayLike | None = None
    """(3,) m, place of the device; None = somewhere in the front of the cabin, from the seed"""
    antenna_arm: ArrayLike | None = None
    """(3,) m, place of the GPS antenna; None = in the device"""
    remount: tuple[float, ArrayLike] | None = None
    """(s, q_vs) when the device is turned, and into which mounting"""
    outages: tuple[tuple[float, float], ...] = ()
    """(start, end) s without a fix"""
    reverse: bool = False
    """back out of a parking space first, and reverse again every few minutes"""
    relief: float = 1.0
    """1 = the usual grades and banks of the route, 0 = a flat road"""
    vibration: float = 1.0
    """1 = an ordinary car, 0 = a perfectly smooth ride"""
    jitter: float = 0.0
    """s, 1 sigma of the sampling times about their raster"""
    vertical_speed: bool = False
    """the receiver gives the vertical speed"""
    accuracy: bool = False
    """the receiver states its accuracy"""
    ideal: bool = False
    """sensors and receiver without any error (latency and vibration stay)"""
    disturbances: Disturbances = field(default_factory=Disturbances)
    """what goes wrong with the recording"""
    session: int = 0
    """number of the drive: the seed chooses the device and its mounting, both together what is driven"""


@dataclass(frozen=True, eq=False)
class Truth:
    """What is true of a simulated drive; arrays at the arrival times of the M fixes."""

    scenario: Scenario
    q_vs: Floats
    """(4,) mounting at the start"""
    remounted: tuple[float, Floats] | None
    """(s, q_vs) time and mounting after the device was turned"""
    bias: Floats
    """(3,) m/s2, sensor axes"""
    scale: Floats
    """(3,) scale error of the accelerometer"""
    gyro_bias: Floats
    """(3,) rad/s, sensor axes"""
    lever_arm: Floats
    """(3,) m"""
    antenna_arm: Floats
    """(3,) m"""
    latency: float
    """s"""
    t: Floats
    """(M,) s"""
    q_nv: Floats
    """(M, 4) attitude of the vehicle at `t`"""
    v_n: Floats
    """(M, 3) m/s, velocity of the turning point at `t`, east, north, up"""
    speed: Floats
    """(M,) m/s along the road at `t`, negative when reversing"""

    def mount_at(self, t: float) -> Floats:
        """Give q_vs at a time (after a remount: as soon as it begins)."""
        return self.remounted[1] if self.remounted and t >= self.remounted[0] else self.q_vs

    def as_dict(self) -> dict[str, Any]:
        """Give the numbers for JSON: SI units, radians, no arrays over time."""
        remounted = {"t": self.remounted[0], "q_vs": self.remounted[1].tolist()} if self.remounted else None
        names = ("q_vs", "bias", "scale", "gyro_bias", "lever_arm", "antenna_arm")
        numbers = {name: getattr(self, name).tolist() for name in names}
        scenario = {f.name: _plain(getattr(self.scenario, f.name)) for f in fields(Scenario)}
        return {**numbers, "remounted": remounted, "latency": self.latency, "scenario": scenario}


class Drive(NamedTuple):
    """A simulated drive."""

    samples: Samples
    truth: Truth


def simulate(scenario: Scenario) -> Drive:
    """Simulate a drive.

    Raises
    ------
    ValueError
        unknown route or sensor, a rate or duration that is not positive.
    """
    _check(scenario)
    chosen = _generators(scenario.seed, 0)[0]
    _, routing, riding, sensing, receiving, failing = _generators(scenario.seed, scenario.session)
    truth_of = _choose(scenario, chosen)
    plan = plan_route(scenario.route, scenario.seconds + MARGIN, scenario.reverse, routing)
    road = ROUTES[scenario.route].road.scaled(scenario.relief, scenario.vibration)
    trajectory = Trajectory.of(plan, road, scenario.seconds, riding)
    t = _sampling_times(scenario, sensing)
    f_s, w_s = _readings(scenario, truth_of, trajectory, t, riding, sensing)
    rows, reported = _fix_rows(scenario, t)
    fix, valid = _fixes(scenario, truth_of, trajectory, reported, receiving)
    samples = disturb(Samples.make(t, f_s, w_s, rows, valid, fix), scenario.disturbances, failing)
    there = trajectory.at(t[rows])
    truth = Truth(scenario, *truth_of, samples.t[samples.fix_row], _attitude(there), there.v_n, there.speed)
    return Drive(samples, truth)


def simulate_sessions(scenario: Scenario, count: int) -> list[Drive]:
    """Simulate drives between which the device is switched off: one mounting, each with a clock of its own."""
    return [simulate(replace(scenario, session=number)) for number in range(count)]


def _generators(seed: int, session: int) -> list[np.random.Generator]:
    """Choosing, routing, riding, sensing, receiving, failing."""
    source = np.random.SeedSequence([seed, session] if session else seed)
    return [np.random.default_rng(s) for s in source.spawn(6)]


class _Chosen(NamedTuple):
    """The first fields of `Truth` after the scenario."""

    q_vs: Floats
    remounted: tuple[float, Floats] | None
    bias: Floats
    scale: Floats
    gyro_bias: Floats
    lever_arm: Floats
    antenna_arm: Floats
    latency: float


def _check(scenario: Scenario) -> None:
    if scenario.sensor not in SENSORS:
        raise ValueError(f"no sensor {scenario.sensor!r}; there are {', '.join(SENSORS)}")
    for name in ("seconds", "imu_rate", "gps_rate"):
        if not getattr(scenario, name) > 0:
            raise ValueError(f"{name} must be positive, not {getattr(scenario, name)}")


def _choose(scenario: Scenario, rng: np.random.Generator) -> _Chosen:
    """Draw what the scenario leaves open; each draw is made always, so that setting one changes no other."""
    mount = quaternion.random(rng)
    arm = rng.uniform([0.5, -0.5, 0.1], [1.5, 0.5, 0.5])
    latency = float(rng.uniform(0.0, 0.5))
    errors = SensorErrors.draw(SENSORS[scenario.sensor], rng)
    if scenario.ideal:
        errors = SensorErrors(np.zeros(3), np.zeros(3), np.zeros(3))
    arm = _given(scenario.lever_arm, arm)
    return _Chosen(
        quaternion.normalise(_given(scenario.mount, mount)),
        (scenario.remount[0], quaternion.normalise(scenario.remount[1])) if scenario.remount else None,
        *errors,
        arm,
        _given(scenario.antenna_arm, arm),
        latency if scenario.latency is None else scenario.latency,
    )


def _given(value: ArrayLike | None, otherwise: Floats) -> Floats:
    return otherwise if value is None else np.asarray(value, np.float64)


def _sampling_times(scenario: Scenario, rng: np.random.Generator) -> Floats:
    """Raster with jitter, never closer than a tenth of the raster."""
    step = 1 / scenario.imu_rate
    jitter = np.clip(scenario.jitter * rng.normal(size=int(scenario.seconds / step)), -0.45 * step, 0.45 * step)
    return np.maximum(np.arange(jitter.size) * step + jitter, 0.0)


def _fix_rows(scenario: Scenario, t: Floats) -> tuple[NDArray[np.int64], Floats]:
    """Give the sample each fix arrives with, and the time on the receiver's raster it was sent at."""
    raster = np.arange(1 / scenario.gps_rate, t[-1], 1 / scenario.gps_rate)
    rows, first = np.unique(np.searchsorted(t, raster - 1e-6), return_index=True)
    return rows, raster[first]


def _readings(
    scenario: Scenario,
    chosen: _Chosen,
    trajectory: Trajectory,
    t: Floats,
    riding: np.random.Generator,
    sensing: np.random.Generator,
) -> tuple[Floats, Floats | None]:
    """Accelerometer and gyroscope in sensor axes."""
    motion = trajectory.at(t)
    f_v, w_v = motion.specific_force(chosen.lever_arm), motion.w_v
    shaking, rattling = vibration(t, motion.speed, ROUTES[scenario.route].road.roughness, riding)
    f_v, w_v = f_v + scenario.vibration * shaking, w_v + scenario.vibration * rattling
    q_vs, turning = _mounting(chosen, t)
    r_vs = quaternion.matrix(q_vs)
    f_s, w_s = turn_back(r_vs, f_v), turn_back(r_vs, w_v + turning)
    sensor = SENSORS[scenario.sensor]
    gyro = sensor.gyro if scenario.gyro is None else scenario.gyro
    if scenario.ideal:
        return f_s, w_s if gyro else None
    errors = SensorErrors(chosen.bias, chosen.scale, chosen.gyro_bias)
    f_s = accelerometer(f_s, scenario.imu_rate, sensor, errors, sensing)
    return f_s, gyroscope(w_s, scenario.imu_rate, sensor, errors, sensing) if gyro else None


def _mounting(chosen: _Chosen, t: Floats) -> tuple[Floats, Floats]:
    """q_vs, (4,) or (N, 4), and the rate at which the device turns in the vehicle, vehicle axes, (3,) or (N, 3)."""
    if chosen.remounted is None:
        return chosen.q_vs, np.zeros(3)
    start, after = chosen.remounted
    turn = quaternion.rotation_vector(quaternion.multiply(after, quaternion.conjugate(chosen.q_vs)))
    x = np.clip((t - start) / REMOUNT_SECONDS, 0.0, 1.0)[:, None]
    share, rate = x**3 * (10 - 15 * x + 6 * x**2), 30 * x**2 * (1 - x) ** 2 / REMOUNT_SECONDS
    return quaternion.multiply(quaternion.from_rotation_vector(share * turn), chosen.q_vs), rate * turn


def _fixes(
    scenario: Scenario, chosen: _Chosen, trajectory: Trajectory, reported: Floats, rng: np.random.Generator
) -> tuple[Floats, NDArray[np.bool_]]:
    """Fixes reported at these times, and whether each is valid."""
    receiver = Receiver(vertical_speed=scenario.vertical_speed, accuracy=scenario.accuracy)
    if scenario.ideal:
        receiver = Receiver(0.0, 0.0, 0.0, 0.0, 0.0, scenario.vertical_speed, scenario.accuracy)
    receiver = receiver.with_altitude_noise(scenario.disturbances.altitude_noise)
    fix = gps_fixes(trajectory, reported - chosen.latency, chosen.antenna_arm, receiver, rng)
    lost = np.zeros(reported.size, np.bool_)
    for start, end in scenario.outages:
        lost |= (reported >= start) & (reported < end)
    return np.where(lost[:, None], np.nan, fix), ~lost


def _attitude(motion: Motion) -> Floats:
    """(M, 4) q_nv."""
    halves = (motion.yaw / 2, motion.pitch / 2, motion.roll / 2)
    z, y, x = (
        np.stack([np.cos(a), *(np.sin(a) * e for e in axis)], axis=-1)
        for a, axis in zip(halves, np.eye(3)[::-1], strict=True)
    )
    return quaternion.normalise(quaternion.multiply(z, quaternion.multiply(y, x)))


def _plain(value: Any) -> Any:
    """Arrays to lists, for JSON."""
    if isinstance(value, Disturbances):
        return asdict(value)
    if isinstance(value, tuple | list):
        return [_plain(v) for v in value]
    return value.tolist() if isinstance(value, np.ndarray) else value
