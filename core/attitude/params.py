"""What is tuned of the attitude filters: unit and meaning."""

from dataclasses import dataclass, fields
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
    force_time: float = 1.0
    """s over which it is averaged, twice"""
    spread_time: float = 3.0
    """s over which its spread is averaged"""
    least_force: float = 0.5
    """of gravity: below it tells nothing of the vertical, as in free fall"""
    most_force: float = 2.0
    """of gravity"""
    tilt_noise: float = radians(0.3)
    """rad sqrt(s), of its average's direction at rest"""
    shake_noise: float = 0.3
    """sqrt(s), of the same for each g of spread"""
    excess_noise: float = 2.0
    """sqrt(s), of the same for each g its size is off"""

    # Magnetic field
    field_time: float = 0.5
    """s over which it is averaged"""
    field_moment: float = 0.1
    """s over which it is averaged to judge it"""
    field_noise: float = radians(1.0)
    """rad sqrt(s), of its average's direction"""
    field_tolerance: float = 0.08
    """of its strength: more is a disturbance"""
    dip_tolerance: float = 0.1
    """sine of the angle below the horizontal: more is a disturbance"""
    field_calm: float = 0.5
    """s without disturbance before it is trusted again"""
    field_patience: float = 40.0
    """s of disturbance after which the field is taken for a new one of the Earth's"""
    reference_time: float = 30.0
    """s over which strength and dip of the undisturbed field are learnt"""
    least_horizontal: float = 0.1
    """of its strength: below it tells nothing of the heading, as near the magnetic poles"""

    # Gyroscope
    rate_noise: float = radians(0.02)
    """rad/sqrt(s)"""
    bias_walk: float = radians(0.003)
    """rad/s per sqrt(s)"""
    most_bias: float = radians(10.0)
    """rad/s"""

    # Kalman filters
    start_tilt: float = radians(5.0)
    """rad, 1 sigma of a first attitude"""
    start_heading: float = radians(10.0)
    """rad, the same"""
    start_bias: float = radians(1.0)
    """rad/s, 1 sigma"""
    gate: float = 9.0
    """squares of innovations, in their variances, beyond which they are less likely (001 eq. 6.5) than believed"""

    # Madgwick
    beta: float = radians(1.0)
    """rad/s, half of it the fastest correction of the tilt (003 eq. 43)"""
    beta_field: float = radians(1.0)
    """rad/s, the same of the heading"""
    zeta: float = 0.05
    """1/s, of the bias (003 eq. 51)"""
    step_limit: float = 0.1
    """rad, error above which a correction is no faster"""
    calm_spread: float = 10.0
    """by how much shaking, in squares of g, slows the correction of the tilt"""
    start_hurry: float = 10.0
    """how many times faster corrections are at the start"""
    start_time: float = 1.0
    """s after which they are no longer"""

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


@lru_cache(maxsize=32)
def as_record(params: Parameters) -> NDArray[np.void]:
    """Give the parameters as a structured array of shape (1,) for the kernel."""
    values = [(item.name, getattr(params, item.name)) for item in fields(params)]
    record = np.zeros(1, np.dtype([(name, "f8") for name, _ in values]))
    for name, value in values:
        record[name] = value
    return record
