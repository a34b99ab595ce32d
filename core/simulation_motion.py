"""Motion of a simulated vehicle: attitude and velocity as smooth functions of time, with exact derivatives.

Attitude R_nv = Rz(yaw) Ry(pitch) Rx(roll) and the velocity of the turning point (middle of the rear axle) are quintic
splines; body rates, accelerations and specific force follow from them by differentiation, so that strapdown
integration of what the sensors read gives the same motion back. The Earth does not turn here.
"""

from math import pi, radians, sqrt
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline, CubicSpline, make_interp_spline
from scipy.ndimage import gaussian_filter1d
from scipy.signal import butter, sosfilt

from core.simulation_routes import Itinerary, Road, sample_route

Floats = NDArray[np.float64]

GRAVITY = 9.80665
STEP = 0.05
"""s between the knots of the splines"""
MARGIN = 5.0
"""s known before the first and after the last sample"""

PITCH_PER_ACCELERATION = radians(1.5) / 3.0
"""rad per m/s2: nose down when braking"""
ROLL_PER_ACCELERATION = radians(4.0) / GRAVITY
"""rad per m/s2: out of the curve"""
REAR_SLIP_PER_ACCELERATION = radians(2.0) / GRAVITY
"""rad per m/s2: the rear axle drifts outwards, the nose points into the curve"""
BODY_FREQUENCY = 1.4
"""Hz, natural frequency of the body on its springs"""
SWELL_PERIOD = (6.0, 12.0)
"""s, periods at which a ship rolls and pitches"""


def smooth_noise(rng: np.random.Generator, size: int, scale: float) -> Floats:
    """Give a smooth random series of unit variance, correlated over about `scale` steps."""
    pad = int(4 * scale) + 1
    white = rng.normal(size=size + 2 * pad)
    unit = sqrt(2 * scale * sqrt(pi))
    return gaussian_filter1d(white, scale)[pad : pad + size] * unit


def band_noise(rng: np.random.Generator, size: int, band: tuple[float, float], rate: float) -> Floats:
    """Give noise of unit variance between two frequencies, Hz, sampled at `rate`."""
    sos = butter(2, band, btype="bandpass", fs=rate, output="sos")
    gain = sqrt(2 * (band[1] - band[0]) / rate * 1.11)  # noise bandwidth of a second-order Butterworth band-pass
    warm_up = int(2 * rate)
    noise: Floats = sosfilt(sos, rng.normal(size=size + warm_up)) / gain
    return noise[warm_up:]


def turn(r: Floats, x: Floats) -> Floats:
    """Give R x for (..., 3, 3) and (..., 3)."""
    return np.squeeze(r @ x[..., None], axis=-1)


def turn_back(r: Floats, x: Floats) -> Floats:
    """Give R^T x for (..., 3, 3) and (..., 3)."""
    return np.squeeze(x[..., None, :] @ r, axis=-2)


class Motion(NamedTuple):
    """Motion at N moments; `_v` components along the vehicle's axes, `_n` east, north, up."""

    yaw: Floats
    """(N,) rad, anti-clockwise from east"""
    pitch: Floats
    """(N,) rad, nose down positive"""
    roll: Floats
    """(N,) rad, right side down positive"""
    v_n: Floats
    """(N, 3) m/s, velocity of the turning point"""
    a_n: Floats
    """(N, 3) m/s2"""
    w_v: Floats
    """(N, 3) rad/s"""
    dw_v: Floats
    """(N, 3) rad/s2"""
    speed: Floats
    """(N,) m/s along the road, negative when reversing"""

    def r_nv(self) -> Floats:
        """(N, 3, 3) attitude."""
        return _rotation(self.yaw, self.pitch, self.roll)

    def specific_force(self, arm: Floats) -> Floats:
        """(N, 3) m/s2 at a place `arm` (vehicle axes, from the turning point), vehicle axes."""
        f_v = turn_back(self.r_nv(), self.a_n + np.array([0.0, 0.0, GRAVITY]))
        return f_v + np.cross(self.dw_v, arm) + np.cross(self.w_v, np.cross(self.w_v, arm))

    def velocity(self, arm: Floats) -> Floats:
        """(N, 3) m/s of a place `arm` on the vehicle, east, north, up."""
        return self.v_n + turn(self.r_nv(), np.cross(self.w_v, arm))


class Trajectory(NamedTuple):
    """A drive as a function of time."""

    spline: BSpline
    """speed, path heading, path grade, heave velocity, yaw, pitch, roll"""
    position: BSpline
    """m east, north, up of the turning point"""

    @classmethod
    def of(cls, plan: Itinerary, road: Road, seconds: float, rng: np.random.Generator) -> Self:
        """Drive the planned route on a road."""
        t = np.arange(-MARGIN, seconds + MARGIN, STEP)
        speed, curvature = _driven(plan, t, road.unsteadiness, rng)
        along = np.cumsum(speed) * STEP
        heading = rng.uniform(-np.pi, np.pi) + np.cumsum(speed * curvature) * STEP
        heading += radians(0.4) * _over_distance(along, 40.0, rng)
        grade, bank = _road(along, road, rng)
        ahead, sideways = np.gradient(speed, STEP), speed * np.gradient(heading, STEP)
        bounce = road.roughness * np.sqrt(np.abs(speed) / 15.0) * _body_modes(t.size, rng)
        pitch = _suspension(-PITCH_PER_ACCELERATION * ahead) - grade + radians(0.15) * bounce[0]
        roll = _suspension(ROLL_PER_ACCELERATION * sideways) + bank + radians(0.2) * bounce[1]
        yaw = heading + REAR_SLIP_PER_ACCELERATION * sideways
        pitch -= road.lifted
        if road.swell:
            yaw += rng.uniform(-np.pi, np.pi)
            pitch += road.swell * _swell(t.size, rng)
            roll += road.swell * _swell(t.size, rng)
        signals = np.stack([speed, heading, grade, 0.04 * bounce[2], yaw, pitch, roll], axis=-1)
        v_n = _path_velocity(speed, heading, grade)
        return cls(make_interp_spline(t, signals, k=5), make_interp_spline(t, v_n, k=3).antiderivative())

    def at(self, t: Floats) -> Motion:
        """Give the motion at the times `t`."""
        value, rate, second = (self.spline(t, nu=k) for k in range(3))
        speed, heading, grade, heave, yaw, pitch, roll = value.T
        v_n = _path_velocity(speed, heading, grade)
        v_n[:, 2] += heave
        w_v, dw_v = _body_rates(pitch, roll, rate[:, 4:].T, second[:, 4:].T)
        return Motion(yaw, pitch, roll, v_n, _path_acceleration(value.T, rate.T), w_v, dw_v, speed)


