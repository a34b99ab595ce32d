"""The short way of an Arrow batch against the long one."""

from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from api.formats import arrow_quick, arrow_stream, native
from api.formats.arrow_scale import Scale, Scales
from api.formats.delimited import Floats, Table
from api.formats.native import ACCELERATION, GPS, VELOCITY, Packed
from tests.formats.test_native_rules import chunks, sound_columns

HUGE = 1e300
WHOLE = frozenset({0.0, 1.0})
NO_SCALES: Scales = {}
SOUND = sound_columns({*GPS, *VELOCITY})
SOUND_TABLE = Table(tuple(SOUND), np.array(list(SOUND.values())))


def batch(table: Table, kind: pa.DataType, milliseconds: bool = False) -> pa.RecordBatch:
    """Give columns as a device sends them: nan as null, in whole numbers what can be."""
    columns = {name: pa.array(values, from_pandas=True).cast(kind) for name, values in table.columns.items()}
    fix = table.columns["fix"]
    if WHOLE.issuperset(fix[~np.isnan(fix)].tolist()):
        columns["fix"] = columns["fix"].cast(pa.int8())
    if milliseconds:
        seconds = np.nan_to_num(columns.pop("t").to_numpy(zero_copy_only=False).astype(np.float64))
        columns["t_ms"] = pa.array(1e3 * np.clip(seconds, -1e9, 1e9))
    return pa.RecordBatch.from_pydict(columns)


def quickly(sent: pa.RecordBatch, scales: Scales = NO_SCALES) -> Packed | None:
    plan = arrow_quick.Plan.of(sent.schema, scales)
    return None if plan is None else arrow_quick.pack(sent, plan)


def the_long_way(sent: pa.RecordBatch, scales: Scales = NO_SCALES) -> Packed | None:
    return native._pack(arrow_stream._table(pa.Table.from_batches([sent]), scales))


def assert_same(quick: Packed, long: Packed | None) -> None:
    assert long is not None
    for got, expected in zip(quick, long, strict=True):
        assert (got is None) == (expected is None)
        if got is not None and expected is not None:
            assert (got.dtype, got.flags.c_contiguous) == (expected.dtype, expected.flags.c_contiguous)
            np.testing.assert_array_equal(got, expected)


@settings(max_examples=1500, deadline=None)
@given(chunks(), st.sampled_from([pa.float32(), pa.float64()]), st.booleans())
@example(SOUND_TABLE, pa.float64(), False)
def test_both_ways_give_the_same(table: Table, kind: pa.DataType, milliseconds: bool) -> None:
    sent = batch(table, kind, milliseconds)
    quick = quickly(sent)
    if quick is not None:
        assert_same(quick, the_long_way(sent))
    else:
        assert the_long_way(sent) is None or any(is_odd(column) for column in table.columns.values())


def is_odd(column: Floats) -> bool:
    """Tell of a column with gaps, or with numbers whose sum may not be finite."""
    return bool(np.isnan(column).any() or np.abs(column).max() > HUGE)


@pytest.mark.parametrize("optional", [{*VELOCITY}, {*GPS}, {*GPS, "gx", "gy", "gz"}])
@pytest.mark.parametrize("kind", [pa.float32(), pa.float64()])
def test_what_devices_usually_send_goes_the_short_way(optional: set[str], kind: pa.DataType) -> None:
    columns = sound_columns(optional)
    for name in GPS:
        if name in columns:
            columns[name][1:3] = np.nan
    quick = quickly(batch(Table(tuple(columns), np.array(list(columns.values()))), kind))
    assert quick is not None
    assert quick.fix_rows.tolist() == [0, 3]
    assert quick.none_rows.tolist() == [1]


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("ax", [0.25, None, 0.25, 0.25]),
        ("ax", [0.25, np.inf, 0.25, 0.25]),
        ("t", [0.0, 0.5, 0.25, 1.0]),
        ("t", [0.0, np.nan, 0.25, 1.0]),
        ("t", [0.0, 0.25, 0.5, np.inf]),
        ("fix", [1, 2, None, 1]),
        ("fix", [1.0, 0.0, None, 1.0]),
        ("lat", [91.0, None, None, 1.0]),
        ("lat", [1.0, np.inf, None, 1.0]),
        ("mx", [0.0, 0.0, 0.0, 0.0]),
        ("alt", [True, None, None, False]),
    ],
)
def test_what_is_odd_is_left_to_the_long_way(name: str, values: list[Any]) -> None:
    sent = batch(SOUND_TABLE, pa.float64()).to_pydict() | {"fix": pa.array([1, 0, None, 1], pa.int8())}
    odd = pa.RecordBatch.from_pydict(sent | {name: pa.array(values, from_pandas=False)})
    assert quickly(odd) is None


