"""Native CSV, `text/csv`: a header with the column names, then one row for each IMU sample."""

import csv

from api.formats import checks
from api.formats.compression import Limits
from api.formats.delimited import DelimitedText, is_numbers, lines, text_content
from api.formats.errors import FormatError, Problem
from api.formats.fingerprint import Fingerprint
from api.formats.log import ParsedLog
from api.formats.native import READ, NativeTable, check_names

MEDIA_TYPE = "text/csv"


def parse(content: bytes, limits: Limits, fingerprint: Fingerprint) -> ParsedLog:
    """Read a native CSV log.

    Raises
    ------
    FormatError
        413, or 422 with line, column and what was expected.
    """
    content = text_content(content, limits)
    names = _names(next(lines(content)))
    notices = check_names(names, line=1)
    text = DelimitedText(content, names, ",", header_lines=1)
    table = text.read(tuple(name for name in names if name in READ))
    checks.refuse_empty(table.rows, line=2)
    checks.refuse_rows(table.rows, limits)
    return ParsedLog(MEDIA_TYPE, fingerprint, notices, table.rows, NativeTable.of(table, text.cell).read)


def _names(header: bytes) -> tuple[str, ...]:
    try:
        cells = next(csv.reader([header.decode()], strict=True), [])
    except (UnicodeDecodeError, csv.Error):
        raise FormatError.unreadable(Problem(1, None, "column names", "expected column names in UTF-8")) from None
    names = tuple(cell.strip() for cell in cells)
    if is_numbers(header):
        raise FormatError.unreadable(
            Problem(1, None, "column names", "expected a header with column names, found numbers")
        )
    if len(names) == 1 and len(header.replace(b";", b"\t").split(b"\t")) > 1:
        raise FormatError.unreadable(
            Problem(1, None, "commas between cells", "expected column names separated by commas")
        )
    return names
