"""Samples as they are kept: an Arrow IPC stream of the native columns, its buffers packed with zstd.

A number takes 32 bits, time and position 64: a log is given back to the last digit that it has, as long as these are
no more than seven, or of a position in degrees eleven after the point. Columns that nothing fills are left out.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from api.formats.delimited import Columns, Floats
from api.formats.native import ACCELERATION, FIELD, GPS, OTHERS, POSITION, RATE, VELOCITY
from api.formats.writer import by_name, gps_columns
from core import Samples

DOUBLE = frozenset({"t", *POSITION})
ANGLES = ("lat", "lon", "course", "course_acc")
DECIMALS = 11
"""of a position in degrees, 1 um: what the way to radians and back changes is less"""
NO_REPORT = -1
_PACKED = pa.ipc.IpcWriteOptions(compression=pa.Codec("zstd", 1))


def pack(samples: Samples) -> bytes:
    """Give samples as bytes."""
    table = batch(samples)
    out = pa.BufferOutputStream()
    with pa.ipc.new_stream(out, table.schema, options=_PACKED) as stream:
        stream.write_batch(table)
    content: bytes = out.getvalue().to_pybytes()
    return content


def names(content: bytes) -> tuple[str, ...]:
    """Give the names of the columns there are."""
    with pa.ipc.open_stream(content) as stream:
        return tuple(stream.schema.names)


def unpack(content: bytes) -> Samples:
    """Give the samples again."""
    with pa.ipc.open_stream(content) as stream:
        table = stream.read_all().combine_chunks()
    fixed = table["fix"].fill_null(NO_REPORT).to_numpy()
    rows = np.flatnonzero(fixed != NO_REPORT)
    columns = {name: table[name].to_numpy().astype(np.float64) for name in table.column_names if name != "fix"}
    return Samples.make(
        columns["t"],
        np.stack([columns[name] for name in ACCELERATION], axis=-1),
        _axes(columns, RATE),
        rows,
        fixed[rows] == 1,
        _fixes({name: columns[name][rows] for name in GPS if name in columns}, rows.size),
        _axes(columns, FIELD),
        *(columns.get(name) for name in OTHERS),
    )


def schema(columns: Sequence[str]) -> pa.Schema:
    """Give the types of columns, in their usual order."""
    order = ("t", *ACCELERATION, *RATE, "fix", *GPS, *FIELD, *OTHERS)
    return pa.schema([(name, _type(name)) for name in order if name in columns])


def batch(samples: Samples, columns: Sequence[str] | None = None) -> pa.RecordBatch:
    """Give samples as native columns: those that are filled, or those named, of which some may be empty."""
    filled = _columns(samples)
    wanted = schema(tuple(filled) if columns is None else columns)
    return pa.record_batch([_array(field, filled.get(field.name), samples) for field in wanted], schema=wanted)


def _type(name: str) -> pa.DataType:
    if name == "fix":
        return pa.int8()
    return pa.float64() if name in DOUBLE else pa.float32()


def _array(field: pa.Field, values: Floats | None, samples: Samples) -> pa.Array:
    """Give a column of N rows; of a report's columns, those of the rows on which one came."""
    if values is None:
        return pa.nulls(len(samples), field.type)
    if field.name == "fix":
        rows = _spread(values, samples, np.int8, NO_REPORT)
        return pa.array(rows, mask=rows == NO_REPORT)
    kind = np.float64 if field.name in DOUBLE else np.float32
    if field.name in GPS:
        return pa.array(_spread(values, samples, kind, np.nan))
    return pa.array(np.ascontiguousarray(values, kind))


def _spread(values: Floats, samples: Samples, kind: type, empty: float) -> NDArray[Any]:
    rows: NDArray[Any] = np.full(len(samples), empty, kind)
    rows[samples.fix_row] = values
    return rows


def _columns(samples: Samples) -> Columns:
    """Give the columns that are filled: of a sample (N,), of a report (M,)."""
    found = {"t": samples.t, **by_name(ACCELERATION, samples.f_s)}
    if samples.has_rates:
        found |= by_name(RATE, samples.w_s)
    if samples.m_s is not None:
        found |= by_name(FIELD, samples.m_s)
    others = zip(OTHERS, (samples.steer, samples.temperature, samples.pressure), strict=True)
    found |= {name: values for name, values in others if values is not None}
    found["fix"] = samples.fix_valid.astype(np.float64)
    return found | _reports(samples)


def _reports(samples: Samples) -> Columns:
    """Give the columns of the receiver; a log has those of a position or of a velocity at least."""
    told = gps_columns(samples)
    told |= {name: np.round(told[name], DECIMALS) for name in POSITION}
    filled = {name: values for name, values in told.items() if np.isfinite(values).any()}
    return filled if POSITION[0] in filled else filled | {name: told[name] for name in VELOCITY}


def _axes(columns: Columns, axes: Sequence[str]) -> Floats | None:
    return np.stack([columns[name] for name in axes], axis=-1) if axes[0] in columns else None


def _fixes(columns: Columns, reports: int) -> Floats:
    """Give the reports (M, 8) as in `core.FIX_COLUMNS`."""
    empty = np.full(reports, np.nan)
    degrees = {name: columns.get(name, empty) for name in GPS}
    return np.stack([np.radians(values) if name in ANGLES else values for name, values in degrees.items()], axis=-1)
