"""Simulated logs of a sensor that is turned and shaken, with a known attitude: rigid-body exact, random from a seed.

    log = simulate(MargScenario(motion="walk", seed=3))
    log.samples   what the device records
    log.q_ns      what nobody tells the filter

The pose is a smooth function of time, a sum of sinusoids per angle and per direction; specific force and angular rate
follow from it. A gyroscope reading is the mean rate since the sample before, as the digital filter of a chip gives it,
so that integrating what is read gives the same attitude back.
"""

from dataclasses import dataclass
from math import cos, pi, radians, sin
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core import quaternion
from core.samples import Samples
from core.simulation_motion import GRAVITY

Floats = NDArray[np.float64]

STILL = 4.0
"""s at the start before it is taken up"""
TAKE_UP = 2.0
"""s from stillness to full motion"""
DIFFERENCE = 1e-3
"""s of the central difference that gives the acceleration of the exact path"""
WAVES = 7
"""sinusoids per angle and per direction"""
FIELD_STRENGTH, DIP = 48.0, radians(62.0)
"""uT, of northern Italy; rad below the horizontal"""
SEA_LEVEL_PRESSURE, GROUND = 101325.0, 100.0
"""Pa; m above the sea where the log begins"""


class Wander(NamedTuple):
    """A smooth random signal."""

    rms: float
    """m or rad"""
    band: tuple[float, float]
    """Hz"""


class Kind(NamedTuple):
    """How the sensor is moved."""

    yaw: Wander
    tilt: Wander
    """of roll and of pitch"""
    travel: Wander
    """m, horizontal"""
    shake: Wander
    """m, every direction"""
    step: float
    """m, amplitude up and down at the frequency of steps"""


NOTHING = Wander(0.0, (0.1, 0.2))
STEP_FREQUENCY = 1.9
"""Hz"""
KINDS = {
    "rest": Kind(NOTHING, NOTHING, NOTHING, NOTHING, 0.0),
    "level": Kind(
        Wander(1.0, (0.02, 0.12)), Wander(0.06, (0.1, 0.7)), Wander(3.0, (0.02, 0.08)), Wander(0.01, (1.0, 3.0)), 0.0
    ),
    "walk": Kind(
        Wander(1.0, (0.02, 0.15)), Wander(0.15, (0.1, 1.0)), Wander(3.0, (0.02, 0.08)), Wander(0.01, (1.0, 3.0)), 0.01
    ),
    "brisk": Kind(
        Wander(1.5, (0.05, 0.3)), Wander(0.6, (0.1, 0.5)), Wander(2.0, (0.03, 0.1)), Wander(0.04, (0.5, 1.5)), 0.01
    ),
    "violent": Kind(
        Wander(1.2, (0.1, 0.6)), Wander(0.7, (0.2, 0.8)), Wander(1.0, (0.05, 0.2)), Wander(0.1, (0.5, 2.0)), 0.0
    ),
}
"""From lying still over a vehicle or a walking person to a sensor swung about at several hundred deg/s."""


@dataclass(frozen=True)
class MargScenario:
    """What to simulate."""

    motion: str = "walk"
    """one of `KINDS`"""
    seconds: float = 120.0
    seed: int = 0
    rate: float = 100.0
    """Hz"""
    magnetometer: bool = True
    disturbed: bool = False
    """magnetic fields of iron and magnets come and go"""
    gyro_bias: float = radians(0.5)
    """rad/s on each axis, the signs from the seed"""
    gyro_noise: float = radians(0.01)
    """rad/s per sqrt(Hz)"""
    force_noise: float = 0.02
    """m/s2 per reading"""
    field_noise: float = 0.5
    """uT per reading"""
    pressure_noise: float = 3.0
    """Pa per reading"""
    arm: float = 0.15
    """m from the point that travels to the sensor, along its x axis"""
    disturbance: tuple[float, float] = (15.0, 60.0)
    """uT, weakest and strongest"""


class MargLog(NamedTuple):
    """A simulated log and the truth."""

    samples: Samples
    q_ns: Floats
    """(N, 4)"""
    altitude: Floats
    """(N,) m above the sea"""
    gyro_bias: Floats
    """(3,) rad/s, of each axis"""
    disturbed: NDArray[np.bool_]
    """(N,) where the magnetic field is not the Earth's"""


class _Waves(NamedTuple):
    amplitude: Floats
    frequency: Floats
    phase: Floats

    @classmethod
    def draw(cls, wander: Wander, rng: np.random.Generator) -> "_Waves":
        amplitude = wander.rms * np.sqrt(2 / WAVES) * np.ones(WAVES)
        return cls(amplitude, rng.uniform(*wander.band, WAVES), rng.uniform(0, 2 * pi, WAVES))

    def at(self, t: Floats) -> Floats:
        sum_: Floats = np.sin(2 * pi * self.frequency * t[:, None] + self.phase) @ self.amplitude
        return sum_


