"""What the speeds of docs/performance.md compare does the same work."""

from functools import cache, partial

import numpy as np
import pytest

import core
from benchmarks.kernel_speed.drives import Chunk, collect_epochs
from benchmarks.kernel_speed.page import verdicts
from benchmarks.kernel_speed.steps import (
    Minute,
    fullest,
    model_of,
    numpy_joseph_step,
    numpy_step,
    repeat_filterpy,
    repeat_numpy,
    through,
    usual,
)
from benchmarks.kernel_speed.timing import Contender, Timing, in_turn
from core.simulation import Scenario, simulate


@cache
def minute(gyro: bool, full: bool) -> Minute:
    """A running filter, and epochs that follow."""
    samples = simulate(Scenario(seconds=120.0, seed=1, gyro=gyro, latency=0.2)).samples
    cut = int(samples.fix_row[-60]) + 1
    state, _ = core.advance(core.DEFAULT, core.initial_state(core.DEFAULT), samples.slice(0, cut))
    assert state.filter["running"][0]
    epochs = collect_epochs(Chunk(state, samples.slice(cut, len(samples))))
    return (fullest if full else usual)(state.filter, epochs)


@pytest.mark.parametrize("joseph", [False, True])
@pytest.mark.parametrize("full", [False, True])
@pytest.mark.parametrize("gyro", [False, True])
def test_the_numpy_step_is_that_of_filterpy(gyro: bool, full: bool, joseph: bool) -> None:
    model = model_of(minute(gyro, full))
    p = repeat_numpy(numpy_joseph_step if joseph else numpy_step, model, 5)
    kalman = repeat_filterpy(model, 5)
    np.testing.assert_allclose(p, kalman.P, rtol=1e-9, atol=1e-9)
    x, _ = (numpy_joseph_step if joseph else numpy_step)(model.x, model.p, model)
    np.testing.assert_allclose(x, repeat_filterpy(model, 1).x, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize(
    ("gyro", "full", "size"),
    [(False, False, (6, 22)), (True, False, (9, 29)), (False, True, (9, 22)), (True, True, (12, 29))],
)
def test_the_matrices_are_those_the_kernel_stands_for(gyro: bool, full: bool, size: tuple[int, int]) -> None:
    whole = minute(gyro, full)
    first = Minute(whole.params.copy(), whole.filters, whole.epochs[:1])
    first.params["filter_gate"] = np.inf  # no matrix stands for that
    model = model_of(first)
    assert model.h.shape == size
    kernel = through(first)["covariance"][0, : size[1], : size[1]]
    np.testing.assert_allclose(kernel, repeat_numpy(numpy_step, model, 1), rtol=1e-9, atol=1e-12)


def test_contenders_are_timed_in_turn_and_per_unit_of_work() -> None:
    calls: list[str] = []
    timed = in_turn({name: Contender(partial(calls.append, name), 10) for name in "ab"}, 3)
    assert calls[:2] == ["a", "b"]
    assert all(set(calls[i : i + 2]) == {"a", "b"} for i in range(0, 8, 2))
    assert len(calls) == 8
    assert all(0 <= timing.least <= timing.median for timing in timed.values())


@pytest.mark.parametrize(("median", "met"), [(1.49e-3, True), (1.51e-3, False)])
def test_the_median_decides_whether_a_target_is_met(median: float, met: bool) -> None:
    assert [target.met for target in verdicts({("no gyro", "confirmed"): Timing(median, 1e-3)}, {})] == [met]
