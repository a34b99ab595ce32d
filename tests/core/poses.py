"""Poses of a device and recordings of them, simulated."""

import numpy as np
from numpy.typing import NDArray

from core import AccelerometerCalibration, Samples
from core._kernel import GRAVITY

Floats = NDArray[np.float64]

UPRIGHT = np.vstack([np.eye(3), -np.eye(3)])
TILTED = np.array([[1, 1, 0], [1, 0, 1], [0, 1, 1]]) / np.sqrt(2)
NINE = np.vstack([UPRIGHT, TILTED])
"""(9, 3) the direction that is up, sensor axes: each axis up, each down, between each two"""


def directions(generator: np.random.Generator, count: int) -> Floats:
    """Unit vectors, uniform on the sphere."""
    drawn = generator.normal(size=(count, 3))
    return np.asarray(drawn / np.linalg.norm(drawn, axis=1, keepdims=True))


def random_calibration(generator: np.random.Generator) -> AccelerometerCalibration:
    """Errors as bad as cheap sensors have them."""
    cross = generator.uniform(-0.05, 0.05, (3, 3))
    gain = np.diag(generator.uniform(0.9, 1.1, 3)) + np.triu(cross, 1) + np.triu(cross, 1).T
    return AccelerometerCalibration(gain, generator.uniform(-1.0, 1.0, 3))


def readings(calibration: AccelerometerCalibration, up: Floats) -> Floats:
    """(P, 3) m/s2 read where `up` (P, 3) points up (thesis B.5)."""
    return np.asarray(GRAVITY * up @ calibration.gain.T + calibration.offset)


def recording(
    held: Floats, seconds: float = 3.0, rate: float = 50.0, noise: float = 0.02, moving: float = 1.0, seed: int = 0
) -> Samples:
    """A device that reads `held` (P, 3) one after the other, and is turned and shaken for `moving` s in between."""
    generator = np.random.default_rng(seed)
    still, shaken = int(seconds * rate), int(moving * rate)
    parts = []
    for before, after in zip(held, [*held[1:], held[-1]], strict=True):
        share = np.linspace(0, 1, shaken)[:, None]
        shake = 3.0 * generator.normal(size=(shaken, 3))
        parts += [np.tile(before, (still, 1)), before + share * (after - before) + shake]
    f_s = np.vstack(parts)
    return Samples.make(np.arange(len(f_s)) / rate, f_s + noise * generator.normal(size=f_s.shape))
