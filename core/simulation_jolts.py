"""What must not be taken for a crash, laid over simulated drives: the road's, the doors', the hands', the fall.

Roads, doors and knocks add to the readings (`JOLTS`: what each reads, vehicle axes, at 200 Hz or any rate); a device
that falls or is taken in hand no longer moves with the vehicle (`fall`, `handle`).
"""

from collections.abc import Callable
from dataclasses import replace
from math import pi, radians

import numpy as np
from numpy.typing import NDArray

from core import quaternion
from core.samples import Samples

Floats = NDArray[np.float64]
Jolt = Callable[[float, np.random.Generator], Floats]
"""(rate Hz, generator) -> (N, 6) m/s2 and rad/s, vehicle axes"""


def _half_sine(t: Floats, start: float, duration: float) -> Floats:
    x = (t - start) / duration
    return np.where((x > 0) & (x < 1), np.sin(pi * np.clip(x, 0, 1)), 0.0)


def _ring(t: Floats, start: float, frequency: float, decay: float, rng: np.random.Generator) -> Floats:
    """Damped oscillation."""
    since = np.maximum(t - start, 0.0)
    return np.where(t > start, np.sin(2 * pi * frequency * since + rng.uniform(0, 0.5)) * np.exp(-since / decay), 0.0)


def _times(seconds: float, rate: float, rng: np.random.Generator) -> Floats:
    """Give times of samples, which know nothing of when the jolt begins."""
    return np.arange(int(seconds * rate)) / rate - rng.uniform(0, 1 / rate)


def pothole(rate: float, rng: np.random.Generator) -> Floats:
    """A wheel falls in and is stopped by the far edge; the rear wheel follows; the axle hops."""
    t = _times(1.2, rate, rng)
    total = np.zeros((t.size, 6))
    for start, share in ((0.05, 1.0), (0.05 + rng.uniform(0.1, 0.4), rng.uniform(0.3, 1))):
        peak, duration = share * rng.uniform(6, 45), rng.uniform(0.012, 0.05)
        total[:, 2] += peak * (_half_sine(t, start + duration, duration) - 0.6 * _half_sine(t, start, duration))
        total[:, 2] += 0.3 * peak * _ring(t, start + 2 * duration, rng.uniform(10, 15), 0.12, rng)
        total[:, 0] -= rng.uniform(0.1, 0.5) * peak * _half_sine(t, start + duration, rng.uniform(0.5, 1) * duration)
        total[:, 1] += rng.uniform(-0.3, 0.3) * peak * _half_sine(t, start + duration, duration)
        total[:, 3] += rng.uniform(-0.02, 0.02) * peak * _ring(t, start, 3.0, 0.2, rng)
    return total


def kerb(rate: float, rng: np.random.Generator) -> Floats:
    """A kerb is climbed at an angle: each wheel is lifted and pushed back, up to 0.5 m/s together."""
    t = _times(2.0, rate, rng)
    total, angle = np.zeros((t.size, 6)), rng.uniform(-radians(60), radians(60))
    for wheel in range(int(rng.integers(2, 5))):
        start, duration, peak = 0.05 + 0.35 * wheel + rng.uniform(0, 0.2), rng.uniform(0.02, 0.07), rng.uniform(8, 40)
        back = min(rng.uniform(0.2, 0.6) * peak, 0.4 * pi / 2 / duration)
        pulse = _half_sine(t, start, duration)
        total[:, 2] += peak * (pulse - 0.7 * _half_sine(t, start + duration, 1.3 * duration))
        total[:, 0] -= back * np.cos(angle) * pulse
        total[:, 1] -= back * np.sin(angle) * pulse
        total[:, 1] += 0.3 * peak * _ring(t, start + duration, rng.uniform(3, 12), 0.15, rng)
        total[:, 3] += rng.uniform(-0.03, 0.03) * peak * _ring(t, start, 2.0, 0.3, rng)
    return total


