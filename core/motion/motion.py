"""What a reconstruction of a vehicle's motion gives, and its state."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class Origin(NamedTuple):
    """Where the local level frame lies."""

    latitude: float
    """rad"""
    longitude: float
    """rad"""
    altitude: float
    """m, nan = not known"""


class Motion(NamedTuple):
    """Motion of the centre of gravity at N moments; `_v` forward, left, up, `_n` east, north, up. SI units, radians."""

    t: Floats
    """(N,) s on the session's clock"""
    q_nv: Floats
    """(N, 4) attitude of the vehicle"""
    a_v: Floats
    """(N, 3) m/s2, acceleration, gravity taken out: longitudinal, lateral, vertical"""
    w_v: Floats
    """(N, 3) rad/s; the last is the yaw rate"""
    velocity_v: Floats
    """(N, 2) m/s forward and to the left"""
    velocity_sigma: Floats
    """(N, 2) m/s, 1 sigma"""
    sideslip: Floats
    """(N,) rad, atan2(left, forward) of the velocity; nan below walking pace"""
    sideslip_sigma: Floats
    """(N,) rad, 1 sigma"""
    position_n: Floats
    """(N, 3) m from `origin`; nan before the first fix"""
    position_sigma: Floats
    """(N,) m, 1 sigma per horizontal axis"""
    dead_reckoned: NDArray[np.bool_]
    """(N,) True where no fix has come for longer than the receiver's interval: position and velocity are carried on"""
    origin: Origin | None
    """None before the first fix"""
