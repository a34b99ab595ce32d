"""The fleet of `livella demo`: together its vehicles show every stage and every kind of alert, now and later.

What a device recorded before the demo it sends at once, as after a time without network. From then on everything goes
at the speed of time: a clock a little faster than that would be a fault.
"""

from dataclasses import dataclass

from api.commands.demo_trips import Trip
from core.simulation_faults import Disturbances

MINUTE, HOUR = 60.0, 3600.0


@dataclass(frozen=True)
class Vehicle:
    """A vehicle, and what it does."""

    device_id: str
    name: str
    kind: str
    seed: int
    """of its device, its mounting and its roads"""
    shows: tuple[str, ...]
    """stages and alerts it is here for"""
    past: Trip | None
    """recorded before the demo"""
    now: Trip | None
    """driven again and again; None = the device sends nothing more"""
    fitted_at: float | None = None
    """s until a fitter has fitted the device and sets off; after each trip it is fitted anew, at another angle"""


SHORT = Trip("city", 20 * MINUTE)
YARD = Trip("parked", 30 * MINUTE)
UNDERGROUND = Trip("parked", 40 * MINUTE, no_fix_from=0.0)
ROUND = Trip("city", 200.0)
"""of a fitter: until the mounting is confirmed"""
JAM = Trip("crawl", 75 * MINUTE)

HIT = Trip("city", 16.5 * MINUTE, knocked_at=(15 * MINUTE,))
SLIPPED = Trip("city", 28.5 * MINUTE, knocked_at=(400.0, 1000.0, 1600.0))
SLIPPING = Trip("city", 30 * MINUTE, knocked_at=(400.0, 1000.0, 1600.0))
STUCK = Trip("city", 6 * MINUTE, faults=Disturbances(stuck=(0, 240.0)))
DRIFT = Disturbances(bias_drift=0.6, drift_period=90.0)
DRIFTED, DRIFTING = Trip("city", 14 * MINUTE, faults=DRIFT), Trip("city", 20 * MINUTE, faults=DRIFT)
CRASHED = Trip("city", 10 * MINUTE, hit_at=9.5 * MINUTE, rate=50.0)
HURRIED, HURRYING = Trip("harsh", 12 * MINUTE, rate=50.0), Trip("harsh", 30 * MINUTE, rate=50.0)
LOSING_GPS = Trip("city", 50 * MINUTE, no_fix_from=15 * MINUTE)
WITHOUT_GPS = Trip("city", 30 * MINUTE, no_fix_from=0.0)
SET_BACK = Trip("city", 10 * MINUTE, set_back=(9.5 * MINUTE, 90.0))

SLEEPS = Disturbances(clock_steps=((15 * MINUTE, 2 * HOUR), (40 * MINUTE, 3 * HOUR)))
"""An hour of driving in three trips of a day: the device sleeps meanwhile, its clock goes on."""
DAY_IN_TOWN = Trip("city", HOUR, faults=SLEEPS)
DAY_IN_HILLS = Trip("hills", HOUR, faults=SLEEPS)
DAY_ON_MOTORWAY = Trip("motorway", HOUR, faults=SLEEPS)
TOWN, HILLS, MOTORWAY = (Trip(route, 30 * MINUTE) for route in ("city", "hills", "motorway"))

FLEET = (
    # Fallen silent: first, because the silence has to last.
    Vehicle("car-201", "Car with a flat battery", "Citroën Berlingo", 1, ("device_silent",), SHORT, None),
    Vehicle("camper-401", "Camper laid up for the winter", "Fiat Ducato", 2, ("device_silent",), SHORT, None),
    # Standing.
    Vehicle("van-101", "Van underground", "Ford Transit", 3, ("waiting", "gps_lost"), UNDERGROUND, UNDERGROUND),
    Vehicle("van-102", "Van in the yard", "Fiat Ducato", 4, ("aligning",), None, YARD),
    # With fitters, one after the other, so that one of them is always in the drive test.
    Vehicle("car-202", "Pool car with a fitter", "Skoda Octavia", 12, ("settling", "verifying"), None, ROUND, 0.0),
    Vehicle("car-203", "Second pool car with a fitter", "VW Golf", 8, ("waiting",), None, ROUND, 60.0),
    Vehicle("car-204", "Third pool car with a fitter", "Renault Clio", 5, ("waiting",), None, ROUND, 130.0),
    # In trouble.
    Vehicle("car-205", "Car hit in a car park", "VW Passat", 3, ("orientation_changed",), HIT, YARD),
    Vehicle("van-103", "Van with a loose device", "Peugeot Boxer", 3, ("device_loose",), SLIPPED, SLIPPING),
    Vehicle("car-206", "Car with a stuck sensor", "Fiat Panda", 6, ("sensor_fault",), STUCK, STUCK),
    Vehicle("van-104", "Van with a drifting sensor", "Opel Vivaro", 5, ("verification_failing",), DRIFTED, DRIFTING),
    Vehicle("van-105", "Van in a jam", "Mercedes Sprinter", 2, ("settling", "calibration_stalled"), JAM, JAM),
    Vehicle("car-207", "Taxi with a broken antenna", "Toyota Prius", 4, ("gps_lost",), LOSING_GPS, WITHOUT_GPS),
    Vehicle("lorry-301", "Lorry whose clock is set back", "MAN TGM", 5, ("clock_fault",), SET_BACK, SET_BACK),
    # Driven badly.
    Vehicle("car-208", "Car that had a crash", "Ford Focus", 2, ("impact",), CRASHED, YARD),
    Vehicle("van-108", "Courier in a hurry", "VW Crafter", 4, ("harsh_driving",), HURRIED, HURRYING),
    # As they should be.
    Vehicle("lorry-302", "Lorry on the motorway", "Iveco S-Way", 7, ("confirmed",), DAY_ON_MOTORWAY, MOTORWAY),
    Vehicle("van-106", "Parcel van in town", "Renault Master", 8, ("confirmed",), DAY_IN_TOWN, TOWN),
    Vehicle("van-107", "Van in the hills", "Dacia Dokker", 9, ("confirmed",), DAY_IN_HILLS, HILLS),
)