class _Path(NamedTuple):
    """Pose as a function of time."""

    angles: tuple[_Waves, _Waves, _Waves]
    """roll, pitch, yaw"""
    travel: tuple[_Waves, ...]
    step: float
    arm: Floats
    """(3,) m, sensor axes"""

    def attitude(self, t: Floats) -> Floats:
        """(N, 4) q_ns."""
        time = _taken_up(t)
        x, y, z = (
            quaternion.from_rotation_vector(wave.at(time)[:, None] * axis)
            for wave, axis in zip(self.angles, np.eye(3), strict=True)
        )
        return quaternion.multiply(z, quaternion.multiply(y, x))

    def position(self, t: Floats) -> Floats:
        """(N, 3) m of the sensor, east, north, up."""
        time = _taken_up(t)
        p_n = np.stack([wave.at(time) for wave in self.travel[2:]], axis=-1)
        p_n[:, 0] += self.travel[0].at(time)
        p_n[:, 1] += self.travel[1].at(time)
        p_n[:, 2] += self.step * np.sin(2 * pi * STEP_FREQUENCY * time)
        return p_n + quaternion.rotate(self.attitude(t), self.arm)

    def acceleration(self, t: Floats) -> Floats:
        """(N, 3) m/s2, east, north, up."""
        before, now, after = (self.position(t + shift) for shift in (-DIFFERENCE, 0.0, DIFFERENCE))
        return (before - 2 * now + after) / DIFFERENCE**2


def _taken_up(t: Floats) -> Floats:
    """Time of the motion: it stands still at first, then goes over smoothly to the speed of time."""
    u = np.clip((t - STILL) / TAKE_UP, 0.0, 1.0)
    return TAKE_UP * (u**6 - 3 * u**5 + 2.5 * u**4) + np.maximum(t - STILL - TAKE_UP, 0.0)


def simulate(scenario: MargScenario) -> MargLog:
    """Simulate a log; the same scenario gives the same log."""
    rng = np.random.default_rng([scenario.seed, sorted(KINDS).index(scenario.motion)])
    path = _draw_path(KINDS[scenario.motion], scenario.arm, rng)
    t = np.arange(int(scenario.seconds * scenario.rate)) / scenario.rate
    q_ns = path.attitude(t)
    q_sn = quaternion.conjugate(q_ns)
    bias = scenario.gyro_bias * rng.choice([-1.0, 1.0], 3)
    f_s = quaternion.rotate(q_sn, path.acceleration(t) + np.array([0.0, 0.0, GRAVITY]))
    w_s = _mean_rate(path, t, 1 / scenario.rate) + bias
    m_n = np.tile(FIELD_STRENGTH * np.array([0.0, cos(DIP), -sin(DIP)]), (t.size, 1))
    added_n, added_s = _disturbances(scenario, t, rng) if scenario.disturbed else np.zeros((2, t.size, 3))
    m_s = quaternion.rotate(q_sn, m_n + added_n) + added_s
    altitude = GROUND + path.position(t)[:, 2]
    pressure = SEA_LEVEL_PRESSURE * (1 - altitude / 44330.77) ** (1 / 0.190263)
    samples = Samples.make(
        t,
        f_s + scenario.force_noise * rng.normal(size=f_s.shape),
        w_s + scenario.gyro_noise * np.sqrt(scenario.rate / 2) * rng.normal(size=w_s.shape),
        m_s=m_s + scenario.field_noise * rng.normal(size=m_s.shape) if scenario.magnetometer else None,
        pressure=pressure + scenario.pressure_noise * rng.normal(size=t.size),
    )
    return MargLog(samples, q_ns, altitude, bias, np.linalg.norm(added_n + added_s, axis=-1) > 0)


def _draw_path(kind: Kind, arm: float, rng: np.random.Generator) -> _Path:
    roll, pitch, yaw = (_Waves.draw(wander, rng) for wander in (kind.tilt, kind.tilt, kind.yaw))
    travel = tuple(_Waves.draw(wander, rng) for wander in [kind.travel] * 2 + [kind.shake] * 3)
    return _Path((roll, pitch, yaw), travel, kind.step, np.array([arm, 0.0, 0.0]))


def _mean_rate(path: _Path, t: Floats, step: float) -> Floats:
    turned = quaternion.multiply(quaternion.conjugate(path.attitude(t - step)), path.attitude(t))
    return quaternion.rotation_vector(turned) / step


def _disturbances(scenario: MargScenario, t: Floats, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Fields of things that stand about (local level axes) and of things that lie on the sensor, in turn."""
    added = np.zeros((2, t.size, 3))
    start, number = STILL + 12.0, 0
    while start < t[-1]:
        seconds, ramp = rng.uniform(4.0, 15.0), rng.uniform(0.3, 1.5)
        direction = rng.normal(size=3)
        field = rng.uniform(*scenario.disturbance) * direction / np.linalg.norm(direction)
        rise = np.clip(np.minimum(t - start, start + seconds - t) / ramp, 0.0, 1.0)
        added[number % 2] += (rise**2 * (3 - 2 * rise))[:, None] * field
        start += seconds + rng.uniform(8.0, 20.0)
        number += 1
    return added[0], added[1]
