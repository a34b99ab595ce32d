"""Delimited text -> columns of numbers: compiled, quick, and patient; only the last one names the first bad cell.

Lines end with LF, CRLF or CR; blank lines are skipped; an empty cell is NaN.
"""

import csv
import re
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from itertools import islice
from typing import NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.csv
from numpy.typing import NDArray

from api.formats import _kernel
from api.formats.compression import Limits
from api.formats.errors import FormatError, Problem

Floats = NDArray[np.float64]
Columns = dict[str, Floats]


class Table(NamedTuple):
    """Columns of equal length."""

    names: tuple[str, ...]
    values: Floats
    """(names, N), contiguous; NaN for an empty cell"""

    @property
    def rows(self) -> int:
        """Length of the columns."""
        return int(self.values.shape[1])

    @property
    def columns(self) -> Columns:
        """The columns by name, (N,) each."""
        return dict(zip(self.names, self.values, strict=True))


BYTE_ORDER_MARK = b"\xef\xbb\xbf"
_NUMBER_CHARACTERS = b"0123456789+-.eE,; \t\r\n"
_MAX_HARD = 8192
"""Numbers with more digits than a double that are read one by one; a log with more of them is read otherwise."""
_LINE_END = re.compile(rb"\r\n|\n|\r")


class Cell(NamedTuple):
    """Where a value stands, and what is written there."""

    line: int
    text: str


def text_content(content: bytes, limits: Limits) -> bytes:
    """Check that this is text with something in it and not too many lines, and take a byte order mark away.

    Raises
    ------
    FormatError
        422 for an empty body, an image or other binary, 413 for too many lines.
    """
    content = content.removeprefix(BYTE_ORDER_MARK)
    if not content or content.isspace():
        raise FormatError.unreadable(Problem(1, None, "a log", "the log is empty"))
    if b"\0" in content or not _is_utf8(content[:4096]):
        raise FormatError.unreadable(Problem(1, None, "text in UTF-8", "this is not text in UTF-8"))
    if len(content) > limits.max_rows and max(content.count(b"\n"), content.count(b"\r")) > limits.max_rows + 1:
        raise FormatError.too_large(f"the log has more than {limits.max_rows} rows")
    return content


def _is_utf8(beginning: bytes) -> bool:
    try:
        beginning.decode()
    except UnicodeDecodeError as error:
        return error.reason == "unexpected end of data"
    return True


