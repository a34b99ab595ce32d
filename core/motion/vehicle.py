"""The vehicle whose motion is reconstructed: what the single-track model needs to know of it."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from math import radians
from typing import Any

import numpy as np
from numpy.typing import NDArray

STANDARD_GRAVITY = 9.80665


class VehicleError(ValueError):
    """A description of a vehicle that cannot be used; the message is a sentence that says why."""


@dataclass(frozen=True)
class Vehicle:
    """Masses and measures of a vehicle, SI units (seed 004, figure 4). The defaults are those of a sedan."""

    mass: float = 1500.0
    """kg, m"""
    yaw_inertia: float = 2500.0
    """kg m2, Iz, about the vertical through the centre of gravity"""
    a1: float = 1.2
    """m, front axle ahead of the centre of gravity"""
    a2: float = 1.5
    """m, rear axle behind the centre of gravity"""
    cornering_stiffness_1: float = 95e3
    """N/rad, C1, both front tyres together, with the compliance of the steering"""
    cornering_stiffness_2: float = 105e3
    """N/rad, C2, both rear tyres together"""
    steering_ratio: float = 16.0
    """rad at the steering wheel per rad at the front wheels"""
    friction: float = 0.9
    """largest lateral force of a tyre by its load; 0.9 = dry asphalt"""
    cg_height: float = 0.55
    """m, centre of gravity above the road"""
    track: float = 1.55
    """m, between the wheels of an axle"""
    roll_gradient: float = radians(4.0) / STANDARD_GRAVITY
    """rad s2/m, how far the body leans out of a curve"""
    device: tuple[float, float, float] | None = None
    """(x, y, z) m, place of the device ahead, to the left and above the centre of gravity; None = not known"""

    @property
    def wheelbase(self) -> float:
        """M, between the axles."""
        return self.a1 + self.a2


VEHICLES: dict[str, Vehicle] = {
    "city_car": Vehicle(1050.0, 1300.0, 0.95, 1.45, 62e3, 60e3, 15.5, 0.9, 0.53, 1.43, radians(4.5) / STANDARD_GRAVITY),
    "sedan": Vehicle(),
    "suv": Vehicle(2000.0, 3500.0, 1.3, 1.5, 110e3, 120e3, 16.5, 0.85, 0.7, 1.62, radians(5.0) / STANDARD_GRAVITY),
    "van": Vehicle(2600.0, 5500.0, 1.7, 1.9, 120e3, 140e3, 18.0, 0.8, 0.95, 1.7, radians(5.5) / STANDARD_GRAVITY),
    "truck": Vehicle(10e3, 45e3, 2.6, 2.2, 380e3, 800e3, 21.0, 0.7, 1.3, 2.0, radians(5.0) / STANDARD_GRAVITY),
    "bus": Vehicle(14e3, 150e3, 3.6, 2.4, 450e3, 1000e3, 20.0, 0.7, 1.2, 2.1, radians(5.0) / STANDARD_GRAVITY),
}
"""Usual vehicles of each class, half laden: published data of common models, rounded."""


def vehicle_from(description: str | Mapping[str, Any]) -> Vehicle:
    """Give the vehicle of a class, or of a mapping: `class` and what differs from it, names and units as in `Vehicle`.

    Raises
    ------
    VehicleError
        an unknown class or name, a value that is no positive number, a place that is not three numbers
    """
    given = {"class": description} if isinstance(description, str) else dict(description)
    name = given.pop("class", "sedan")
    if name not in VEHICLES:
        raise VehicleError(f"There is no class {name!r}; there are {', '.join(VEHICLES)}.")
    known = {item.name for item in fields(Vehicle)}
    unknown = [key for key in given if key not in known]
    if unknown:
        raise VehicleError(f"{unknown[0]!r} is not known; there are class, {', '.join(sorted(known))}.")
    values: dict[str, Any] = {key: (_place if key == "device" else _positive)(key, x) for key, x in given.items()}
    return replace(VEHICLES[name], **values)


def _positive(name: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0 < value < math.inf:
        raise VehicleError(f"{name} must be a positive number, not {value!r}.")
    return float(value)


def _place(name: str, value: Any) -> tuple[float, float, float]:
    numbers = value if isinstance(value, list | tuple) else ()
    if len(numbers) != 3 or not all(_is_number(x) for x in numbers):
        raise VehicleError(f"{name} must be three numbers, m ahead, left and above, not {value!r}.")
    return float(numbers[0]), float(numbers[1]), float(numbers[2])


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


_RECORD = np.dtype(
    [(item.name, "f8", (3,)) if item.name == "device" else (item.name, "f8") for item in fields(Vehicle)]
)


def as_record(vehicle: Vehicle) -> NDArray[np.void]:
    """Give the vehicle as a structured array of shape (1,) for the kernel; a place not known is nan."""
    record = np.zeros(1, _RECORD)
    for item in fields(Vehicle):
        value = getattr(vehicle, item.name)
        record[item.name] = np.nan if value is None else value
    return record
