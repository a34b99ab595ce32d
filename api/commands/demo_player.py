"""Plays the fleet of `livella demo` over HTTP, as its devices and their fitters do."""

import time
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import count
from threading import Event, Thread

from api.commands.demo_desk import keep_desk
from api.commands.demo_fleet import FLEET, Vehicle
from api.commands.demo_trips import FOREVER, Recorder, Trip, pieces
from api.commands.device import Device, RefusedError, Service, UnavailableError, register
from api.formats import native_csv
from api.formats.writer import write_native_csv
from core import Samples

POST_EVERY = 5.0
"""s between two chunks of a device"""
PATIENCE = 20.0
"""s for which a request is tried again"""


def play(server: str, key: str, end: Event) -> None:
    """Play the fleet until `end` is set; `key` is an admin's."""
    with _service(server, key, end) as office:
        threads = [Thread(target=keep_desk, args=(office, end))]
        threads[0].start()
        for vehicle in FLEET:
            player = Player(vehicle, server, office, end)
            threads.append(Thread(target=player.run))
            threads[-1].start()
            player.caught_up.wait()  # one after the other, so that the page stays quick meanwhile
        for thread in threads:
            thread.join()


def _service(server: str, key: str, end: Event) -> Service:
    return Service(server, key, lambda _: None, PATIENCE, end)


@dataclass
class Player:
    """Plays one vehicle."""

    vehicle: Vehicle
    server: str
    office: Service
    """asked with the key of an installer or above"""
    end: Event
    caught_up: Event = field(default_factory=Event)
    """set when the past has been sent"""

    def __post_init__(self) -> None:
        """Put the device into the vehicle."""
        self._recorder = Recorder(self.vehicle.seed)
        self._sessions = count()

    def run(self) -> None:
        """Register the device, send what it kept, then drive on and on."""
        vehicle = self.vehicle
        try:
            key = register(self.office, vehicle.device_id, vehicle.name, vehicle.kind)
            if key is None:
                return  # somebody was quicker on the page
            with _service(self.server, key, self.end) as own:
                self._catch_up(own)
                self.caught_up.set()
                self._drive_on(own)
        except (RefusedError, UnavailableError):
            return  # somebody removed the device on the page, or the service is ending
        finally:
            self.caught_up.set()

    def _catch_up(self, own: Service) -> None:
        """Send what was recorded before the demo, all at once."""
        if self.vehicle.past is None:
            return
        device = self._power_up(own)
        for piece in self._record(self.vehicle.past, FOREVER):
            device.send(write_native_csv(piece))

    def _drive_on(self, own: Service) -> None:
        """Drive again and again until the end."""
        trip = self.vehicle.now
        if trip is None or self.end.wait(self.vehicle.fitted_at or 0.0):
            return
        while True:
            with suppress(UnavailableError):  # a trip during which the service stays away is given up
                self._drive(own, trip)
            if self.end.is_set():
                return
            if self.vehicle.fitted_at is not None:
                self._recorder.refit()
                self.office.request("POST", f"devices/{self.vehicle.device_id}/installation/restart")

    def _drive(self, own: Service, trip: Trip) -> None:
        """Send each piece when it is due."""
        device = self._power_up(own)
        due = time.monotonic()
        for piece in self._record(trip, POST_EVERY):
            due += len(piece) / trip.rate
            if self.end.wait(max(0.0, due - time.monotonic())):
                return
            device.send(write_native_csv(piece))

    def _power_up(self, own: Service) -> Device:
        """Begin a session."""
        return Device(own, self.vehicle.device_id, f"trip-{next(self._sessions)}", native_csv.MEDIA_TYPE)

    def _record(self, trip: Trip, seconds: float) -> Iterator[Samples]:
        return pieces(self._recorder.record(trip), trip, seconds)
