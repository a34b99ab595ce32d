"""The compiled look at a chunk and the rules that name what is wrong with it agree."""

import numpy as np
from hypothesis import example, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from api.formats import checks, native
from api.formats.delimited import Cell, Table
from api.formats.errors import FormatError
from api.formats.native import ACCELERATION, GPS, POSITION, RATE, VELOCITY, NativeTable
from core import Samples

ODD = [np.nan, np.inf, -np.inf, -1.0, 0.0, 0.5, 1.0, 90.0, 90.5, 180.0, 181.0, 359.9, 360.0, 361.0, -200.0, 1e308]
ROWS = 4


def sound_columns(optional: set[str]) -> dict[str, NDArray[np.float64]]:
    """Columns of a chunk with nothing wrong."""
    names = ["t", *ACCELERATION, "fix", *POSITION, *VELOCITY, *RATE, *GPS]
    columns = {
        name: np.full(ROWS, 0.25) for name in dict.fromkeys(names) if name in {"t", *ACCELERATION, "fix"} | optional
    }
    columns["t"] = np.arange(ROWS) / 4
    columns["fix"] = np.array([1.0, 0.0, np.nan, 1.0])
    return columns


@st.composite
def chunks(draw: st.DrawFn) -> Table:
    """Columns with an odd cell or a few."""
    groups = draw(st.sets(st.sampled_from([POSITION, VELOCITY, RATE, ("vz", "speed_acc", "course_acc", "alt")])))
    optional = {name for group in groups for name in group}
    if not optional & set(POSITION):
        optional |= set(VELOCITY)
    columns = sound_columns(optional)
    for _ in range(draw(st.integers(0, 3))):
        name = draw(st.sampled_from(sorted(columns)))
        rows = draw(st.sampled_from([[0], [1], [3], [0, 3], range(ROWS)]))
        columns[name][list(rows)] = draw(st.sampled_from(ODD))
    names = tuple(draw(st.permutations(sorted(columns))))
    return Table(names, np.array([columns[name] for name in names]))


def read(table: Table) -> Samples | None:
    try:
        return NativeTable.of(table, lambda row, column: Cell(row + 2, column)).read({}).samples
    except FormatError:
        return None


def as_described(table: Table, samples: Samples) -> None:
    columns = table.columns
    assert samples.t.tobytes() == columns["t"].tobytes()
    np.testing.assert_array_equal(samples.f_s, np.column_stack([columns[name] for name in ACCELERATION]))
    if "gx" in columns:
        np.testing.assert_array_equal(samples.w_s, np.column_stack([columns[name] for name in RATE]))
    else:
        assert np.isnan(samples.w_s).all()
    rows = samples.fix_row[samples.fix_valid]
    assert rows.tolist() == np.flatnonzero(columns["fix"] == 1).tolist()
    for place, name in enumerate(GPS):
        sent = columns[name][rows] if name in columns else np.full(rows.size, np.nan)
        if name in {"lat", "lon", "course", "course_acc"}:
            sent = np.radians(sent)
        np.testing.assert_array_equal(
            samples.fix[samples.fix_valid, place], sent % (2 * np.pi) if name == "course" else sent
        )


@settings(max_examples=3000)
@given(chunks())
@example(Table(tuple(sound_columns(set(VELOCITY))), np.array(list(sound_columns(set(VELOCITY)).values()))))
def test_a_chunk_is_read_when_no_rule_is_broken(table: Table) -> None:
    faults = native._faults(table.columns, "t")
    samples = read(table)
    assert (samples is None) == bool(faults)
    if samples is not None:
        as_described(table, samples)


def test_milliseconds_are_told_in_seconds() -> None:
    columns = sound_columns(set(VELOCITY))
    columns["t_ms"] = columns.pop("t") * 1000
    samples = read(Table(tuple(columns), np.array(list(columns.values()))))
    assert samples is not None
    assert samples.t.tolist() == [0.0, 0.25, 0.5, 0.75]


def test_the_first_row_that_breaks_a_rule_is_named() -> None:
    columns = sound_columns(set(VELOCITY))
    columns["speed"][3] = -2.0
    columns["ax"][2] = np.inf
    table = Table(tuple(columns), np.array(list(columns.values())))
    assert [fault.row for fault in sorted(native._faults(table.columns, "t"), key=lambda fault: fault.row)] == [2, 3]
    assert checks.finite(table.columns, "ax")[0].expected == "a finite number"