def test_numbers_whose_sum_is_not_finite_are_left_to_the_long_way() -> None:
    columns = sound_columns({*GPS, *VELOCITY}) | {"ax": np.full(4, 1e308)}
    sent = batch(Table(tuple(columns), np.array(list(columns.values()))), pa.float64())
    assert quickly(sent) is None
    assert the_long_way(sent) is not None


def test_a_part_of_a_larger_batch() -> None:
    sent = batch(SOUND_TABLE, pa.float32()).slice(1, 3)
    quick = quickly(sent)
    assert quick is not None
    assert_same(quick, the_long_way(sent))


COUNTS = {
    "t_ms": (pa.int32(), None),
    **dict.fromkeys(ACCELERATION, (pa.int16(), Scale(4 * 9.80665 / 32768, 0.0))),
    **dict.fromkeys(("gx", "gy", "gz"), (pa.int16(), Scale(0.001, -0.5))),
    "fix": (pa.int8(), None),
    **dict.fromkeys(("lat", "lon"), (pa.int32(), Scale(1e-7, 0.0))),
    "alt": (pa.int16(), Scale(0.1, 1000.0)),
    "speed": (pa.uint16(), Scale(0.01, 0.0)),
    "course": (pa.uint16(), Scale(0.01, 0.0)),
}
"""type and scale of the columns of a device that sends what its sensors count"""


def counts(rows: int, rng: np.random.Generator) -> pa.RecordBatch:
    columns = {"t_ms": pa.array(np.cumsum(rng.integers(0, 9, rows)), pa.int32())}
    for name, (kind, scale) in COUNTS.items():
        if scale is not None:
            values = rng.integers(-30_000 if pa.types.is_signed_integer(kind) else 0, 30_000, rows)
            columns[name] = pa.array(values, kind, mask=(rng.random(rows) < 0.2) & (name in GPS))
    columns["fix"] = pa.array(rng.integers(0, 2, rows), pa.int8(), mask=rng.random(rows) < 0.5)
    return pa.RecordBatch.from_pydict({name: columns[name] for name in COUNTS})


@pytest.mark.parametrize("cut", [0, 1, 8])
def test_columns_with_the_same_gaps_as_others_and_with_other_ones(cut: int) -> None:
    scales = {name: scale for name, (_, scale) in COUNTS.items() if scale is not None}
    taken = 0
    for seed in range(400):
        rng = np.random.default_rng(seed)
        sent = counts(20, rng)
        columns = {name: sent.column(name) for name in sent.schema.names}
        silent = rng.random(20) < 0.5
        gaps = [silent, silent | (rng.random(20) < 0.2), silent & (rng.random(20) < 0.8)]
        for name in ("fix", *(name for name in GPS if name in columns)):
            values = columns[name].fill_null(1)
            mask = silent if name == "fix" else gaps[rng.integers(0, 3)]
            columns[name] = pa.array(values.to_numpy(zero_copy_only=False), values.type, mask=mask)
        sent = pa.RecordBatch.from_pydict(columns).slice(cut)
        quick, long = quickly(sent, scales), the_long_way(sent, scales)
        if quick is not None:
            assert_same(quick, long)
            taken += 1
        else:
            assert long is None
    assert taken > 30


@pytest.mark.parametrize("cut", [0, 1, 7, 8, 13])
def test_counts_with_a_scale_go_the_short_way_and_give_the_same(cut: int) -> None:
    scales = {name: scale for name, (_, scale) in COUNTS.items() if scale is not None}
    taken = 0
    for seed in range(300):
        sent = counts(20, np.random.default_rng(seed)).slice(cut)
        quick, long = quickly(sent, scales), the_long_way(sent, scales)
        if quick is not None:
            assert_same(quick, long)
            taken += 1
        else:
            assert long is None  # a fix without speed and position
    assert taken > 30
