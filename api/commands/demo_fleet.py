"""The simulated fleet of `livella demo`: a few vehicles in various states, driven on and on."""

import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import count, pairwise

import numpy as np

from api.commands.device import Device, RefusedError, Service, UnavailableError, register
from api.formats import native_csv
from api.formats.writer import write_native_csv
from core import Samples, quaternion
from core.quaternion import Floats
from core.simulation import Scenario, simulate

SHORTEST_CHUNK = 5.0
"""s of log time in a chunk, at least"""
POST_EVERY = 1.0
"""s between two chunks of a vehicle that is played fast"""
FOREVER = 1e9
PATIENCE = 20.0


@dataclass(frozen=True)
class Vehicle:
    """One vehicle, and how it is played."""

    device_id: str
    name: str
    kind: str
    seed: int
    route: str = "city"
    drive: float = 900.0
    """s of log time from power-up to power-off"""
    speed: float = 10.0
    """s of log time played in a second"""
    head_start: float = 0.0
    """s of log time sent at once at the beginning"""
    no_fix: bool = False
    turned_at: float | None = None
    """s into each drive at which somebody turns the device"""
    refitted: bool = False
    """the calibration is restarted before each drive, as an installer does after refitting the device"""


FLEET = (
    Vehicle("van-101", "Van in the yard", "Fiat Ducato", 1, route="parked"),
    Vehicle("van-102", "Van in the underground car park", "Ford Transit", 2, no_fix=True),
    Vehicle("car-201", "Car that has just set off", "Skoda Octavia", 3, drive=90.0, speed=1.0, refitted=True),
    Vehicle("truck-301", "Lorry on the motorway", "Iveco Daily", 4, route="motorway", speed=4.0, refitted=True),
    Vehicle("car-202", "Car in town", "VW Golf", 5, head_start=400.0),
    Vehicle("car-203", "Car whose device gets turned", "Renault Clio", 6, speed=5.0, head_start=300.0, turned_at=400.0),
)


@dataclass
class Player:
    """Plays one vehicle until `end` is set."""

    vehicle: Vehicle
    server: str
    key: str
    """of an installer or above"""
    end: threading.Event
    drives: Iterator[Samples] = field(init=False)

    def __post_init__(self) -> None:
        """Prepare the drives."""
        self.drives = drives(self.vehicle)

    def run(self) -> None:
        """Register the device, then drive on and on."""
        with self._service(self.key) as service:
            key = register(service, self.vehicle.device_id, self.vehicle.name, self.vehicle.kind)
            with self._service(key or self.key) as own:
                for number in count(1):
                    self._drive(service, own, number)
                    if self.end.is_set():
                        return

    def _service(self, key: str) -> Service:
        return Service(self.server, key, lambda _: None, PATIENCE, self.end)

    def _drive(self, service: Service, own: Service, number: int) -> None:
        """Drive from power-up to power-off; one that fails is given up, the next one follows."""
        vehicle = self.vehicle
        try:
            if vehicle.refitted and number > 1:
                service.request("POST", f"devices/{vehicle.device_id}/installation/restart")
            device = Device(own, vehicle.device_id, f"drive-{number}", native_csv.MEDIA_TYPE)
            self._play(device, next(self.drives), vehicle.head_start if number == 1 else 0.0)
        except (RefusedError, UnavailableError):
            self.end.wait(POST_EVERY)  # somebody removed the device on the page, or the service is ending

    def _play(self, device: Device, samples: Samples, head_start: float) -> None:
        """Send the drive, each chunk when it is due."""
        begin = time.monotonic() - head_start / self.vehicle.speed
        for piece in pieces(samples, max(SHORTEST_CHUNK, POST_EVERY * self.vehicle.speed)):
            due = begin + float(piece.t[-1]) / self.vehicle.speed
            if self.end.wait(max(0.0, due - time.monotonic())):
                return
            device.send(write_native_csv(piece))


def drives(vehicle: Vehicle) -> Iterator[Samples]:
    """Give one drive after the other; the device stays mounted as it was at the end of the one before."""
    rng = np.random.default_rng(vehicle.seed)
    mount = quaternion.random(rng)
    while True:
        after = _turned(mount, rng) if vehicle.turned_at else mount
        scenario = Scenario(
            route=vehicle.route,
            seconds=vehicle.drive,
            seed=int(rng.integers(2**31)),
            mount=mount,
            remount=(vehicle.turned_at, after) if vehicle.turned_at else None,
            imu_rate=100.0,
            outages=((0.0, FOREVER),) if vehicle.no_fix else (),
        )
        yield simulate(scenario).samples
        mount = after


def pieces(samples: Samples, seconds: float) -> Iterator[Samples]:
    """Cut a drive into pieces of so many seconds."""
    bounds = np.searchsorted(samples.t, np.arange(0.0, samples.t[-1] + seconds, seconds)).tolist()
    for start, stop in pairwise(bounds):
        yield samples.slice(start, stop)


def _turned(mount: Floats, rng: np.random.Generator) -> Floats:
    """Give the mounting after a knock of 20 to 50 degrees about any axis."""
    axis = rng.normal(size=3)
    angle = np.radians(rng.uniform(20.0, 50.0))
    knock = quaternion.from_rotation_vector(angle * axis / np.linalg.norm(axis))
    return quaternion.normalise(quaternion.multiply(knock, mount))
