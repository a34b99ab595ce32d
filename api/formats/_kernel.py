"""Delimited text -> numbers, compiled: the cells that almost every log has, and a word for all others.

This file imports nothing of the project, so that numba's cache, which watches a single file, can never be stale.
"""

from typing import Any

import numpy as np
from numba import njit

OPTIONS: Any = {"cache": True, "nogil": True, "_nrt": False}
"""The last: who holds the arrays is not counted, which would take a fifth of the time; no array is made here."""

ODD = -1
"""instead of a number of rows: there is something this reader leaves to a more patient one"""

NEWLINE, RETURN, BLANK, PLUS, MINUS, POINT, ZERO, LARGEST_DIGIT, POINT_DIGIT, QUOTE = (
    10,
    13,
    32,
    43,
    45,
    46,
    48,
    9,
    -2,
    34,
)
UPPER_E, LOWER_E = 69, 101
EXACT = 2**53
"""Whole numbers up to here are doubles,"""
POWERS = 10.0 ** np.arange(23)
"""and so are these: a product or quotient of the two is rounded once, as `float` rounds."""
MAX_DIGITS = 18
"""fit into 64 bits"""
MAX_EXPONENT_DIGITS, TOO_LARGE = 9, 1_000_000_000
"""longer exponents are all taken for this one, which is not exact"""


@njit(**OPTIONS)
def read(text, start, delimiter, target, values, hard):
    """Read the rows from `start` on.

    Parameters
    ----------
    text
        (B,) uint8
    start
        where the first row begins
    delimiter
        character between cells
    target
        (cells of a row,) row of `values` that takes a cell, -1 for a cell that is not wanted
    values
        (wanted cells, N) takes the numbers, NaN for an empty cell
    hard
        (H, 4) takes column, row, begin and end of the numbers that are not exactly rounded here

    Returns
    -------
    rows, hard numbers
        `ODD` instead of rows when a line has too few or too many cells, a cell is no plain number, there are quotes or
        blanks where they matter, or `values` or `hard` are too short; what they hold then means nothing.
    """
    size, cells, row, hards, at = text.size, target.size, 0, 0, start
    while at < size:
        if text[at] == NEWLINE or text[at] == RETURN:
            at += 1
            continue
        if text[at] == BLANK or row == values.shape[1]:
            return ODD, 0
        for cell in range(cells):
            if target[cell] < 0:
                while at < size and text[at] != delimiter and text[at] != NEWLINE and text[at] != RETURN:
                    if text[at] == QUOTE:
                        return ODD, 0
                    at += 1
            elif at < size and text[at] == delimiter:
                values[target[cell], row] = np.nan
            else:
                begin = at
                at, number, exact = cell_value(text, at, delimiter)
                if at < 0:
                    return ODD, 0
                values[target[cell], row] = number
                if not exact:
                    if hards == hard.shape[0]:
                        return ODD, 0
                    hard[hards, 0], hard[hards, 1], hard[hards, 2], hard[hards, 3] = target[cell], row, begin, at
                    hards += 1
            at_end = at == size or text[at] != delimiter
            if at_end != (cell == cells - 1):
                return ODD, 0
            at += 1
        row += 1
    return row, hards


@njit(**OPTIONS, inline="always")
def cell_value(text, at, delimiter):
    """Read a cell: where it ends (`ODD` if it is no plain number), its value, and whether that is exactly rounded."""
    size, begin = text.size, at
    negative = at < size and text[at] == MINUS
    at += np.int64(at < size and (text[at] == MINUS) | (text[at] == PLUS))
    first, mantissa, point, points = at, np.int64(0), at, np.int64(0)
    # digits and points in one loop without branches: a wrong guess of the processor costs more than a digit
    while at < size:
        digit = np.int64(text[at]) - ZERO
        is_point = digit == POINT_DIGIT
        if np.uint64(digit) > np.uint64(LARGEST_DIGIT) and not is_point:
            break
        mantissa = mantissa if is_point else mantissa * 10 + digit
        point = at if is_point else point
        points += is_point
        at += 1
    digits = at - first - points
    exponent = (point + 1 - at) * points
    if points > 1:
        return ODD, 0.0, True
    if digits and at < size and (text[at] == LOWER_E or text[at] == UPPER_E):
        at, power = exponent_value(text, at + 1)
        if at < 0:
            return ODD, 0.0, True
        exponent += power
    if at < size and text[at] != delimiter and text[at] != NEWLINE and text[at] != RETURN:
        return ODD, 0.0, True
    if digits == 0:
        return (at if at == begin else ODD), np.nan, True
    value = np.float64(mantissa)
    exact = digits <= MAX_DIGITS and mantissa <= EXACT and -POWERS.size < exponent < POWERS.size
    if exact:
        value = value / POWERS[-exponent] if exponent < 0 else value * POWERS[exponent]
    return at, (-value if negative else value), exact


@njit(**OPTIONS, inline="always")
def whole_number(text, at, value):
    """Read digits: where they end, the number that they continue (wrong if there are too many), and how many."""
    size, begin = text.size, at
    while at < size:
        digit = np.int64(text[at]) - ZERO
        if digit < 0 or digit > LARGEST_DIGIT:
            break
        value = value * 10 + digit
        at += 1
    return at, value, at - begin


@njit(**OPTIONS)
def exponent_value(text, at):
    """Read what follows the letter e: where it ends (`ODD` if it is no whole number), and its value."""
    size = text.size
    negative = at < size and text[at] == MINUS
    if negative or (at < size and text[at] == PLUS):
        at += 1
    at, value, digits = whole_number(text, at, 0)
    if digits > MAX_EXPONENT_DIGITS:
        value = TOO_LARGE
    return (at if digits else ODD), (-value if negative else value)
