"""A drive that ends in a crash, as a device would send it, with its truth; made once per test run."""

from functools import cache
from typing import NamedTuple

import numpy as np

import core
from api.formats.writer import write_native_csv
from core import EventKind, Samples
from core.simulation import Drive, Scenario, simulate
from core.simulation_events import Crash, crash
from tests.drives import CHUNK_SECONDS

CRASH_AT = 195.0
"""s"""
RATE = 100.0
"""Hz"""


class Crashed(NamedTuple):
    """A drive in chunks, and its truth."""

    drive: Drive
    hit: Crash
    chunks: tuple[bytes, ...]
    confirmed: int
    """chunk in which the mounting is confirmed"""
    struck: int
    """chunk with the crash in its middle, the last but one"""


@cache
def crashed(seed: int = 2) -> Crashed:
    """Town driving until the mounting is confirmed; a minute later the vehicle is hit from the front left."""
    drive = simulate(Scenario("city", CRASH_AT + 70.0, seed, sensor="calibrated", imu_rate=RATE))
    hit = Crash(CRASH_AT, np.radians(38.0), 117.0, 0.09, ringing=0.1)
    samples = crash(drive, hit, np.random.default_rng(1))
    step, struck = int(CHUNK_SECONDS * RATE), int(CRASH_AT // CHUNK_SECONDS)
    pieces = (samples.slice(n * step, (n + 1) * step) for n in range(struck + 2))
    return Crashed(drive, hit, tuple(map(write_native_csv, pieces)), _confirmed(samples), struck)


def _confirmed(samples: Samples) -> int:
    state = core.begin_session(core.DEFAULT, core.initial_state(core.DEFAULT))
    found = core.advance(core.DEFAULT, state, samples)[1].events
    return next(int(event.t // CHUNK_SECONDS) for event in found if event.kind is EventKind.CONFIRMED)