def hump(rate: float, rng: np.random.Generator) -> Floats:
    """A speed hump taken too fast: up, down, twice, and pitching."""
    t = _times(2.5, rate, rng)
    total, length, peak = np.zeros((t.size, 6)), rng.uniform(0.1, 0.4), rng.uniform(4, 16)
    for start in (0.1, 0.1 + rng.uniform(0.3, 1.0)):
        wave = _half_sine(t, start, length) - _half_sine(t, start + length, length)
        total[:, 2] += peak * wave + 0.2 * peak * _ring(t, start, 12.0, 0.15, rng)
        total[:, 0] -= rng.uniform(0.1, 0.35) * peak * wave
        total[:, 4] += rng.uniform(0.03, 0.08) * peak * wave
    return total


def door(rate: float, rng: np.random.Generator) -> Floats:
    """A door or the boot is slammed: the body rings, and hardly moves."""
    t = _times(0.6, rate, rng)
    way = rng.normal(size=3) * [0.5, 1.0, 0.7]
    peak, total = rng.uniform(3, 35), np.zeros((t.size, 6))
    for _ in range(3):
        frequency = rng.uniform(12, 60)
        wave = _ring(t, 0.02 + rng.uniform(0, 0.01), frequency, rng.uniform(1, 3) / frequency, rng)
        total[:, :3] += peak / 2 * wave[:, None] * (way / np.linalg.norm(way) + 0.3 * rng.normal(size=3))
    total[:, 3] += 0.01 * peak * _ring(t, 0.02, 4.0, 0.2, rng)
    return total


def knock(rate: float, rng: np.random.Generator) -> Floats:
    """A finger, a bag or a foot knocks at the device, which springs back on its mount."""
    t = _times(0.5, rate, rng)
    way, peak = rng.normal(size=3), np.exp(rng.uniform(np.log(10), np.log(400)))
    pulse = peak * _half_sine(t, 0.02, rng.uniform(0.001, 0.008))
    pulse -= rng.uniform(0.2, 0.6) * peak * _ring(t, 0.025, rng.uniform(25, 90), rng.uniform(0.01, 0.05), rng)
    total = np.zeros((t.size, 6))
    total[:, :3] = pulse[:, None] * way / np.linalg.norm(way)
    total[:, 3:] = 0.05 * pulse[:, None] * rng.normal(size=3)
    return total


def emergency_braking(rate: float, rng: np.random.Generator) -> Floats:
    """As hard as the tyres allow, with the jerk of the standstill at the end."""
    t = _times(5.0, rate, rng)
    peak, end = rng.uniform(6.5, 10.5), rng.uniform(1.0, 3.5)
    total = np.zeros((t.size, 6))
    total[:, 0] = -peak * np.clip(t / 0.25, 0, 1) * (t < end) + 0.35 * peak * _ring(t, end, 2.0, 0.35, rng)
    total[:, 0] += (t < end) * rng.uniform(0.5, 2) * np.sin(2 * pi * rng.uniform(8, 15) * t)  # anti-lock
    total[:, 4] = 0.1 * (_ring(t, 0.0, 1.4, 0.4, rng) - _ring(t, end, 1.4, 0.4, rng))
    return total


def rough_stretch(rate: float, rng: np.random.Generator) -> Floats:
    """Cobbles, a washboard or a forest track, for some seconds."""
    t = _times(rng.uniform(5, 30), rate, rng)
    level = rng.uniform(0.5, 4.0) * np.sqrt(_half_sine(t, 0, float(t[-1])))
    noise = rng.normal(size=(t.size, 6))
    for _ in range(2):  # low-pass near 20 Hz
        noise[1:] = 0.5 * (noise[1:] + noise[:-1])
    total = 1.6 * level[:, None] * noise * [0.6, 0.6, 1.2, 0.02, 0.02, 0.01]
    total[:, 2] += level * np.sin(2 * pi * rng.uniform(6, 14) * t)
    return total


def pressure_washer(rate: float, rng: np.random.Generator) -> Floats:
    """A jet of water drums on the body."""
    t = _times(rng.uniform(5, 30), rate, rng)
    total = np.zeros((t.size, 6))
    total[:, :3] = rng.uniform(0.5, 3) * rng.normal(size=(t.size, 3)) * np.abs(np.sin(rng.uniform(0.5, 2) * t))[:, None]
    return total


ON_THE_ROAD: dict[str, Jolt] = {
    "potholes": pothole,
    "kerbs": kerb,
    "speed humps": hump,
    "rough stretches": rough_stretch,
    "emergency brakings": emergency_braking,
    "knocks at the device": knock,
}
AT_REST: dict[str, Jolt] = {"door slams": door, "knocks at the device": knock, "pressure washers": pressure_washer}


