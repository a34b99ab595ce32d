"""What evolves: one structured array of shape (1,) per stage, so that a state is its bytes.

Angles in radians, SI units. `nan` marks what is not known yet. A record's fields are the words used in the kernel.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core._kernel import MERGED, STATES

RING = 50
"""points of the integrated IMU signal kept, 0.1 s or one sample apart: the longest epoch plus the longest latency"""
AVERAGE_EPOCHS = 100
"""n of the moving average (thesis 5.3)"""
MAX_LATENCIES = 9
LOOKS = 40
"""looks kept as evidence"""

CLOCK = np.dtype(
    [
        ("t", "f8"),  # s, last IMU sample
        ("f_s", "f8", (3,)),  # m/s2, last sample
        ("w_s", "f8", (3,)),  # rad/s, last sample, zero where missing
        ("no_gyro", "f8"),  # 1 when the last sample had no angular rate
        ("integral", "f8", (7,)),  # of f_s (m/s), w_s (rad) and no_gyro (s) since the chain began
        ("ring_t", "f8", (RING,)),
        ("ring", "f8", (RING, 7)),  # the integral at ring_t
        ("ring_head", "i8"),  # slot of the newest point
        ("ring_count", "i8"),
        ("fix_t", "f8"),  # s, the fix that began the current epoch, nan = none
        ("fix_speed", "f8"),
        ("fix_course", "f8"),  # rad clockwise from north, nan = unknown
        ("fix_integral", "f8", (7,)),  # the integral at fix_t
        ("climb", "f8"),  # m/s, smoothed
        ("altitude_t", "f8"),  # s, last altitude
        ("altitude", "f8"),  # m, smoothed, nan = unknown
        ("position_t", "f8"),  # s, last position, for receivers that give no velocity
        ("latitude", "f8"),
        ("longitude", "f8"),
        ("valid_fix_t", "f8"),  # s, last valid fix, nan = none in this session
        ("motion_t", "f8"),  # s, last time in motion, nan = never in this session
        ("travel_course", "f8"),  # rad, last course in motion
        ("slow_since", "?"),  # the vehicle was slow since then
        ("reversing", "?"),
        ("next_report", "f8"),  # s
        ("repeats", "i8", (3,)),  # samples for which each axis has repeated itself
        ("flat_tops", "i8"),  # samples of the epoch at the end of the range
        ("samples", "i8"),  # of the epoch
    ]
)

COARSE = np.dtype(
    [
        ("time", "f8"),  # s, sum of the weights (epoch lengths)
        ("k", "f8", (3,)),  # sum of kinematic specific force k_v
        ("kk", "f8", (3, 3)),
        ("f", "f8", (MAX_LATENCIES, 3)),  # sum of f_s, per latency hypothesis
        ("fk", "f8", (MAX_LATENCIES, 3, 3)),  # sum of f_s k_v'
        ("ff", "f8", (MAX_LATENCIES,)),  # sum of |f_s|^2
        ("gyro_time", "f8"),
        ("r", "f8"),  # sum of the yaw rate from the course
        ("rr", "f8"),
        ("w", "f8", (MAX_LATENCIES, 3)),  # sum of w_s
        ("wr", "f8", (MAX_LATENCIES, 3)),
        ("ww", "f8", (MAX_LATENCIES,)),
        ("noise_density", "f8"),  # (m/s2)^2 s, residual variance times correlation time
        ("hypothesis", "i8"),  # the latency in use
        ("latency", "f8"),  # s, refined between hypotheses
        ("mirror", "f8"),  # log likelihood ratio of mirrored to right-handed axes
        ("costs", "f8", (MAX_LATENCIES,)),  # -2 log likelihood of each latency above the best
        ("solved_time", "f8"),  # value of `time` at the last solution, nan = no solution
        ("q_vs", "f8", (4,)),
        ("bias", "f8", (3,)),  # m/s2, sensor frame
        ("covariance", "f8", (3, 3)),  # rad2, about the vehicle axes
    ]
)

FILTER = np.dtype(
    [
        ("running", "?"),
        ("aligned", "?"),  # heading was started from the course
        ("refined", "?"),  # started once more, near the right mounting
        ("gyro", "?"),  # angular rates were seen
        ("speed", "f8"),
        ("acceleration", "f8"),
        ("yaw_rate", "f8"),
        ("yaw_rate_before", "f8"),  # at the beginning of the epoch
        ("last_forward", "f8"),  # m/s2, forward acceleration of the epoch before
        ("last_lateral", "f8"),  # m/s2
        ("gradient", "f8", (2,)),  # rad/m, change of the road's bank and grade with the distance
        ("bounce", "f8", (2,)),  # rad, roll and pitch of the body on its springs at the end of the epoch
        ("bounce_before", "f8", (2,)),  # rad, at its beginning
        (
            "noise_factor",
            "f8",
            (4,),
        ),  # variance of velocity, altitude, specific force, velocity of late relative to the usual, learnt
        ("road_variance", "f8", (2,)),  # rad2, of bank and grade, learnt
        ("q_nv", "f8", (4,)),
        ("q_vs", "f8", (4,)),
        ("bias", "f8", (3,)),  # m/s2, accelerometer, sensor frame
        ("gyro_bias", "f8", (3,)),  # rad/s
        ("lever_arm", "f8", (2,)),  # m, the device ahead and to the left of the turning point
        ("antenna", "f8"),  # m, the antenna ahead of the device
        ("latency", "f8"),  # s, of the fixes
        ("suspension", "f8", (2,)),  # rad s2/m, pitch and roll per acceleration
        ("altitude", "f8"),  # m, nan = unknown
        ("covariance", "f8", (STATES, STATES)),
    ]
)

SETTLING = np.dtype(
    [
        ("ring", "f4", (AVERAGE_EPOCHS, 4)),
        ("head", "i8"),
        ("count", "i8"),
        ("average", "f8", (4,)),
        ("forward_excitation", "f8"),  # m2/s3
        ("lateral_excitation", "f8"),  # m2/s3
        ("stable", "?"),
        ("reliable", "?"),
        ("agrees", "?"),  # second opinion
        ("right_handed", "?"),  # turning has shown that the axes are no mirror image
        ("progress", "f8"),
        ("confirmed", "?"),
        ("mount_t", "f8"),
        ("mount_q_vs", "f8", (4,)),
        ("mount_sigma", "f8", (3,)),
        ("mount_error", "f8"),  # m/s, of its drive test
        ("mount_limit", "f8"),  # m/s
        ("mount_elapsed", "f8"),  # s
        ("has_mount", "?"),
        ("suspect", "?"),
    ]
)

VERIFICATION = np.dtype(
    [
        ("state", "i8"),  # 0 idle, 1 running, 2 passed, 3 failed
        ("q_vs", "f8", (4,)),  # candidate
        ("bias", "f8", (3,)),  # m/s2, that belongs to the candidate
        ("sigma", "f8", (3,)),
        ("elapsed", "f8"),  # s of driving
        ("distance", "f8"),  # m
        ("excess", "f8"),  # m/s, integrated specific force minus what the GPS shows (thesis)
        ("impulse", "f8", (3,)),  # m2/s2, integral of speed times specific force, sensor frame
        ("energy", "f8"),  # m2/s2, kinetic energy gained
        ("height", "f8"),  # m gained
        ("turning", "f8"),  # m/s2, integral of speed times squared yaw rate
        ("altitude", "f8"),  # m, at the last epoch
        ("error", "f8"),  # m/s
        ("limit", "f8"),  # m/s
    ]
)

CHANGE = np.dtype(
    [
        ("state", "i8"),  # 0 idle, 1 watching, 2 suspicious
        ("reference", "f8", (4,)),  # q_vs the challenger is compared with
        ("covariance", "f8", (3, 3)),  # rad2, of the reference
        ("ratio", "f8"),  # noise ratio when the watch began
        ("age", "f8"),  # s of motion since the challenger began
        ("excitation", "f8"),  # m2/s3, since the challenger began
        ("looked", "f8"),  # s, age at the last look
        ("quiet", "f8"),  # s of motion without acceleration
        ("guilty", "i8"),  # looks in a row that speak against the mounting
        ("innocent_t", "f8"),  # s, last time nothing spoke against the mounting
        ("series", "f4", (LOOKS, 2)),  # s, squared Mahalanobis distance
        ("series_head", "i8"),
        ("series_count", "i8"),
    ]
)


FAULTS = np.dtype(
    [
        ("t", "f8"),  # s, last look
        ("stuck_time", "f8", (3,)),  # s of motion for which each axis has repeated itself
        ("saturation", "f8"),  # s of late with readings at the end of the range
        ("restlessness", "f8"),  # changes of the mounting, fading with time
        ("restless_t", "f8"),  # s, the last of them
        ("reported", "i8"),  # a bit for each fault that goes on
    ]
)


class State(NamedTuple):
    """State of one device's estimator: structured arrays of shape (1,) but for the filter."""

    clock: NDArray[np.void]
    coarse: NDArray[np.void]
    merged: NDArray[np.void]
    """the epoch the coarse alignment is collecting, a `MERGED` record"""
    filter: NDArray[np.void]
    """shape (2,): the filter, and the challenger that watches for an orientation change"""
    settling: NDArray[np.void]
    verification: NDArray[np.void]
    change: NDArray[np.void]
    faults: NDArray[np.void]

    def copy(self) -> "State":
        """Give an independent copy."""
        return State(*(independent(part.tobytes(), part.dtype) for part in self))


