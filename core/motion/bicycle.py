"""The dynamic single-track ("bicycle") model (2) of seed 004: what its coefficients are made of.

Forces of the axles over their slip angles are those of the brush model, which saturate at the friction limit:

    alpha1 = delta - (v + a1 r) / u      alpha2 = -(v - a2 r) / u      delta = delta_v / steering ratio
    dv/dt = (F1 + F2) / m - u r          dr/dt = (a1 F1 - a2 F2) / Iz

Linearised about the current state, with the slopes C1 = dF1/dalpha1 and C2 = dF2/dalpha2 there, this is (2).
"""

from typing import NamedTuple

import numpy as np

from core.motion import _kernel
from core.motion.vehicle import Vehicle, as_record


class Coefficients(NamedTuple):
    """Coefficients of (2): `d(v, r)/dt = [Q2 R2; Q3 R3] (v, r) + [U2 D2; U3 D3] (u, delta_v) + (K2, K3)`; SI units."""

    q2: float
    """-(C1 + C2) / (m u)"""
    q3: float
    """-(a1 C1 - a2 C2) / (Iz u)"""
    r2: float
    """-(a1 C1 - a2 C2) / (m u) - u"""
    r3: float
    """-(a1^2 C1 + a2^2 C2) / (Iz u)"""
    u2: float
    """(C1 (v + a1 r) + C2 (v - a2 r)) / (m u^2) - r"""
    u3: float
    """(a1 C1 (v + a1 r) - a2 C2 (v - a2 r)) / (Iz u^2)"""
    d2: float
    """C1 / (m steering ratio)"""
    d3: float
    """a1 C1 / (Iz steering ratio)"""
    k2: float
    """dv/dt at the state less the terms above"""
    k3: float
    """dr/dt at the state less the terms above"""


def coefficients(vehicle: Vehicle, u: float, v: float, r: float, steer: float) -> Coefficients:
    """Linearise about speeds `u` > 0 and `v`, m/s, yaw rate `r`, rad/s, and `steer`, rad at the steering wheel."""
    out = np.empty(10)
    _kernel.linearise(as_record(vehicle)[0], u, v, r, steer, out)
    return Coefficients(*out.tolist())
