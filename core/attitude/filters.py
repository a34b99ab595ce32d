"""The attitude filters: one interface, streaming.

    ekf = FILTERS["ekf"]
    state = initial_state(ekf.params)
    state, attitudes = ekf.advance(ekf.params, state, samples)

Samples in any pieces give the same attitudes as at once. Gaps, readings that are none, free fall and a vertical
magnetic field leave an attitude that is a rotation; without a magnetometer heading is relative to the start.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.attitude import _kernel
from core.attitude.params import DEFAULT, LINEAR, MADGWICK, QUEST_EKF, Parameters, as_record
from core.samples import Samples

Floats = NDArray[np.float64]
State = NDArray[np.void]
"""(1,) what evolves, a record of `_kernel.STATE`."""

_NO_FIELD, _NO_PRESSURE = np.empty((0, 3)), np.empty(0)


class Attitudes(NamedTuple):
    """Attitude at N moments. SI units, radians."""

    t: Floats
    """(N,) s on the session's clock"""
    q_ns: Floats
    """(N, 4) sensor to local level; y is magnetic north, without a magnetometer a heading relative to the start"""
    gyro_bias: Floats
    """(N, 3) rad/s, sensor axes"""
    altitude: Floats
    """(N,) m above the sea in the standard atmosphere, nan before the first reading of the pressure"""
    sigma: Floats
    """(N, 3) rad, 1 sigma of the small rotation about east, north and up, nan where the filter has none"""
    field_trusted: NDArray[np.bool_]
    """(N,) where the magnetic field is taken for the Earth's"""


class Filter(NamedTuple):
    """A filter and the parameters it works best with."""

    method: int
    params: Parameters
    follows_field: bool
    """whether a magnetometer keeps its heading; else that of the start is carried on by the gyroscope"""

    def advance(self, params: Parameters, state: State, samples: Samples) -> tuple[State, Attitudes]:
        """Take the state through further samples of the same session, and give the attitude at each of them."""
        n, state = len(samples), state.copy()
        found = Attitudes(
            samples.t, np.empty((n, 4)), np.empty((n, 3)), np.empty(n), np.empty((n, 3)), np.empty(n, np.bool_)
        )
        _kernel.run(
            self.method,
            as_record(params)[0],
            state[0],
            np.zeros(_kernel.SCRATCH),
            samples.t,
            samples.f_s,
            samples.w_s,
            _NO_FIELD if samples.m_s is None else samples.m_s,
            _NO_PRESSURE if samples.pressure is None else samples.pressure,
            *found[1:],
        )
        return state, found

    def run(self, samples: Samples) -> tuple[State, Attitudes]:
        """Go through a whole session with the filter's own parameters."""
        return self.advance(self.params, initial_state(self.params), samples)


FILTERS: Mapping[str, Filter] = {
    "gyro": Filter(_kernel.GYRO, DEFAULT, follows_field=False),
    "linear": Filter(_kernel.LINEAR, LINEAR, follows_field=False),
    "ekf": Filter(_kernel.EKF, DEFAULT, follows_field=True),
    "madgwick": Filter(_kernel.MADGWICK, MADGWICK, follows_field=True),
    "quest-ekf": Filter(_kernel.QUEST_EKF, QUEST_EKF, follows_field=True),
}
"""001 6.1 `linear` and 6.3 `ekf`; 003 4.2 `madgwick`, 4.3 `quest-ekf`, and fig. 12 `gyro`, integration alone."""


def initial_state(params: Parameters) -> State:
    """Give the state before the first sample."""
    state = np.zeros(1, _kernel.STATE)
    state["t"] = state["sigma"] = state["altitude"] = np.nan
    state["q"] = state["turned"] = (1.0, 0.0, 0.0, 0.0)
    state["rate_variance"] = params.rate_motion**2
    return state


def has_compass(state: State) -> bool:
    """Tell whether a magnetometer gave a heading."""
    return bool(state["compass"][0])
