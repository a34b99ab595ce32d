"""The door to the reconstruction of a motion: `advance(params, vehicle, state, q_vs, samples) -> (state, Motion)`.

The method with its equations is in docs/motion.md, its machine code in `_kernel`.
"""

import math

import numpy as np
from numpy.typing import ArrayLike

from core import quaternion
from core.motion import _kernel
from core.motion.motion import Floats, Motion, Origin
from core.motion.params import DEFAULT, Parameters
from core.motion.params import as_record as params_record
from core.motion.state import State, initial_state
from core.motion.vehicle import Vehicle
from core.motion.vehicle import as_record as vehicle_record
from core.samples import Samples


def advance(
    params: Parameters, vehicle: Vehicle, state: State, q_vs: ArrayLike, samples: Samples
) -> tuple[State, Motion]:
    """Take the next samples of a session.

    A drive in any pieces gives bit for bit what the drive at once gives. A row averages the samples of one interval of
    `params.rate`; the last interval is told when the first sample after it has come.

    Parameters
    ----------
    params
        the same for all pieces of a drive
    vehicle
        what is known of the vehicle
    state
        state after the samples before, from `initial_state()`; not changed
    q_vs
        (4,) mounting
    samples
        samples that follow; those not newer than the last one are passed over
    """
    state = np.frombuffer(bytearray(state.tobytes()), state.dtype)
    rows = np.empty((_row_limit(params, samples), _kernel.ROW))
    steer = np.full(0, np.nan) if samples.steer is None else samples.steer
    count = _kernel.run(
        params_record(params),
        vehicle_record(vehicle),
        state,
        quaternion.matrix(quaternion.normalise(q_vs)),
        samples.t,
        samples.f_s,
        samples.w_s,
        steer,
        samples.fix_row,
        samples.fix_valid,
        samples.fix,
        rows,
    )
    return state, _motion(state, rows[:count])


def reconstruct(vehicle: Vehicle, q_vs: ArrayLike, samples: Samples, params: Parameters = DEFAULT) -> Motion:
    """Reconstruct the motion of a whole session; arguments as in `advance`."""
    return advance(params, vehicle, initial_state(), q_vs, samples)[1]


def _row_limit(params: Parameters, samples: Samples) -> int:
    if not len(samples):
        return 0
    return min(len(samples), math.floor(float(samples.t[-1] - samples.t[0]) * params.rate) + 2)


def _motion(state: State, rows: Floats) -> Motion:
    """Name the columns; the order is that of `_kernel.write_row`."""
    origin = state["origin"][0]
    known = bool(state["placed"][0])
    return Motion(
        t=rows[:, 0].copy(),
        q_nv=rows[:, 1:5].copy(),
        a_v=rows[:, 5:8].copy(),
        w_v=rows[:, 8:11].copy(),
        velocity_v=rows[:, 11:13].copy(),
        velocity_sigma=rows[:, 13:15].copy(),
        sideslip=rows[:, 15].copy(),
        sideslip_sigma=rows[:, 16].copy(),
        position_n=rows[:, 17:20].copy(),
        position_sigma=rows[:, 20].copy(),
        dead_reckoned=rows[:, 21] > 0,
        origin=Origin(*(float(x) for x in origin)) if known else None,
    )
