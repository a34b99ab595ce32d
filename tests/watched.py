"""Logs of devices with which something is wrong, and a way to send them at their time."""

from collections.abc import Iterable, Iterator
from dataclasses import replace
from itertools import pairwise

import numpy as np

import core
from api.formats.writer import write_native_csv
from core import Samples, quaternion
from core.simulation import Scenario, simulate
from tests.conftest import Clock
from tests.service import Api, Device, Json

MOUNT = quaternion.from_angles(0.1, 0.2, 0.3)


def drive(route: str, seconds: float, seed: int = 2, rate: float = 20.0, **options: object) -> Samples:
    """Simulate a drive; all drives have the same mounting."""
    scenario = Scenario(route, seconds, seed, MOUNT, "calibrated", imu_rate=rate, **options)  # type: ignore[arg-type]
    return simulate(scenario).samples


def wandering(samples: Samples, size: float, period: float) -> Samples:
    """Let the bias of the accelerometer's x axis wander (m/s2, s): no mounting passes a test with that."""
    f_s = samples.f_s.copy()
    f_s[:, 0] += size * np.sin(2 * np.pi * samples.t / period)
    return replace(samples, f_s=f_s)


def parked(start: float, seconds: float = 60.0, fix: bool = True, rate: float = 2.0) -> Samples:
    """Give a chunk of a vehicle that stands, its clock from `start` s."""
    t = start + np.arange(0.0, seconds, 1 / rate)
    f_s = np.tile([0.0, 0.0, 9.81], (t.size, 1)) + 0.01 * np.sin(np.arange(t.size))[:, None]
    rows = np.arange(0, t.size, int(rate))
    columns = np.full((rows.size, len(core.FIX_COLUMNS)), np.nan)
    if fix:
        columns[:, [core.FIX_COLUMNS.index(name) for name in ("speed", "course")]] = 0.0
    return Samples.make(t, f_s, None, rows, np.full(rows.size, fix), columns)


def pieces(samples: Samples, seconds: float = 60.0) -> Iterator[Samples]:
    """Cut a log."""
    bounds = np.searchsorted(samples.t, np.arange(samples.t[0], samples.t[-1] + seconds, seconds)).tolist()
    for start, stop in pairwise(bounds):
        yield samples.slice(start, stop)


class Player:
    """A device whose chunks arrive as time passes."""

    def __init__(self, device: Device, clock: Clock) -> None:
        self.device = device
        self.clock = clock
        self.sent: dict[str, int] = {}

    def send(self, samples: Samples, after: float = 0.0, session: str = "a") -> Json:
        """Send a chunk, so many seconds after the one before."""
        self.clock.advance(after)
        seq = self.sent.get(session, 0)
        self.sent[session] = seq + 1
        answer: Json = self.device.send(write_native_csv(samples), seq, session, expect=200).json()
        return answer

    def play(self, chunks: Iterable[Samples], session: str = "a") -> None:
        """Send chunks as they are done."""
        for chunk in chunks:
            self.send(chunk, float(chunk.t[-1] - chunk.t[0]), session)

    def stand(self, start: float, chunks: int, pace: float = 1.0, session: str = "a", fix: bool = True) -> float:
        """Stand for some chunks of 60 s; the clock runs `pace` times as fast as the time of day. Give its time then."""
        for n in range(chunks):
            self.send(parked(start + 60.0 * n, fix=fix), 60.0 / pace, session)
        return start + 60.0 * chunks


def alerts(api: Api, kind: str) -> list[Json]:
    """Give the alerts of a kind, newest first."""
    found: list[Json] = api.get("/alerts", params={"kind": kind})["items"]
    return found


def the_alert(api: Api, kind: str) -> Json:
    """Give the only alert of a kind."""
    (found,) = alerts(api, kind)
    return found
