"""The attitude filters: one interface, streaming.

    state = initial_state(DEFAULT)
    state, attitudes = FILTERS["ekf"].advance(DEFAULT, state, samples)

Samples in any pieces give the same attitudes as at once. Gaps, readings that are none, free fall and a vertical magnetic
field leave an attitude that is a rotation; without a magnetometer heading is relative to the start.
"""

from collections.abc import Mapping
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from core.attitude import _kernel
from core.attitude.params import Parameters, as_record
from core.samples import Samples

Floats = NDArray[np.float64]
State = NDArray[np.void]
"""(1,) what evolves, a record of `_kernel.STATE`."""


class Attitudes(NamedTuple):
    """Attitude at N moments. SI units, radians."""

    t: Floats
    """(N,) s on the session's clock"""
    q_ns: Floats
    """(N, 4) sensor to local level; y is magnetic north, or without a magnetometer where the sensor's x axis pointed"""
    gyro_bias: Floats
    """(N, 3) rad/s, sensor axes"""
    altitude: Floats
    """(N,) m above the sea in the standard atmosphere, nan before the first reading of the pressure"""
    sigma: Floats
    """(N, 3) rad, 1 sigma of the small rotation about east, north and up, nan where the filter has none"""
    field_trusted: NDArray[np.bool_]
    """(N,) where the magnetic field is taken for the Earth's"""


def initial_state(params: Parameters) -> State:
    """Give the state before the first sample."""
    del params
    state = np.zeros(1, _kernel.STATE)
    state["t"] = state["sigma"] = state["altitude"] = np.nan
    state["q"] = state["turned"] = (1.0, 0.0, 0.0, 0.0)
    return state


class Filter(Protocol):
    """Takes the state through samples of the same session: `(params, state, samples) -> (state, attitudes)`."""

    def __call__(self, params: Parameters, state: State, samples: Samples) -> tuple[State, Attitudes]: ...


def _advance(method: int, params: Parameters, state: State, samples: Samples) -> tuple[State, Attitudes]:
    n, state = len(samples), state.copy()
    found = Attitudes(
        samples.t, np.empty((n, 4)), np.empty((n, 3)), np.empty(n), np.empty((n, 3)), np.empty(n, np.bool_)
    )
    field = np.empty((0, 3)) if samples.m_s is None else samples.m_s
    pressure = np.empty(0) if samples.pressure is None else samples.pressure
    _kernel.run(
        method, as_record(params)[0], state[0], np.zeros((20, 7)),
        samples.t, samples.f_s, samples.w_s, field, pressure,
        found.q_ns, found.gyro_bias, found.altitude, found.sigma, found.field_trusted,
    )
    return state, found
