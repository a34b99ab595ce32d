"""What evolves while a motion is reconstructed: one record, so that a state is its bytes. `nan` = not known yet."""

import numpy as np
from numpy.typing import NDArray

from core.motion._kernel import RING, STATES

State = NDArray[np.void]
"""(1,) `MOTION`"""

MOTION = np.dtype(
    [
        # the interval that is being averaged
        ("sample_t", "f8"),  # s, last sample
        ("interval", "i8"),  # its number since the clock began
        ("count", "i8"),
        ("gyro_count", "i8"),
        ("steer_count", "i8"),
        ("sum_t", "f8"),
        ("sum_f", "f8", (3,)),  # sensor axes
        ("sum_w", "f8", (3,)),
        ("sum_steer", "f8"),
        ("fix_waits", "?"),
        ("fix_t", "f8"),
        ("fix", "f8", (8,)),
        # the last interval
        ("t", "f8"),
        ("f_v", "f8", (3,)),  # m/s2, at the device
        ("w_v", "f8", (3,)),  # rad/s, bias taken out
        ("dw_v", "f8", (3,)),  # rad/s2
        ("gyro_t", "f8"),  # s, last interval with an angular rate
        ("steer", "f8"),  # rad, last steering angle
        ("steer_t", "f8"),
        ("smooth_w", "f8", (3,)),
        ("force", "f8", (3,)),  # m/s2, at the centre of gravity, bias taken out
        # the kinematic filter
        ("running", "?"),
        ("q_nv", "f8", (4,)),
        ("v_n", "f8", (3,)),  # m/s, of the centre of gravity
        ("place", "f8", (3,)),  # rad, rad, m: latitude, longitude, altitude
        ("placed", "?"),
        ("origin", "f8", (3,)),
        ("gyro_bias", "f8", (3,)),  # rad/s, vehicle axes
        ("bias", "f8", (3,)),  # m/s2, vehicle axes
        ("arm", "f8", (3,)),  # m, the device from the centre of gravity
        ("covariance", "f8", (STATES, STATES)),
        ("constraint_t", "f8"),
        # the past, for fixes that come late
        ("ring_t", "f8", (RING,)),
        ("ring_v", "f8", (RING, 3)),  # m/s, of the device, east, north, up
        ("ring_p", "f8", (RING, 3)),  # its place, as above
        ("ring_head", "i8"),
        ("ring_count", "i8"),
        # fixes
        ("last_fix_t", "f8"),  # s, arrival of the last valid fix
        ("fix_interval", "f8"),  # s between fixes, smoothed
        ("fix_speed", "f8"),
        ("fix_course", "f8"),
        ("fix_course_t", "f8"),
        ("course_rate", "f8"),  # rad/s, anti-clockwise
        ("fix_place", "f8", (3,)),
        ("fix_place_t", "f8"),
        ("velocity_factor", "f8"),  # variance of the velocities relative to what is stated, learnt
        ("doubted_since", "f8"),  # s, the first of the fixes not believed
        # standing, before the start
        ("rest_f", "f8", (3,)),  # m/s2, while the vehicle stood
        ("rest_t", "f8"),  # s, when it stood last
        ("impulse", "f8"),  # m/s, forward specific force since then
        # the dynamic single-track model
        ("bicycle_running", "?"),
        ("bicycle", "f8", (2,)),  # m/s lateral velocity, rad/s yaw rate
        ("bicycle_covariance", "f8", (2, 2)),
    ]
)


def initial_state() -> State:
    """Give the state at the beginning of a session: nothing is known."""
    state = np.zeros(1, MOTION)
    for name in (
        "sample_t", "t", "gyro_t", "steer", "steer_t", "last_fix_t", "fix_speed", "fix_course", "fix_course_t",
        "fix_place_t", "doubted_since", "rest_t", "origin", "fix_place", "place", "constraint_t", "arm",
    ):  # fmt: skip
        state[name] = np.nan
    state["fix_interval"] = state["velocity_factor"] = 1.0
    state["q_nv"][0, 0] = 1.0
    return state
