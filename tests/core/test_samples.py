"""The border: what gets past `Samples.make` is trusted by everything behind it."""

from dataclasses import fields
from typing import Any

import numpy as np
import pytest
from numpy.typing import ArrayLike, NDArray

import core
from core.motion import events
from core.samples import FIX_COLUMNS, SPEED, SampleError, Samples, no_rates
from core.simulation import Scenario, simulate

F_S = [[0.1, 0.2, 9.8], [0.2, 0.1, 9.7], [0.0, 0.0, 9.9], [0.1, 0.1, 9.8]]
T = [0.0, 0.1, 0.2, 0.3]
FIXES = np.arange(16.0).reshape(2, 8)


def columns(samples: Samples) -> list[NDArray[Any]]:
    given = [getattr(samples, field.name) for field in fields(samples)]
    return [values for values in given if values is not None]


def usual() -> Samples:
    return Samples.make(T, F_S, np.ones((4, 3)), [1, 3], [True, False], FIXES)


def test_columns_are_taken_over_as_they_are() -> None:
    samples = usual()
    assert len(samples) == 4
    np.testing.assert_array_equal(samples.t, T)
    np.testing.assert_array_equal(samples.f_s, F_S)
    np.testing.assert_array_equal(samples.w_s, np.ones((4, 3)))
    np.testing.assert_array_equal(samples.fix_row, [1, 3])
    np.testing.assert_array_equal(samples.fix_valid, [True, False])
    np.testing.assert_array_equal(samples.fix, FIXES)
    assert FIX_COLUMNS[SPEED] == "speed"


def test_columns_have_the_types_the_kernel_needs() -> None:
    samples = Samples.make([0, 1], [[0, 0, 10], [0, 0, 10]], fix_row=[1], fix_valid=[1], fix=[[1] * 8])
    assert [x.dtype for x in columns(samples)] == [np.float64] * 3 + [np.int64, np.bool_, np.float64]
    assert all(x.flags.c_contiguous for x in columns(samples))


def test_strided_input_becomes_contiguous() -> None:
    table = np.arange(40.0).reshape(4, 10)
    samples = Samples.make(table[:, 0], table[:, 1:4], table[:, 4:7])
    assert all(x.flags.c_contiguous for x in columns(samples))
    np.testing.assert_array_equal(samples.f_s, table[:, 1:4])


def test_gyroscope_and_fixes_may_be_missing() -> None:
    samples = Samples.make(T, F_S)
    assert samples.w_s.shape == (4, 3)
    assert np.all(np.isnan(samples.w_s))
    assert samples.fix_row.shape == samples.fix_valid.shape == (0,)
    assert samples.fix.shape == (0, 8)


def test_no_samples_at_all_are_fine() -> None:
    assert len(Samples.make([], np.empty((0, 3)))) == 0


def test_gyroscope_rows_may_be_nan_and_so_may_fix_cells() -> None:
    w_s, fix = np.full((4, 3), np.nan), np.full((2, 8), np.nan)
    samples = Samples.make(T, F_S, w_s, [0, 1], [False, True], fix)
    assert np.all(np.isnan(samples.fix))


def test_time_may_stand_still() -> None:
    assert len(Samples.make([0.0, 0.0, 0.1, 0.1], F_S)) == 4


@pytest.mark.parametrize(
    ("t", "row"), [([0, 0.1, 0.05, 0.3], 2), ([0, -1e-9, 0.1, 0.2], 1), ([3, 2, 1, 0], 1), ([0, 1, 2, 1.9], 3)]
)
def test_time_must_not_run_backwards(t: ArrayLike, row: int) -> None:
    with pytest.raises(SampleError, match="time runs backwards") as error:
        Samples.make(t, F_S)
    assert error.value.row == row


def test_the_step_back_is_told_in_seconds() -> None:
    with pytest.raises(SampleError, match=r"from 0\.2 s to 0\.05 s"):
        Samples.make([0, 0.1, 0.2, 0.05], F_S)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("row", [0, 2, 3])
def test_time_must_be_finite(bad: float, row: int) -> None:
    t = np.array(T)
    t[row] = bad
    with pytest.raises(SampleError, match="time is not a finite number") as error:
        Samples.make(t, F_S)
    assert error.value.row == row


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize(("row", "axis"), [(0, 0), (2, 1), (3, 2)])
def test_specific_force_must_be_finite(bad: float, row: int, axis: int) -> None:
    f_s = np.array(F_S)
    f_s[row, axis] = bad
    with pytest.raises(SampleError, match="specific force is not a finite number") as error:
        Samples.make(T, f_s)
    assert error.value.row == row