def add(samples: Samples, q_vs: Floats, jolts: list[tuple[float, Floats]]) -> Samples:
    """Give samples with jolts (s, (N, 6)) on top."""
    f_s, w_s, r_vs = samples.f_s.copy(), samples.w_s.copy(), quaternion.matrix(q_vs)
    for t, jolt in jolts:
        first = int(np.searchsorted(samples.t, t))
        part = jolt[: len(samples) - first]
        f_s[first : first + len(part)] += part[:, :3] @ r_vs
        w_s[first : first + len(part)] += part[:, 3:] @ r_vs
    return replace(samples, f_s=f_s, w_s=w_s)


def fall(samples: Samples, t: float, rng: np.random.Generator) -> Samples:
    """Give samples of a device that comes off, falls to the floor, bounces, and lies there somehow."""
    rate = (len(samples) - 1) / float(samples.t[-1] - samples.t[0])
    sliding, falling = rng.uniform(0.05, 0.4), rng.uniform(0.15, 0.45)
    first = int(np.searchsorted(samples.t, t))
    since = samples.t[first:] - t
    spin = rng.normal(size=3) * rng.uniform(1, 6)
    turned = np.clip(since, 0, sliding + falling)[:, None] * spin * np.clip(since / sliding, 0, 1)[:, None]
    free = (since > sliding) & (since < sliding + falling)
    f_s, w_s = _turned(samples, first, turned, rate)
    f_s[first:][free] = 0.3 * rng.normal(size=(int(free.sum()), 3))
    hit = sliding + falling
    for bounce in range(int(rng.integers(1, 4))):
        way, peak = rng.normal(size=3), 0.4**bounce * rng.uniform(40, 400)
        pulse = _half_sine(since, hit, rng.uniform(0.002, 0.012)) * peak
        f_s[first:] += pulse[:, None] * way / np.linalg.norm(way)
        hit += rng.uniform(0.05, 0.25)
    return replace(samples, f_s=f_s, w_s=w_s)


def handle(samples: Samples, t: float, rng: np.random.Generator) -> Samples:
    """Give samples of a device that is pulled off, turned about in a hand, and clicked into its place again."""
    rate = (len(samples) - 1) / float(samples.t[-1] - samples.t[0])
    seconds, first = rng.uniform(2, 12), int(np.searchsorted(samples.t, t))
    since = samples.t[first:] - t
    x = np.clip(since / seconds, 0, 1)
    there = np.sin(pi * x)[:, None] * rng.normal(size=3) * rng.uniform(0.8, 2.5)
    f_s, w_s = _turned(samples, first, there, rate)
    inside = (x > 0) & (x < 1)
    way = rng.normal(size=3)
    pull = rng.uniform(5, 30) * _half_sine(since, 0, rng.uniform(0.04, 0.15))
    pull -= pull.max() * _half_sine(since, rng.uniform(0.1, 0.2), rng.uniform(0.05, 0.15))
    for frequency in rng.uniform(0.7, 4.0, 3):
        f_s[first:] += inside[:, None] * rng.uniform(0.5, 4) * np.sin(2 * pi * frequency * since)[:, None] * way
        way = rng.normal(size=3)
    f_s[first:] += (pull * inside)[:, None] * way / np.linalg.norm(way)
    click = _half_sine(since, seconds, rng.uniform(0.003, 0.01)) * rng.uniform(20, 150)
    f_s[first:] += click[:, None] * way / np.linalg.norm(way)
    return replace(samples, f_s=f_s, w_s=w_s)


def _turned(samples: Samples, first: int, turned: Floats, rate: float) -> tuple[Floats, Floats]:
    """Readings of a device turned by these rotation vectors (N, 3), sensor axes, from the sample `first` on."""
    f_s, w_s = samples.f_s.copy(), samples.w_s.copy()
    further = quaternion.matrix(quaternion.from_rotation_vector(turned))
    for values in (f_s, w_s):
        values[first:] = np.einsum("nij,ni->nj", further, values[first:])
    w_s[first:] += np.gradient(turned, 1 / rate, axis=0)
    return f_s, w_s
