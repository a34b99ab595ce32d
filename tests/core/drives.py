"""Simulated drives shared by the tests of core, made once; slow sampling so that the uncompiled kernel keeps up."""

import dataclasses
import os
from functools import cache

import numpy as np
from numpy.typing import NDArray

from core import DEFAULT, Outcome, Parameters, Samples, State, advance, initial_state
from core.quaternion import from_rotation_vector, matrix, multiply, random
from core.simulation import Drive, Scenario, simulate

Floats = NDArray[np.float64]

UNCOMPILED = os.environ.get("NUMBA_DISABLE_JIT") == "1"
RATE = 10.0 if UNCOMPILED else 50.0
"""Hz; the uncompiled kernel, run to see its coverage, is three hundred times slower"""
SCENARIOS = {
    "city": Scenario(route="city", seconds=400.0, seed=3, imu_rate=RATE, sensor="mems"),
    "city without gyro": Scenario(route="city", seconds=400.0, seed=4, imu_rate=RATE, sensor="tmd2"),
    "short": Scenario(route="city", seconds=90.0, seed=5, imu_rate=20.0, sensor="mems"),
    "parked": Scenario(route="parked", seconds=120.0, seed=6, imu_rate=20.0),
}


@cache
def drive(name: str) -> Drive:
    return simulate(SCENARIOS[name])


@cache
def remounted() -> Drive:
    """Town driving in which the device falls over by 25 deg after 400 s."""
    before = random(np.random.default_rng(8))
    after = multiply(from_rotation_vector(np.radians(25) * np.array([0.6, 0.8, 0.0])), before)
    return simulate(
        dataclasses.replace(
            SCENARIOS["city"], seconds=900.0, seed=7, imu_rate=RATE, mount=before, remount=(400.0, after)
        )
    )


@cache
def result(name: str) -> tuple[State, Outcome]:
    """Final state and outcome of a drive with the preset `default`."""
    return run(drive(name).samples)


@cache
def remounted_result() -> tuple[State, Outcome]:
    return run(remounted().samples)


def run(samples: Samples, params: Parameters = DEFAULT) -> tuple[State, Outcome]:
    return advance(params, initial_state(params), samples)


def turned(samples: Samples, q: Floats) -> Samples:
    """What a device turned by `q` would have recorded."""
    return dataclasses.replace(samples, f_s=samples.f_s @ matrix(q).T, w_s=samples.w_s @ matrix(q).T)