def independent(data: bytes, dtype: np.dtype[np.void]) -> NDArray[np.void]:
    """Give the records of these bytes in memory of their own; numpy's `copy` takes 20 times as long, field by field."""
    return np.frombuffer(bytearray(data), dtype)


LAYOUT = State(CLOCK, COARSE, MERGED, FILTER, SETTLING, VERIFICATION, CHANGE, FAULTS)  # type: ignore[arg-type]
"""The dtype of each part."""


def empty_clock() -> NDArray[np.void]:
    """Clock at the beginning of a session: nothing known."""
    clock = np.zeros(1, CLOCK)
    for name in (
        "t", "fix_t", "fix_speed", "fix_course", "altitude_t", "altitude", "position_t",
        "latitude", "longitude", "valid_fix_t", "motion_t", "travel_course", "next_report",
    ):  # fmt: skip
        clock[name] = np.nan
    return clock


def empty_coarse() -> NDArray[np.void]:
    """Accumulators of a coarse alignment that has seen nothing."""
    coarse = np.zeros(1, COARSE)
    coarse["solved_time"] = np.nan
    coarse["q_vs"][0, 0] = 1.0
    return coarse


def empty_state() -> State:
    """State of a device nothing is known of."""
    state = State(
        empty_clock(),
        empty_coarse(),
        np.zeros(1, MERGED),
        np.zeros(2, FILTER),
        np.zeros(1, SETTLING),
        np.zeros(1, VERIFICATION),
        np.zeros(1, CHANGE),
        np.zeros(1, FAULTS),
    )
    state.filter["q_nv"][:, 0] = state.filter["q_vs"][:, 0] = 1.0
    state.settling["average"][0, 0] = 1.0
    state.filter["altitude"] = np.nan
    return state
