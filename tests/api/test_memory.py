"""However many devices send: nothing is kept of each of them in memory, beyond caches that have a bound."""

import asyncio
import gc
import sys

import pytest

from api import live, metrics
from api.services import access, presenting
from api.services.counts import Counts
from api.services.uses import Uses
from core import DEFAULT, Stage, initial_state, status
from storage import devices, installations, keys
from storage.database import Database
from storage.installations import Installation
from tests.conftest import Clock
from tests.faults.sending import small_chunks
from tests.service import Api, Device

WARM = 300
"""devices that send before it is counted"""
MORE = 2000
"""devices that send between the two counts: so many that some hundred objects, which come and go, matter little"""
PER_DEVICE = 0.5
"""objects; a single entry of a dictionary has one or more: its key"""
EVENTS = 100


@pytest.fixture
def small_caches(monkeypatch: pytest.MonkeyPatch) -> None:
    """Make caches so small that they are full before it is counted."""
    monkeypatch.setattr(asyncio.base_events, "_MIN_SCHEDULED_TIMER_HANDLES", 0)  # else it keeps 100 cancelled ones
    monkeypatch.setattr(live, "MEMORY", EVENTS)
    monkeypatch.setattr(Counts.__init__, "__defaults__", (EVENTS,))
    monkeypatch.setattr(Uses, "mark", lambda *_: None)  # written and forgotten every minute


@pytest.fixture
def fleet(small_caches: None, api: Api, database: Database, clock: Clock) -> list[Device]:
    shown = presenting.status(status(DEFAULT, initial_state(DEFAULT)))
    made = [Device(api, f"box-{n:04}", access.new_key()) for n in range(WARM + MORE)]
    with database.write() as tx:
        for device in made:
            pk = devices.add(tx, device.id, {"name": device.id}, clock())
            keys.add(tx, access.digest(device.key), "device", device.id, clock(), device_pk=pk)
            row = Installation(pk, None, None, Stage.WAITING.word, None, None, clock(), shown, None, revision=0)
            installations.add(tx, row)
    return made


def objects() -> int:
    """Count what Python has allocated and not freed, whatever its type."""
    gc.collect()
    return sys.getallocatedblocks()


def labels() -> int:
    """Count the figures that Prometheus is told."""
    return metrics.render().count(b"\n")


def send(fleet: list[Device]) -> None:
    for device in fleet:
        device.send(small_chunks(1)[0], 0, expect=200)


@pytest.mark.slow
def test_nothing_is_kept_of_devices_that_sent(fleet: list[Device]) -> None:
    send(fleet[:WARM])
    before, told = objects(), labels()
    send(fleet[WARM:])
    assert labels() == told
    assert (objects() - before) / len(fleet[WARM:]) < PER_DEVICE


def test_an_object_for_each_device_would_be_seen() -> None:
    before = objects()
    kept = {f"box-{n}": None for n in range(1000)}
    assert (objects() - before) / len(kept) > PER_DEVICE
