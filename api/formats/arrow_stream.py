"""Arrow IPC stream, `application/vnd.apache.arrow.stream`: the native columns, null for an empty cell.

Made for untrusted bytes: columns are plain numbers only, and buffers compressed inside the stream are refused, since
their size is not known before they are unpacked (compress the body with gzip or zstd instead).
"""

import struct
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from api.formats import arrow_quick, checks
from api.formats.arrow_scale import Scale, Scales
from api.formats.compression import Limits
from api.formats.delimited import Cell, Columns, Table
from api.formats.errors import FormatError, Problem, printable
from api.formats.fingerprint import Fingerprint
from api.formats.log import ParsedLog
from api.formats.native import READ, NativeTable, check_names

MEDIA_TYPE = "application/vnd.apache.arrow.stream"

_HEADER_FIELD, _COMPRESSION_FIELD = 2, 3
"""places of `Message.header` and `RecordBatch.compression` in Arrow's flatbuffer tables"""
_USUAL_HEAD = 16 * 1024
"""bytes, longest schema that is remembered"""


class _Head(NamedTuple):
    """What comes before the rows."""

    schema: pa.Schema
    scales: Scales
    plan: arrow_quick.Plan | None
    notices: tuple[str, ...]


def parse(content: bytes, limits: Limits, fingerprint: Fingerprint) -> ParsedLog:
    """Read an Arrow IPC stream.

    Raises
    ------
    FormatError
        413, or 422 with row (as line), column and what was expected.
    """
    if not content:
        raise FormatError.unreadable(Problem(1, None, "a log", "the log is empty"))
    try:
        batches, head = _batches(content, limits)
    except (pa.ArrowException, OSError, struct.error, IndexError, UnicodeDecodeError) as error:
        message = f"expected an Arrow IPC stream: {printable(str(error))}"
        raise FormatError.unreadable(Problem(None, None, "an Arrow IPC stream", message)) from error
    rows = sum(batch.num_rows for batch in batches)
    checks.refuse_empty(rows, line=1)
    return ParsedLog(MEDIA_TYPE, fingerprint, head.notices, rows, _sound(batches, head).read)


def _sound(batches: list[pa.RecordBatch], head: _Head) -> NativeTable:
    batches = [batch for batch in batches if batch.num_rows]
    if head.plan is not None and len(batches) == 1:
        packed = arrow_quick.pack(batches[0], head.plan)
        if packed is not None:
            return NativeTable(packed, {})
    table = _table(pa.Table.from_batches(batches, head.schema), head.scales)
    return NativeTable.of(table, lambda row, column: Cell(row + 1, _shown(table.columns, row, column)))


def _batches(content: bytes, limits: Limits) -> tuple[list[pa.RecordBatch], _Head]:
    messages = iter(pa.ipc.MessageReader.open_stream(pa.BufferReader(content)))
    if (first := next(messages, None)) is None:
        raise pa.ArrowInvalid("there is no schema")
    written = first.serialize().to_pybytes()
    head = _usual_head(written) if len(written) <= _USUAL_HEAD else _head(written)
    batches, rows = [], 0
    for message in messages:
        batch = _batch(message, head.schema)
        rows += batch.num_rows
        checks.refuse_rows(rows, limits)
        batches.append(batch)
    return batches, head


def _head(written: bytes) -> _Head:
    """Read and check a schema."""
    schema = pa.ipc.read_schema(pa.BufferReader(written))
    notices = check_names(tuple(schema.names), line=None)
    scales = _check_types(schema)
    return _Head(schema, scales, arrow_quick.Plan.of(schema, scales), notices)


_usual_head = lru_cache(maxsize=128)(_head)
"""Devices with the same firmware send the same."""


def _batch(message: pa.ipc.Message, schema: pa.Schema) -> pa.RecordBatch:
    if message.type == "record batch" and _is_compressed(message.metadata.to_pybytes()):
        expected = "buffers without compression inside the stream; compress the whole body with gzip or zstd"
        raise FormatError.unreadable(Problem(None, None, expected, f"expected {expected}"))
    batch = pa.ipc.read_record_batch(message, schema)
    batch.validate()
    return batch


def _check_types(schema: pa.Schema) -> Scales:
    """Refuse columns other than plain numbers, also the ignored ones: others may hide compressed or nested data.

    Gives the scales of those that have one and are not ignored.
    """
    scales: Scales = {}
    for field in schema:
        if not (pa.types.is_integer(field.type) or pa.types.is_floating(field.type) or pa.types.is_boolean(field.type)):
            message = f"expected integers, floating-point numbers or booleans, found {field.type}"
            raise FormatError.unreadable(Problem(None, printable(field.name), "numbers", message))
        if field.name in READ and (scale := Scale.of(field)) is not None:
            scales[field.name] = scale
    return scales


def _table(batches: pa.Table, scales: Scales) -> Table:
    names = tuple(name for name in batches.column_names if name in READ)
    values = np.empty((len(names), batches.num_rows))
    for row, name in zip(values, names, strict=True):
        row[:] = _numbers(batches[name].combine_chunks())
        if name in scales:
            scales[name].values(row, out=row)
    return Table(names, values)


def _numbers(column: pa.Array) -> NDArray[Any]:
    if not pa.types.is_floating(column.type):  # numpy is quicker with those, and has no null for the others
        column = column.cast(pa.float64(), safe=False)
    values: NDArray[Any] = column.to_numpy(zero_copy_only=False)
    return values


def _shown(columns: Columns, row: int, column: str) -> str:
    value = columns[column][row] if column in columns else np.nan
    return "" if np.isnan(value) else f"{value:.12g}"


def _is_compressed(metadata: bytes) -> bool:
    """Tell whether a record batch's message sets `compression`; Arrow has no function for it: walk the flatbuffer."""
    header = _table_field(metadata, _pointer(metadata, 0), _HEADER_FIELD)
    return header is not None and _table_field(metadata, _pointer(metadata, header), _COMPRESSION_FIELD) is not None


def _pointer(data: bytes, at: int) -> int:
    """Follow the relative offset stored at `at`."""
    return int(at + struct.unpack_from("<I", data, at)[0])


def _table_field(data: bytes, table: int, field: int) -> int | None:
    """Give the place of a table's field, or None where it is not set."""
    vtable = table - struct.unpack_from("<i", data, table)[0]
    size = struct.unpack_from("<H", data, vtable)[0]
    entry = 4 + 2 * field
    offset = struct.unpack_from("<H", data, vtable + entry)[0] if entry < size else 0
    return table + offset if offset else None
