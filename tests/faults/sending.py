"""Devices that send a drive and repeat what was not answered for, as the manual tells them to."""

import math
import threading
import time
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from functools import cache

import httpx

from api.formats.writer import write_native_csv
from tests.drives import plain
from tests.service import Api, Device, Response

PAUSE = 0.02
"""s before another try"""
PATIENCE = 240.0
"""s after which a device gives up, which fails the test"""
TRY_AGAIN = {429, 500, 502, 503, 504}


@cache
def small_chunks(number: int, seconds: float = 1.0) -> tuple[bytes, ...]:
    """The beginning of a drive in small chunks."""
    samples = plain().samples
    ends = [int(x) for x in samples.t.searchsorted([n * seconds for n in range(number + 1)])]
    return tuple(write_native_csv(samples.slice(ends[n], ends[n + 1])) for n in range(number))


class Tally:
    """What the devices met."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self.allowed: float = math.inf
        """acknowledged chunks after which the devices pause, so that they are not done before they were disturbed"""
        self.acknowledged = 0
        self.repeated = 0
        self.statuses: set[int | str] = set()

    def note(self, status: int | str, final: bool) -> None:
        with self._lock:
            self.statuses.add(status)
            self.acknowledged += final
            self.repeated += not final


def send_until_acknowledged(device: Device, seq: int, body: bytes, tally: Tally) -> None:
    """Send a chunk until it is durable."""
    deadline = time.monotonic() + PATIENCE
    while time.monotonic() < deadline:
        if tally.acknowledged >= tally.allowed:
            time.sleep(PAUSE)
            continue
        status = _try(device, seq, body)
        done = status in {200, 202}
        tally.note(status, done)
        if done:
            return
        assert not isinstance(status, int) or status in TRY_AGAIN, status
        time.sleep(PAUSE)
    raise AssertionError(f"chunk {seq} of {device.id} was never acknowledged")


def _try(device: Device, seq: int, body: bytes) -> int | str:
    try:
        answer: Response = device.send(body, seq)
    except httpx.TransportError as error:
        return type(error).__name__
    return answer.status_code


def drive(url: str, device: Device, lane: int, lanes: int, bodies: tuple[bytes, ...], tally: Tally) -> None:
    """Send every `lanes`-th chunk, in order: several lanes together deliver a drive out of order."""
    with httpx.Client(base_url=url, timeout=20.0) as client:
        sender = Device(Api(client), device.id, device.key)
        for seq in range(lane, len(bodies), lanes):
            send_until_acknowledged(sender, seq, bodies[seq], tally)


@contextmanager
def driving(url: str, devices: list[Device], bodies: tuple[bytes, ...], lanes: int = 2) -> Iterator[Tally]:
    """Let devices drive meanwhile; at the end everything they sent was acknowledged."""
    tally = Tally()
    with ThreadPoolExecutor(len(devices) * lanes) as pool:
        sent: list[Future[None]] = [
            pool.submit(drive, url, device, lane, lanes, bodies, tally) for device in devices for lane in range(lanes)
        ]
        yield tally
        for one in sent:
            one.result()
