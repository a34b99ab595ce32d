"""What the sensors of a simulated drive make of the motion: vibration, accelerometer, gyroscope, GPS receiver."""

from math import radians, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.samples import FIX_COLUMNS
from core.simulation_motion import GRAVITY, Trajectory, band_noise, smooth_noise, turn

Floats = NDArray[np.float64]

VIBRATION_RATE = 200.0
"""Hz at which vibration is made; slower sensors alias it, as real ones do."""
BANDS = (((4.0, 8.0), 0.15, 0.30), ((10.0, 20.0), 0.25, 0.40))
"""Hz; m/s2 rms along x, y and along z at 15 m/s (thesis 4.6; the band of 1-3 Hz is part of the motion)"""
IDLE = ((22.0, 32.0), 0.05)
"""Hz; m/s2 rms of the running engine"""
ANGULAR = 0.03
"""rad/s of angular vibration per m/s2 of linear vibration"""

EARTH_RADIUS = 6.371e6
ORIGIN = np.radians([45.67, 12.41])
"""latitude and longitude where every drive starts"""
STANDSTILL = 0.5
"""m/s below which the receiver freezes its course"""


class SensorClass(NamedTuple):
    """Quality of an inertial sensor; 1 sigma per axis."""

    bias: float
    """m/s2"""
    scale: float
    noise: float
    """m/s2 per sqrt(Hz)"""
    step: float
    """m/s2 per count, 0 = fine"""
    gyro: bool
    gyro_bias: float
    """rad/s"""
    gyro_noise: float
    """rad/s per sqrt(Hz)"""


MILLI_G = 1e-3 * GRAVITY
SENSORS = {
    "tmd2": SensorClass(20 * MILLI_G, 0.005, 0.4 * MILLI_G, 10 * MILLI_G, False, radians(0.5), radians(0.02)),
    "mems": SensorClass(20 * MILLI_G, 0.005, 0.2 * MILLI_G, 0.0, True, radians(0.5), radians(0.01)),
    "calibrated": SensorClass(3 * MILLI_G, 0.001, 0.1 * MILLI_G, 0.0, True, radians(0.2), radians(0.005)),
}


class SensorErrors(NamedTuple):
    """Constant errors of one sensor, drawn once for a drive, sensor axes."""

    bias: Floats
    """(3,) m/s2"""
    scale: Floats
    """(3,)"""
    gyro_bias: Floats
    """(3,) rad/s"""

    @classmethod
    def draw(cls, sensor: SensorClass, rng: np.random.Generator) -> "SensorErrors":
        """Draw the errors of a sensor of this class."""
        bias, scale, gyro_bias = rng.normal(size=(3, 3))
        return cls(sensor.bias * bias, sensor.scale * scale, sensor.gyro_bias * gyro_bias)


def vibration(t: Floats, speed: Floats, roughness: float, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """(N, 3) m/s2 and (N, 3) rad/s of vibration at the times `t`, growing with the square root of the speed."""
    size = int((t[-1] - t[0]) * VIBRATION_RATE) + 2
    grid = t[0] + np.arange(size) / VIBRATION_RATE
    growth = roughness * np.sqrt(np.abs(speed) / 15.0)
    signals = []
    for axis in (0, 1, 2, 0, 1, 2):
        idle, running = band_noise(rng, size, IDLE[0], VIBRATION_RATE), np.zeros(size)
        for band, level, upright in BANDS:
            running += (upright if axis == 2 else level) * band_noise(rng, size, band, VIBRATION_RATE)
        signals.append(IDLE[1] * np.interp(t, grid, idle) + growth * np.interp(t, grid, running))
    return np.stack(signals[:3], axis=-1), ANGULAR * np.stack(signals[3:], axis=-1)


def accelerometer(
    f_s: Floats, rate: float, sensor: SensorClass, errors: SensorErrors, rng: np.random.Generator
) -> Floats:
    """Reading of the specific force: scale error, bias, white noise, then rounding to counts."""
    white = sensor.noise * sqrt(rate / 2) * rng.normal(size=f_s.shape)
    reading = (1 + errors.scale) * f_s + errors.bias + white
    return sensor.step * np.round(reading / sensor.step) if sensor.step else reading


def gyroscope(w_s: Floats, rate: float, sensor: SensorClass, errors: SensorErrors, rng: np.random.Generator) -> Floats:
    """Reading of the angular rate: bias and white noise."""
    return w_s + errors.gyro_bias + sensor.gyro_noise * sqrt(rate / 2) * rng.normal(size=w_s.shape)


class Receiver(NamedTuple):
    """How a GPS receiver errs."""

    speed_noise: float = 0.1
    """m/s per axis, white"""
    speed_drift: float = 0.1
    """m/s per axis, correlated over 3 s"""
    position_drift: float = 1.5
    """m per axis, correlated over a minute"""
    altitude_drift: float = 3.0
    """m, correlated over two minutes"""
    altitude_noise: float = 0.2
    """m, white"""
    vertical_speed: bool = False
    accuracy: bool = False

    def with_altitude_noise(self, factor: float) -> "Receiver":
        """Give a receiver whose altitude is so many times worse."""
        return self._replace(altitude_drift=factor * self.altitude_drift, altitude_noise=factor * self.altitude_noise)


def gps_fixes(trajectory: Trajectory, t: Floats, arm: Floats, receiver: Receiver, rng: np.random.Generator) -> Floats:
    """(M, 8) fixes that tell of the motion at the times `t` of an antenna at `arm` on the vehicle."""
    motion = trajectory.at(t)
    rate = (t.size - 1) / (t[-1] - t[0]) if t.size > 1 else 1.0
    noise = rng.normal(size=(t.size, 4))
    drift = np.stack([smooth_noise(rng, t.size, s * rate) for s in (2.0, 2.0, 2.0, 45.0, 45.0, 90.0)], axis=-1)
    v_n = motion.velocity(arm) + receiver.speed_noise * noise[:, :3] + receiver.speed_drift * drift[:, :3]
    scale = np.array([receiver.position_drift, receiver.position_drift, receiver.altitude_drift])
    p_n = trajectory.position(t) + turn(motion.r_nv(), arm) + scale * drift[:, 3:]
    speed = np.hypot(v_n[:, 0], v_n[:, 1])
    fix = np.full((t.size, len(FIX_COLUMNS)), np.nan)
    fix[:, 0] = ORIGIN[0] + p_n[:, 1] / EARTH_RADIUS
    fix[:, 1] = ORIGIN[1] + p_n[:, 0] / (EARTH_RADIUS * np.cos(ORIGIN[0]))
    fix[:, 2] = 20.0 + p_n[:, 2] + receiver.altitude_noise * noise[:, 3]
    fix[:, 3] = speed
    fix[:, 4] = _frozen(np.arctan2(v_n[:, 0], v_n[:, 1]) % (2 * np.pi), speed < STANDSTILL)
    if receiver.vertical_speed:
        fix[:, 5] = v_n[:, 2]
    if receiver.accuracy:
        fix[:, 6] = np.hypot(receiver.speed_noise, receiver.speed_drift)
        fix[:, 7] = np.minimum(fix[:, 6] / np.maximum(speed, 1e-3), np.pi)
    return fix


def _frozen(values: Floats, hold: NDArray[np.bool_]) -> Floats:
    """Repeat the last value that was not held."""
    last = np.maximum.accumulate(np.where(hold, 0, np.arange(values.size)))
    return values[last]
