"""Static start: an installer says that the vehicle stands on level ground (seed 004, static initialisation)."""

import math

import numpy as np
from numpy.typing import NDArray

from core import _kernel
from core.params import Parameters, as_record
from core.state import State

Floats = NDArray[np.float64]

STILL_TIME = 2.0
"""s without motion after which the vehicle is taken to stand still"""
STILL_CHANGE = 0.3
"""m/s2 by which the mean specific force of two seconds in a row may differ while the device is left alone"""


class NotStillError(ValueError):
    """The vehicle is not standing still, as far as the data show; the message is a sentence that says why."""


def level_start(params: Parameters, state: State) -> State:
    """Take it that the vehicle stands on level ground now.

    The mean specific force of the last two seconds then shows roll and pitch of the mounting, as well as the ground is
    level and the accelerometer unbiased; yaw remains for the drive to show. The coarse alignment takes it as one more
    pair of specific forces, the filter as a measurement of the vehicle's attitude.

    Raises
    ------
    NotStillError
        there is no data in this session, or the vehicle or the device was in motion within the last two seconds of it
    """
    force = _standing_force(state)
    state = state.copy()
    _align_with_gravity(params, state, force)
    if state.filter[0]["running"] and state.filter[0]["aligned"]:
        _level_attitude(params, state)
    return state


def _standing_force(state: State) -> Floats:
    """(3,) m/s2, mean specific force of the last two seconds."""
    clock = state.clock.copy()[0]
    t = float(clock["t"])
    if math.isnan(t):
        raise NotStillError("The device has sent no data since it was switched on.")
    if t - clock["motion_t"] < STILL_TIME:
        raise NotStillError(f"The vehicle was moving within the last {STILL_TIME:.0f} seconds of what the device sent.")
    marks = np.zeros((3, 7))
    times = t - STILL_TIME + np.array([0.0, 0.5, 1.0]) * STILL_TIME
    if not all(_kernel.integral_at(clock, time, mark) for time, mark in zip(times, marks, strict=True)):
        raise NotStillError(f"The device has sent less than {STILL_TIME:.0f} seconds of data without a gap.")
    halves = np.diff(marks[:, :3], axis=0) / (STILL_TIME / 2)
    if np.linalg.norm(halves[1] - halves[0]) > STILL_CHANGE:
        raise NotStillError(f"The device was moving within the last {STILL_TIME:.0f} seconds of what it sent.")
    return np.asarray(halves.mean(axis=0), np.float64)


def _align_with_gravity(params: Parameters, state: State, force: Floats) -> None:
    """Add the pair of standing and level specific force, weighted as the ground is level."""
    coarse, record = state.coarse[0], params.coarse
    density = max(float(coarse["noise_density"]), record.min_noise**2 * record.correlation_time)
    weight = density / (_kernel.GRAVITY * record.level_sigma) ** 2
    level = np.array([0.0, 0.0, _kernel.GRAVITY])
    coarse["time"] += weight
    coarse["k"] += weight * level
    coarse["kk"] += weight * np.outer(level, level)
    coarse["f"] += weight * force
    coarse["fk"] += weight * np.outer(force, level)
    coarse["ff"] += weight * force @ force


def _level_attitude(params: Parameters, state: State) -> None:
    """Measure roll and pitch of the vehicle as zero: scalar updates, as the kernel makes them."""
    record = state.filter[0]
    covariance, dx = record["covariance"], np.zeros(_kernel.STATES)
    up = np.zeros((3, 3))
    _kernel.rotation_matrix(record["q_nv"], up)
    for axis, angle in ((0, up[2, 1]), (1, -up[2, 0])):
        row = _kernel.ATTITUDE + axis
        gain = covariance[row] / (covariance[row, row] + params.coarse.level_sigma**2)
        dx += gain * (-angle - dx[row])
        covariance -= np.outer(gain, covariance[row].copy())
    record["covariance"] = np.tril(covariance) + np.tril(covariance, -1).T
    _kernel.fold(as_record(params)[0], record, dx, _kernel.STATES, np.zeros(1, _kernel.WORK)[0])
