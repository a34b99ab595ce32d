"""What the speeds of docs/performance.md compare does the same work."""

from functools import cache

import numpy as np
import pytest

import core
from benchmarks.kernel_speed.drives import Chunk, collect_epochs
from benchmarks.kernel_speed.steps import Model, filterpy_filter, model_of, numpy_joseph_step, numpy_step, walk
from core.params import as_record
from core.simulation import Scenario, simulate

STEPS = [numpy_step, numpy_joseph_step]


@cache
def driven(gyro: bool) -> tuple[core.State, "np.ndarray[tuple[int], np.dtype[np.void]]"]:
    """A running filter, and epochs that follow."""
    samples = simulate(Scenario(seconds=150.0, seed=1, gyro=gyro, latency=0.2)).samples
    cut = int(samples.fix_row[-60]) + 1
    state, _ = core.advance(core.DEFAULT, core.initial_state(core.DEFAULT), samples.slice(0, cut))
    assert state.filter["running"][0]
    return state, collect_epochs(Chunk(state, samples.slice(cut, len(samples))))


def model(gyro: bool) -> Model:
    state, epochs = driven(gyro)
    return model_of(state.filter, epochs[:1])


@pytest.mark.parametrize("step", STEPS)
@pytest.mark.parametrize("gyro", [False, True])
def test_the_numpy_step_is_that_of_filterpy(gyro: bool, step: type) -> None:
    m = model(gyro)
    kalman = filterpy_filter(m)
    x, p = m.x, m.p
    for _ in range(5):
        x, p = step(x, p, m)
        kalman.predict()
        kalman.update(m.z)
    np.testing.assert_allclose(x, kalman.x, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(p, kalman.P, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize(("gyro", "size"), [(False, (8, 22)), (True, (11, 29))])
def test_the_matrices_are_those_the_kernel_stands_for(gyro: bool, size: tuple[int, int]) -> None:
    state, epochs = driven(gyro)
    m = model(gyro)
    assert m.h.shape == size
    params, filters, n = as_record(core.DEFAULT), state.filter.copy(), size[1]
    params["filter_gate"] = np.inf
    walk(params, filters, epochs[:1], n)
    _, p = numpy_step(m.x, m.p, m)
    np.testing.assert_allclose(filters["covariance"][0, :n, :n], p, rtol=1e-9, atol=1e-9)
