"""What every log must satisfy, whatever its format. Each rule marks bad rows; the first bad row is named."""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from api.formats.compression import Limits
from api.formats.delimited import Cell, Columns, Floats, not_as_expected
from api.formats.errors import FormatError, Problem

Rows = NDArray[np.int64]
Locate = Callable[[int, str], Cell]
"""Row and column -> the cell, for a message."""


class Fault(NamedTuple):
    """The first row that breaks a rule."""

    row: int
    column: str
    expected: str


def first(bad: NDArray[np.bool_], column: str, expected: str, rows: Rows | None = None) -> list[Fault]:
    """Give the first bad row, if any; `rows` are the row numbers when only some rows were looked at."""
    if not bad.any():
        return []
    index = int(np.argmax(bad))
    return [Fault(index if rows is None else int(rows[index]), column, expected)]


def finite(columns: Columns, *names: str) -> list[Fault]:
    """Require a finite number in every row."""
    odd = [name for name in names if not _surely_finite(columns[name])]
    return [fault for name in odd for fault in first(~np.isfinite(columns[name]), name, "a finite number")]


def _surely_finite(values: Floats) -> bool:
    """Tell by their sum, which is quicker, that all values are finite; it may be infinite though they are not."""
    with np.errstate(over="ignore", invalid="ignore"):
        return math.isfinite(values.sum())


def finite_or_empty(columns: Columns, *names: str) -> list[Fault]:
    """Require a finite number or an empty cell in every row."""
    expected = "a finite number or an empty cell"
    return [fault for name in names if name in columns for fault in first(np.isinf(columns[name]), name, expected)]


def flag(columns: Columns, name: str) -> list[Fault]:
    """Require 1, 0 or an empty cell."""
    values = columns[name]
    return first(~(np.isnan(values) | (values == 0) | (values == 1)), name, "1, 0 or an empty cell")


def within(values: Floats, low: float, high: float, column: str, expected: str, rows: Rows) -> list[Fault]:
    """Require values in [low, high] or empty cells on these rows."""
    return first((values < low) | (values > high), column, expected, rows)


def in_order(columns: Columns, name: str) -> list[Fault]:
    """Require time not to run backwards."""
    t = columns[name]
    back = first(t[1:] < t[:-1], name, "")
    return [Fault(fault.row + 1, name, f"a time not before {t[fault.row]:.12g}") for fault in back]


def refuse(faults: list[Fault], locate: Locate) -> None:
    """Raise if there are faults: the problems in the order of their lines, one for each broken rule.

    Raises
    ------
    FormatError
        422 with line, column and what was expected.
    """
    if faults:
        faults = sorted(faults, key=lambda fault: fault.row)
        raise FormatError.unreadable(
            *(not_as_expected(locate(fault.row, fault.column), fault.column, fault.expected) for fault in faults)
        )


def refuse_rows(rows: int, limits: Limits) -> None:
    """Raise if a log has too many rows."""
    if rows > limits.max_rows:
        raise FormatError.too_large(f"the log has more than {limits.max_rows} rows")


def refuse_empty(rows: int, line: int) -> None:
    """Raise if a log has no rows."""
    if not rows:
        raise FormatError.unreadable(Problem(line, None, "at least one sample", "the log has no samples"))
