"""Devices that have been driving for a minute or more, and the epochs of their next minute."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

import core
from core import Samples, Stage, State, _kernel
from core.params import as_record
from core.simulation import Scenario, simulate
from core.state import LOOKS

CHUNK = 60.0
"""s"""
IMU_RATE = 200.0
"""Hz"""
GPS_RATE = 4.0
"""Hz"""
MINUTES = 10
FEWEST_EPOCHS = 100
"""in motion, of the 120 of a minute: the vehicle hardly stands"""
SEEDS = range(50)


class Chunk(NamedTuple):
    """A minute of driving, and the state the device is in when it arrives."""

    state: State
    samples: Samples


class Drive(NamedTuple):
    """A minute before the mounting is confirmed, and one in which the challenger watches over it."""

    settling: Chunk
    confirmed: Chunk


def find_drive(gyro: bool) -> Drive:
    """Give the first simulated town drive that has both kinds of minutes, mostly in motion."""
    for seed in SEEDS:
        scenario = Scenario(
            seconds=CHUNK * MINUTES, seed=seed, gyro=gyro, imu_rate=IMU_RATE, gps_rate=GPS_RATE, latency=0.2
        )
        drive = _choose(_minutes(simulate(scenario).samples))
        if drive:
            return drive
    raise RuntimeError("no drive has both kinds of minutes")


def _minutes(samples: Samples) -> list[Chunk]:
    """Every minute with the state before it, and an empty last one."""
    state, chunks = core.initial_state(core.DEFAULT), []
    for minute in range(MINUTES + 1):
        first, last = np.searchsorted(samples.t, [minute * CHUNK, (minute + 1) * CHUNK])
        chunks.append(Chunk(state, samples.slice(int(first), int(last))))
        state, _ = core.advance(core.DEFAULT, state, chunks[-1].samples)
    return chunks


def _choose(chunks: list[Chunk]) -> Drive | None:
    stages = [core.status(core.DEFAULT, chunk.state).stage for chunk in chunks]
    watching = [int(chunk.state.change["state"][0]) == _kernel.WATCHING for chunk in chunks]
    whole = range(1, len(chunks) - 1)
    driven = [i for i in whole if len(collect_epochs(chunks[i])) >= FEWEST_EPOCHS]
    settling = [i for i in driven if stages[i] >= Stage.SETTLING and stages[i + 1] < Stage.CONFIRMED]
    confirmed = [i for i in driven if watching[i] and watching[i + 1] and stages[i] == stages[i + 1] == Stage.CONFIRMED]
    return Drive(chunks[settling[-1]], chunks[confirmed[-1]]) if settling and confirmed else None


def collect_epochs(chunk: Chunk) -> NDArray[np.void]:
    """Give the epochs in motion as the filter meets them: the minute is fed fix by fix to see each.

    Returns
    -------
    (N,) records `EPOCH`
    """
    params, state, samples = as_record(core.DEFAULT), chunk.state.copy(), chunk.samples
    epochs, first = [], 0
    for row in samples.fix_row:
        piece = samples.slice(first, int(row) + 1)
        first = int(row) + 1
        epoch = np.zeros(1, _kernel.EPOCH)
        rows, events, speeds = np.zeros((2 * len(piece), 14)), np.zeros((16, 18)), np.empty((1, 4))
        work = np.zeros(1, _kernel.WORK)
        outputs = (rows, events, np.empty((16, LOOKS, 2)), speeds, np.zeros(4, np.int64))
        _kernel.run(
            params,
            *state,
            epoch,
            work,
            piece.t,
            piece.f_s,
            piece.w_s,
            piece.fix_row,
            piece.fix_valid,
            piece.fix,
            *outputs,
        )
        if epoch["usable"][0] and epoch["moving"][0] and np.isfinite(epoch["yaw_rate"][0]):
            epochs.append(epoch)
    return np.concatenate(epochs) if epochs else np.zeros(0, _kernel.EPOCH)
