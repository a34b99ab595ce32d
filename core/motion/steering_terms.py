"""Steering-wheel angle: what is tuned, what is given, what goes wrong. Angles are positive to the left."""

from dataclasses import dataclass
from math import radians
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Booleans = NDArray[np.bool_]
Complexes = NDArray[np.complex128]


class SteeringError(ValueError):
    """The recordings do not show the steering angle; the message is a sentence that says what is missing."""


@dataclass(frozen=True)
class SteeringParameters:
    """What is tuned for two devices."""

    rate: float = 50.0
    """Hz of the common raster both recordings are brought to"""
    still_rate: float = radians(0.6)
    """rad/s, scatter of the angular rate within a second below which a device is taken to be still"""
    turning_rate: float = radians(8.0)
    """rad/s beyond which the wheel is being turned"""
    least_turning: float = radians(60.0)
    """rad of turning at a standstill, to and fro added up, without which the axis is not known"""
    force_noise: float = 0.5
    """m/s2, 1 sigma of a specific force on the raster: vibration of the wheel, place of the device"""
    force_interval: float = 0.1
    """s from one comparison of the specific forces to the next"""
    force_correlation: float = 0.4
    """s over which their errors are alike: so many comparisons count as one"""
    turning_noise: float = 0.05
    """m/s2 per (rad/s)2 of turning: what remains of the forces of the turning itself"""
    systematic: float = radians(0.5)
    """rad, 1 sigma of errors that no averaging removes: gains of the accelerometers, play of the column, the zero"""
    rate_noise: float = radians(0.1)
    """rad/s per sqrt(Hz) of the difference of the two rates: noise, gain errors, the flutter of the wheel"""
    bias_sigma: float = radians(0.5)
    """rad/s, 1 sigma of the difference of the biases at the start"""
    bias_drift: float = radians(0.002)
    """rad/s per sqrt(s) by which it wanders"""
    gate: float = 4.0
    """sigmas beyond which a comparison of specific forces is left out"""
    straight_speed: float = 6.0
    """m/s beyond which the yaw rate shows when the wheel is straight"""


DEFAULT = SteeringParameters()


class Steering(NamedTuple):
    """Steering-wheel angle at N moments."""

    t: Floats
    """(N,) s on the clock of the vehicle's device"""
    angle: Floats
    """(N,) rad at the wheel, positive to the left; nan where not known"""
    rate: Floats
    """(N,) rad/s"""
    sigma: Floats
    """(N,) rad, 1 sigma of the angle"""
