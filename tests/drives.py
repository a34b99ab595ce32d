"""Simulated drives as a device would send them, made once per test run."""

from functools import cache

from api.formats.writer import write_native_csv
from core import quaternion
from core.samples import Samples
from core.simulation import Scenario, simulate

CHUNK_SECONDS = 30
RATE = 50.0
"""Hz; less than a real device, for speed"""
REMOUNT = (420.0, tuple(quaternion.from_angles(0.5, 0.3, 1.0).tolist()))


@cache
def drive(seconds: float = 300.0, seed: int = 1, remount: bool = False) -> Samples:
    """Town driving; confirmed after about 245 s, the change of `REMOUNT` after about 440 s, confirmed anew at 650 s."""
    scenario = Scenario(
        route="city",
        seconds=seconds,
        seed=seed,
        sensor="calibrated",
        imu_rate=RATE,
        remount=REMOUNT if remount else None,
    )
    return simulate(scenario).samples


@cache
def chunks(seconds: float = 300.0, seed: int = 1, remount: bool = False) -> tuple[bytes, ...]:
    """The same drive in pieces of `CHUNK_SECONDS` as native CSV."""
    samples = drive(seconds, seed, remount)
    step = int(CHUNK_SECONDS * RATE)
    return tuple(write_native_csv(samples.slice(i, i + step)) for i in range(0, len(samples), step))