@dataclass(frozen=True)
class DelimitedText:
    """Lines of cells under known column names."""

    content: bytes
    names: tuple[str, ...]
    delimiter: str
    header_lines: int
    """lines before the first row"""

    def read(self, wanted: tuple[str, ...]) -> Table:
        """Read the wanted columns.

        Raises
        ------
        FormatError
            422 with line and column: a cell that is not a number, a line with too few or too many cells.
        """
        values = self._compiled(wanted)
        if values is None:
            try:
                values = self._quick(wanted)
            except pa.ArrowInvalid:
                values = self._patient(wanted)
        return Table(wanted, np.ascontiguousarray(values))

    def cell(self, row: int, column: str) -> Cell:
        """Give line number and text of a cell, for a message; a column that is not there is empty everywhere."""
        for index, (line, text) in enumerate(self._rows()):
            if index == row:
                return Cell(line, self._text(text, column))
        raise IndexError(row)

    def _text(self, line: bytes, column: str) -> str:
        if column not in self.names:
            return ""
        return self._split(line)[self.names.index(column)].decode(errors="replace").strip()

    def _compiled(self, wanted: tuple[str, ...]) -> Floats | None:
        """Read what nearly every log is; None for one that needs more."""
        start = self._start()
        text = np.frombuffer(self.content, np.uint8)
        target = np.array([wanted.index(name) if name in wanted else -1 for name in self.names])
        values, hard = np.empty((len(wanted), self._most_rows(text, start))), np.empty((_MAX_HARD, 4), np.int64)
        rows, hards = _kernel.read(text, start, ord(self.delimiter), target, values, hard)
        if rows == _kernel.ODD:
            return None
        for column, row, begin, end in hard[:hards].tolist():
            values[column, row] = float(self.content[begin:end])
        return values[:, :rows]

    def _most_rows(self, text: NDArray[np.uint8], start: int) -> int:
        """Tell how many rows there can be, which is how many there are when no line is blank."""
        line_ends = next((n for end in b"\n\r" if (n := np.count_nonzero(text[start:] == end))), 0)
        after_last = 0 if self.content.endswith((b"\n", b"\r")) else 1
        bytes_per_row = len(self.names)  # at least: a delimiter or an end of line after each cell
        return min(int(line_ends) + after_last, (text.size - start) // bytes_per_row + 1)

    def _start(self) -> int:
        """Tell where the first row begins."""
        ends = islice(_LINE_END.finditer(self.content), self.header_lines)
        return max((end.end() for end in ends), default=len(self.content) if self.header_lines else 0)

    def _quick(self, wanted: tuple[str, ...]) -> Floats:
        table = pa.csv.read_csv(
            pa.BufferReader(self.content),
            read_options=pa.csv.ReadOptions(
                column_names=self.names, skip_rows=self.header_lines, use_threads=False, block_size=4 * 1024 * 1024
            ),
            parse_options=pa.csv.ParseOptions(delimiter=self.delimiter),
            convert_options=pa.csv.ConvertOptions(
                include_columns=wanted, column_types=dict.fromkeys(wanted, pa.float64()), null_values=[""]
            ),
        )
        return np.array([table[name].to_numpy() for name in wanted])

    def _patient(self, wanted: tuple[str, ...]) -> Floats:
        places = [(name, self.names.index(name)) for name in wanted]
        values: list[list[float]] = []
        for line, text in self._rows():
            cells = self._split(text)
            if len(cells) != len(self.names):
                raise FormatError.unreadable(_ragged(line, len(self.names), len(cells)))
            values.append([_number(cells[place], line, name) for name, place in places])
        return np.array(values, np.float64).reshape(-1, len(wanted)).T

    def _rows(self) -> Iterator[tuple[int, bytes]]:
        """Yield line number and text of the lines with something on them."""
        for line, text in enumerate(lines(self.content), 1):
            if line > self.header_lines and text.strip(b" "):
                yield line, text

    def _split(self, line: bytes) -> list[bytes]:
        if b'"' not in line:
            return line.split(self.delimiter.encode())
        return [cell.encode() for cell in next(csv.reader([line.decode(errors="replace")], delimiter=self.delimiter))]


def lines(content: bytes) -> Iterator[bytes]:
    """Yield the lines without their ends, one at a time."""
    start = 0
    for end in _LINE_END.finditer(content):
        yield content[start : end.start()]
        start = end.end()
    yield content[start:]


def is_numbers(line: bytes) -> bool:
    """Tell whether a line holds numbers and separators only."""
    return any(digit in line for digit in b"0123456789") and not line.strip(_NUMBER_CHARACTERS)


def _number(cell: bytes, line: int, column: str) -> float:
    stripped = cell.strip()
    if not stripped:
        return np.nan
    if b"_" not in stripped:  # float() would take 1_000
        with suppress(ValueError):
            return float(stripped)
    raise FormatError.unreadable(not_as_expected(Cell(line, stripped.decode(errors="replace")), column, "a number"))


def not_as_expected(cell: Cell, column: str, expected: str) -> Problem:
    """Put into words that a cell does not hold what it should."""
    found = repr(cell.text[:40]) if cell.text else "an empty cell"
    return Problem(cell.line, column, expected, f"expected {expected}, found {found}")


def _ragged(line: int, expected: int, found: int) -> Problem:
    return Problem(line, None, f"{expected} cells", f"expected {expected} cells, found {found}")