def _driven(plan: Itinerary, t: Floats, unsteadiness: float, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Round the corners of the plan as a driver does; exactly still where the plan stands still."""
    speed, curvature = sample_route(plan, t)
    pedal = 1 + unsteadiness * smooth_noise(rng, t.size, 4.0 / STEP)
    return _rounded(speed, 1.8) * pedal, _rounded(curvature, 1.6)


def _rounded(values: Floats, seconds: float) -> Floats:
    window = np.hanning(int(seconds / STEP) | 1)
    return np.convolve(np.pad(values, window.size // 2, mode="edge"), window / window.sum(), mode="valid")


def _over_distance(along: Floats, scale: float, rng: np.random.Generator) -> Floats:
    """Smooth noise of unit variance over the distance driven: it stands still when the vehicle does."""
    step = scale / 5
    first = along.min() - 4 * step
    size = int((along.max() - first) / step) + 8
    return CubicSpline(first + step * np.arange(size), smooth_noise(rng, size, 5 / np.sqrt(2)))(along)


def _road(along: Floats, road: Road, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Grade and bank angle, rad."""
    slope = np.tanh(road.grade_rms / road.grade_limit * _over_distance(along, 150.0, rng))
    return np.arctan(road.grade_limit * slope), road.bank_rms * _over_distance(along, 80.0, rng)


def _suspension(static: Floats) -> Floats:
    """Second-order lag of the body behind the force on its springs, damping ratio 0.4."""
    pole = 2 * np.pi * BODY_FREQUENCY * STEP * (-0.4 + 1j * np.sqrt(1 - 0.4**2))
    a = np.real(np.poly([np.exp(pole), np.exp(np.conj(pole))]))
    return sosfilt(np.array([[a.sum(), 0.0, 0.0, *a]]), static)


def _swell(size: int, rng: np.random.Generator) -> Floats:
    """(N,) swinging of a ship, unit variance."""
    return band_noise(rng, size, (1 / SWELL_PERIOD[1], 1 / SWELL_PERIOD[0]), 1 / STEP)


def _body_modes(size: int, rng: np.random.Generator) -> Floats:
    """(3, N) pitching, rolling and heaving of the sprung mass, 1-3 Hz, unit variance."""
    return np.stack([band_noise(rng, size, (1.0, 3.0), 1 / STEP) for _ in range(3)])


def _path_velocity(speed: Floats, heading: Floats, grade: Floats) -> Floats:
    level = speed * np.cos(grade)
    return np.stack([level * np.cos(heading), level * np.sin(heading), speed * np.sin(grade)], axis=-1)


def _path_acceleration(value: Floats, rate: Floats) -> Floats:
    """Time derivative of `_path_velocity` plus heave."""
    speed, heading, grade = value[:3]
    d_speed, d_heading, d_grade, d_heave = rate[:4]
    level = speed * np.cos(grade)
    d_level = d_speed * np.cos(grade) - speed * np.sin(grade) * d_grade
    c, s = np.cos(heading), np.sin(heading)
    rise = d_speed * np.sin(grade) + speed * np.cos(grade) * d_grade + d_heave
    return np.stack([d_level * c - level * s * d_heading, d_level * s + level * c * d_heading, rise], axis=-1)


def _rotation(yaw: Floats, pitch: Floats, roll: Floats) -> Floats:
    """(N, 3, 3) Rz(yaw) Ry(pitch) Rx(roll)."""
    cy, sy, cp, sp, cr, sr = (f(a) for a in (yaw, pitch, roll) for f in (np.cos, np.sin))
    rows = [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def _body_rates(pitch: Floats, roll: Floats, rate: Floats, second: Floats) -> tuple[Floats, Floats]:
    """Angular rate and its derivative, vehicle axes, from the first and second derivatives of yaw, pitch, roll."""
    (y1, p1, r1), (y2, p2, r2) = rate, second
    cp, sp, cr, sr = np.cos(pitch), np.sin(pitch), np.cos(roll), np.sin(roll)
    turn, d_turn = y1 * cp, y2 * cp - y1 * p1 * sp
    w_v = np.stack([r1 - y1 * sp, p1 * cr + turn * sr, turn * cr - p1 * sr], axis=-1)
    dw_v = np.stack(
        [
            r2 - y2 * sp - y1 * p1 * cp,
            (p2 + turn * r1) * cr + (d_turn - p1 * r1) * sr,
            (d_turn - p1 * r1) * cr - (p2 + turn * r1) * sr,
        ],
        axis=-1,
    )
    return w_v, dw_v
