"""Simulated drives as a device would send them, made once per test run.

How long a calibration takes is the estimator's matter: the drives are cut where it reports what the tests wait for.
"""

from functools import cache
from typing import NamedTuple

import core
from api.formats.writer import write_native_csv
from core import EventKind, Samples, quaternion
from core.simulation import Scenario, simulate

CHUNK_SECONDS = 30
RATE = 50.0
"""Hz; less than a real device, for speed"""
PLAIN_SECONDS = 420.0
REMOUNTED_SECONDS = 1200.0
REMOUNTED_AT = 450.0


class Story(NamedTuple):
    """A drive in chunks, and the chunks in which something happens."""

    samples: Samples
    chunks: tuple[bytes, ...]
    confirmed: int
    """chunk in which the mounting is confirmed"""
    moved: int
    """chunk in which it is seen that the device was moved"""
    confirmed_anew: int


@cache
def plain(seed: int = 2) -> Story:
    """Town driving until the mounting is confirmed, and two chunks more; eight at least."""
    samples = simulate(_scenario(seed, PLAIN_SECONDS)).samples
    confirmed = _chunks_of(samples, EventKind.CONFIRMED)[0]
    return _cut(samples, max(confirmed + 3, 8), confirmed, -1, -1)


@cache
def remounted(seed: int = 2) -> Story:
    """Town driving; then the device is turned, that is seen, and the new mounting is confirmed in the last chunk."""
    turned = quaternion.from_angles(0.5, 0.3, 1.0)
    samples = simulate(_scenario(seed, REMOUNTED_SECONDS, (REMOUNTED_AT, turned))).samples
    confirmed, anew = _chunks_of(samples, EventKind.CONFIRMED)[:2]
    moved = _chunks_of(samples, EventKind.ORIENTATION_CHANGED)[0]
    return _cut(samples, anew + 1, confirmed, moved, anew)


def _scenario(seed: int, seconds: float, remount: tuple[float, object] | None = None) -> Scenario:
    return Scenario("city", seconds, seed, sensor="calibrated", imu_rate=RATE, remount=remount)  # type: ignore[arg-type]


def _chunks_of(samples: Samples, kind: EventKind) -> list[int]:
    state = core.begin_session(core.DEFAULT, core.initial_state(core.DEFAULT))
    found = core.advance(core.DEFAULT, state, samples)[1].events
    return [int(event.t // CHUNK_SECONDS) for event in found if event.kind == kind]


def _cut(samples: Samples, count: int, confirmed: int, moved: int, anew: int) -> Story:
    step = int(CHUNK_SECONDS * RATE)
    samples = samples.slice(0, min(count * step, len(samples)))
    pieces = (samples.slice(start, start + step) for start in range(0, len(samples), step))
    return Story(samples, tuple(write_native_csv(piece) for piece in pieces), confirmed, moved, anew)


def chunks(seed: int = 2) -> tuple[bytes, ...]:
    """The chunks of `plain`."""
    return plain(seed).chunks
