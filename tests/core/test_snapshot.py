from collections.abc import Callable

import numpy as np
import pytest

import core
from core import SnapshotError, decode, encode
from core.simulation import Scenario, simulate
from core.snapshot import SIZE
from tests.core.drives import drive, result, run


def test_round_trip_and_size() -> None:
    state, _ = result("short")
    data = encode(state)
    assert len(data) == SIZE <= 16_000
    assert encode(decode(data)) == data


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda data: b"", "not an estimator snapshot"),
        (lambda data: b"GIF89a" + data[6:], "not an estimator snapshot"),
        (lambda data: data[:4] + b"\xff\x00" + data[6:], "format version 255"),
        (lambda data: data[:6] + b"otherlay" + data[14:], "cannot be read"),
        (lambda data: data[:-1], "expected"),
    ],
)
def test_other_bytes_are_refused(spoil: Callable[[bytes], bytes], message: str) -> None:
    state, _ = result("short")
    with pytest.raises(SnapshotError, match=message):
        decode(spoil(encode(state)))


def test_a_decoded_state_can_be_advanced_without_touching_the_bytes() -> None:
    state, _ = run(drive("short").samples.slice(0, 500))
    data = encode(state)
    loaded = decode(data)
    loaded.clock["t"] = 1.0
    assert encode(decode(data)) == data


@pytest.mark.parametrize("gyro", [False, True])
@pytest.mark.parametrize("params", core.PRESETS.values(), ids=core.PRESETS)
def test_one_triangle_of_a_covariance_is_enough(params: core.Parameters, gyro: bool) -> None:
    samples = simulate(Scenario(seconds=400.0, seed=5, gyro=gyro, imu_rate=50.0)).samples
    state = core.initial_state(params)
    for first in range(0, len(samples), 500):
        state, _ = core.advance(params, state, samples.slice(first, min(first + 500, len(samples))))
        for covariance in state.filter["covariance"]:
            np.testing.assert_array_equal(covariance, covariance.T)
    assert state.filter["running"][0]
