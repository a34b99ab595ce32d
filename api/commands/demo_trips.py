"""What the devices of `livella demo` record: trips, and the pieces in which they are sent."""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from itertools import pairwise
from math import radians

import numpy as np

from core import Samples, quaternion
from core.simulation import Scenario, simulate
from core.simulation_events import Crash, crash
from core.simulation_faults import Disturbances, Rotation
from core.simulation_motion import GRAVITY

RATE = 25.0
"""Hz of the accelerometer: less than that of most devices, because one machine drives the whole fleet"""
FOREVER = 1e9
HIT = Crash(0.0, radians(40.0), 9 * GRAVITY, 0.1)
"""from the front left"""
KNOCK = (20.0, 50.0)
"""degrees by which a device gets turned"""


@dataclass(frozen=True)
class Trip:
    """A trip from power-up to power-off; all moments are s since power-up."""

    route: str
    seconds: float
    no_fix_from: float = FOREVER
    knocked_at: tuple[float, ...] = ()
    """when the device is turned against the vehicle"""
    set_back: tuple[float, float] = (FOREVER, 0.0)
    """when the device's clock is set back, and by how many s"""
    hit_at: float = FOREVER
    """when another vehicle drives into it"""
    rate: float = RATE
    """Hz of the accelerometer; impacts are told from 45 Hz on"""
    faults: Disturbances = field(default_factory=Disturbances)

    @property
    def incidents(self) -> tuple[float, ...]:
        """Give the moments at which something goes wrong."""
        return (self.no_fix_from, *self.knocked_at, self.set_back[0], self.hit_at)


class Recorder:
    """A device in its vehicle; it stays mounted as it was at the end of the trip before."""

    def __init__(self, seed: int) -> None:
        self._seed = seed
        self._rng = np.random.default_rng(seed)
        self.refit()

    def refit(self) -> None:
        """Fit the device at any angle; the fitter then drives the same round as every time."""
        self.mount = quaternion.random(self._rng)
        self._trips = 0

    def record(self, trip: Trip) -> Samples:
        """Drive a trip; no two are alike unless the device was refitted."""
        knocks = tuple((when, self._knock()) for when in trip.knocked_at)
        scenario = Scenario(
            trip.route,
            trip.seconds,
            self._seed,
            self.mount,
            imu_rate=trip.rate,
            outages=((trip.no_fix_from, FOREVER),),
            disturbances=replace(trip.faults, knocks=knocks),
            session=self._trips,
        )
        self._trips += 1
        for _, turn in knocks:
            self.mount = quaternion.normalise(quaternion.multiply(self.mount, quaternion.from_rotation_vector(turn)))
        drive = simulate(scenario)
        return drive.samples if trip.hit_at > trip.seconds else crash(drive, HIT._replace(t=trip.hit_at), self._rng)

    def _knock(self) -> Rotation:
        """Draw a turn about any axis."""
        axis = self._rng.normal(size=3)
        x, y, z = (np.radians(self._rng.uniform(*KNOCK)) * axis / np.linalg.norm(axis)).tolist()
        return x, y, z


def pieces(samples: Samples, trip: Trip, seconds: float) -> Iterator[Samples]:
    """Cut a trip into pieces of so many seconds, and where something goes wrong; times are as the device's clock shows.

    What goes wrong begins a piece: alerts tell how long it has gone on by the pieces.
    """
    moments = np.unique([*np.arange(0.0, samples.t[-1], seconds), *trip.incidents, np.inf])
    when, by = trip.set_back
    for start, stop in pairwise(np.unique(np.searchsorted(samples.t, moments)).tolist()):
        piece = samples.slice(start, stop)
        yield replace(piece, t=piece.t - by) if piece.t[0] >= when else piece