def test_opposite_infinities_do_not_pass() -> None:
    f_s = np.array(F_S)
    f_s[1] = [np.inf, -np.inf, 0]
    with np.errstate(invalid="ignore"), pytest.raises(SampleError, match="finite"):
        Samples.make(T, f_s)


@pytest.mark.parametrize("rows", [[3, 1], [1, 1], [-1, 1], [0, 4]])
def test_fix_rows_must_be_increasing_indices(rows: list[int]) -> None:
    with pytest.raises(SampleError, match="strictly increasing indices"):
        Samples.make(T, F_S, None, rows, [True, True], FIXES)


@pytest.mark.parametrize(
    ("t", "f_s", "w_s", "rows", "valid", "fix"),
    [
        (T[:3], F_S, None, [], [], None),
        (T, F_S[:3], None, [], [], None),
        (T, F_S, np.ones((3, 3)), [], [], None),
        (T, F_S, None, [0], [True, False], FIXES),
        (T, F_S, None, [0, 1], [True], FIXES),
        (T, F_S, None, [0, 1], [True, False], FIXES[:1]),
        (T, F_S, None, [0, 1], [True, False], None),
        ([T], F_S, None, [], [], None),
    ],
)
def test_columns_must_be_equally_long(
    t: ArrayLike, f_s: ArrayLike, w_s: ArrayLike | None, rows: ArrayLike, valid: ArrayLike, fix: ArrayLike | None
) -> None:
    with pytest.raises(SampleError, match="different lengths"):
        Samples.make(t, f_s, w_s, rows, valid, fix)


def test_a_slice_takes_its_fixes_along() -> None:
    part = usual().slice(1, 3)
    assert len(part) == 2
    np.testing.assert_array_equal(part.t, [0.1, 0.2])
    np.testing.assert_array_equal(part.fix_row, [0])
    np.testing.assert_array_equal(part.fix, FIXES[:1])


@pytest.mark.parametrize("cut", range(5))
def test_two_slices_hold_everything_once(cut: int) -> None:
    whole = usual()
    first, second = whole.slice(0, cut), whole.slice(cut, 4)
    np.testing.assert_array_equal(np.concatenate([first.t, second.t]), whole.t)
    np.testing.assert_array_equal(np.concatenate([first.f_s, second.f_s]), whole.f_s)
    np.testing.assert_array_equal(np.concatenate([first.fix_row, second.fix_row + cut]), whole.fix_row)
    np.testing.assert_array_equal(np.concatenate([first.fix_valid, second.fix_valid]), whole.fix_valid)
    np.testing.assert_array_equal(np.concatenate([first.fix, second.fix]), whole.fix)
    for part in (first, second):  # a slice would itself get past the border
        Samples.make(*columns(part))


def test_all_of_it_is_the_same_thing() -> None:
    whole = usual()
    assert whole.slice(0, len(whole)) is whole


def test_without_a_gyroscope_the_rates_are_shared_and_stay_unknown() -> None:
    drive = simulate(Scenario(seconds=120.0, seed=3, gyro=False, imu_rate=50.0)).samples
    bare = Samples.make(drive.t, drive.f_s, None, drive.fix_row, drive.fix_valid, drive.fix)
    assert np.shares_memory(bare.w_s, no_rates(1))
    state, _ = core.advance(core.DEFAULT, core.initial_state(core.DEFAULT), bare)
    core.advance(core.DEFAULT, state, bare.slice(10, len(bare)))
    events.advance(events.DEFAULT, events.initial_state(), [1.0, 0.0, 0.0, 0.0], bare)
    assert np.isnan(no_rates(1 << 15)).all()
    assert not bare.has_rates
    assert not bare.slice(10, 20).has_rates


@pytest.mark.parametrize("n", [0, 1, 1 << 15, (1 << 15) + 1])
def test_rates_that_nobody_told_are_nan_for_any_number_of_samples(n: int) -> None:
    assert no_rates(n).shape == (n, 3)
    assert np.isnan(no_rates(n)).all()


def test_rates_are_there_when_one_row_has_them() -> None:
    w_s = np.full((4, 3), np.nan)
    assert not Samples.make(T, F_S, w_s).has_rates
    w_s[2] = 0.0
    assert Samples.make(T, F_S, w_s).has_rates


def test_readings_whose_sum_is_not_finite_are_finite() -> None:
    assert len(Samples.make([-1e308, 1e308], [[1e308, 1e308, 1e308], [0.0, 0.0, 9.8]])) == 2
