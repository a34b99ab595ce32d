"""What is tuned of the attitude filters: unit and meaning."""

from dataclasses import dataclass, fields, replace
from functools import lru_cache
from math import radians

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Parameters:
    """Of all filters; what only one of them has stands under its name."""

    # Time
    correction_period: float = 0.02
    """s between corrections; in between the gyroscope alone turns the attitude"""
    longest_gap: float = 1.0
    """s without a reading of the gyroscope after which the attitude is found anew"""

    # Specific force
    force_time: float = 0.7
    """s over which it is averaged, twice"""
    spread_time: float = 15.0
    """s over which its spread is averaged where it falls"""
    spread_rise: float = 0.2
    """s, the same where it rises"""
    least_force: float = 0.5
    """of gravity: below it tells nothing of the vertical, as in free fall"""
    most_force: float = 2.0
    """of gravity"""
    tilt_noise: float = radians(0.2)
    """rad sqrt(s), of its average's direction at rest"""
    shake_noise: float = 0.08
    """sqrt(s), of the same for each g of spread"""
    excess_noise: float = 1.0
    """sqrt(s), of the same for each g its size is off"""

    settle_time: float = 6.0
    """s from a start in the middle of motion for which the attitude is put where the averages say"""
    settle_look: float = 0.5
    """s after which stillness ends that"""
    settle_spread: float = 1.0
    """m/s2, spread that is motion"""

    # Magnetic field
    field_time: float = 0.05
    """s over which it is averaged"""
    field_moment: float = 0.05
    """s over which it is averaged to judge it"""
    field_noise: float = radians(0.22)
    """rad sqrt(s), of its average's direction"""
    field_tolerance: float = 0.05
    """of its strength: more is a disturbance"""
    dip_tolerance: float = 0.06
    """sine of the angle below the horizontal: more is a disturbance"""
    field_calm: float = 0.5
    """s without disturbance before it is trusted again"""
    field_patience: float = 40.0
    """s of disturbance after which the field is taken for a new one of the Earth's"""
    reference_time: float = 30.0
    """s over which strength and dip of the undisturbed field are learnt"""
    reference_start: float = 4.0
    """s from the start for which it is learnt from every reading"""
    least_horizontal: float = 0.1
    """of its strength: below it tells nothing of the heading, as near the magnetic poles"""

    # Gyroscope
    rate_noise: float = radians(0.03)
    """rad/sqrt(s)"""
    angle_noise: float = radians(0.05)
    """rad/sqrt(s), the same for the filters that follow one angle at a time"""
    bias_walk: float = radians(0.001)
    """rad/s per sqrt(s)"""
    most_bias: float = radians(10.0)
    """rad/s"""

    # Kalman filters
    start_tilt: float = radians(20.0)
    """rad, 1 sigma of a first attitude"""
    start_heading: float = radians(40.0)
    """rad, the same"""
    start_bias: float = radians(1.8)
    """rad/s, 1 sigma"""
    gate: float = 0.1
    """squares of innovations, in variances of one measurement, beyond which they are not likely (001 eq. 6.5)"""
    own_gate: float = 4.0
    """squares of innovations, in variances of the state, that are not held against a measurement"""

    # Madgwick
    beta: float = radians(20.0)
    """rad/s, fastest correction; twice the rate of the quaternion (003 eq. 43)"""

    # QUEST and Kalman filter
    rate_lag: float = 0.5
    """s, tau of 003 eq. 64"""
    rate_motion: float = 3.0
    """rad/s, 1 sigma of the motion"""

    # Linear
    least_cosine: float = 0.1
    """of pitch: steeper the rates of roll and yaw are not told apart"""

    # Altitude
    altitude_time: float = 1.0
    """s over which it is smoothed"""


DEFAULT = Parameters()
MADGWICK = replace(
    DEFAULT,
    force_time=0.9,
    spread_time=13.0,
    spread_rise=0.7,
    tilt_noise=radians(0.055),
    shake_noise=0.031,
    excess_noise=1.8,
    field_noise=radians(0.33),
    start_bias=radians(0.5),
    gate=0.7,
    angle_noise=radians(0.055),
    bias_walk=radians(0.0025),
)
LINEAR = replace(
    DEFAULT,
    force_time=0.2,
    tilt_noise=radians(0.05),
    shake_noise=0.06,
    excess_noise=1.5,
    gate=0.2,
    start_bias=radians(1.0),
    angle_noise=radians(0.015),
)
QUEST_EKF = replace(
    DEFAULT,
    force_time=0.85,
    spread_time=13.0,
    spread_rise=0.3,
    tilt_noise=radians(0.23),
    shake_noise=0.06,
    excess_noise=6.0,
    field_noise=radians(0.12),
    start_heading=radians(20.0),
    start_bias=radians(1.5),
    gate=0.13,
)


@lru_cache(maxsize=32)
def as_record(params: Parameters) -> NDArray[np.void]:
    """Give the parameters as a structured array of shape (1,) for the kernel."""
    values = [(item.name, getattr(params, item.name)) for item in fields(params)]
    record = np.zeros(1, np.dtype((np.record, [(name, "f8") for name, _ in values])))
    for name, value in values:
        record[name] = value
    return record
