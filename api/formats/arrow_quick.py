"""The Arrow columns that devices usually send, packed with no detour over a table of 64-bit numbers: half the work.

Whatever is unusual or not sound is left to that detour, which tells exactly what is wrong.
"""

import math
from typing import Any, Final, NamedTuple, Self

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from api.formats import _native_kernel
from api.formats.arrow_scale import Scale, Scales
from api.formats.checks import Rows
from api.formats.delimited import Floats
from api.formats.native import ACCELERATION, FIELD, GPS, OTHERS, RATE, READ, SLOW, TIME, UNITS, Packed

_UNSCALED: Final = Scale(1.0, 0.0)
_BIT: Final = np.left_shift(1, np.arange(8)).astype(np.uint8)
"""that Arrow sets for a row where there is no null, the lowest for the first of eight"""


class _Column(NamedTuple):
    place: int
    """in a batch"""
    kind: np.dtype[Any]
    """of its numbers"""
    scale: Scale | None

    @classmethod
    def of(cls, schema: pa.Schema, name: str, scales: Scales) -> Self:
        """Look a column up by its name."""
        place = schema.get_field_index(name)
        return cls(place, np.dtype(schema.field(place).type.to_pandas_dtype()), scales.get(name))


class Plan(NamedTuple):
    """Where a schema has what is read, looked up once for all batches with this schema."""

    time: _Column
    unit: float
    """s"""
    acceleration: tuple[_Column, ...]
    rate: tuple[_Column, ...]
    """none where no rates are sent"""
    flag: _Column
    gps: tuple[_Column, ...]
    gps_places: tuple[int, ...]
    """in a fix"""
    factors: Floats
    """(columns of the receiver, 1)"""
    offsets: Floats
    """(columns of the receiver, 1)"""

    @classmethod
    def of(cls, schema: pa.Schema, scales: Scales) -> Self | None:
        """Give that of a schema with the columns an upload needs; None when the other way has to look at it."""
        if any(name in schema.names for name in (*FIELD, *OTHERS)) or not _usual(schema):
            return None
        columns = {name: _Column.of(schema, name, scales) for name in schema.names if name in READ}
        time = next(name for name in TIME if name in columns)
        sent = [name for name in GPS if name in columns]
        applied = np.array([columns[name].scale or _UNSCALED for name in sent]).reshape(-1, 2)
        return cls(
            columns[time],
            UNITS[time],
            tuple(columns[name] for name in ACCELERATION),
            tuple(columns[name] for name in RATE if name in columns),
            columns["fix"],
            tuple(columns[name] for name in sent),
            tuple(GPS.index(name) for name in sent),
            applied[:, :1],
            applied[:, 1:],
        )


def _usual(schema: pa.Schema) -> bool:
    """Tell whether the numbers are of a kind that is read without being cast."""
    numbers = [field.type for field in schema if field.name in {*TIME, *ACCELERATION, *RATE, *GPS}]
    return pa.types.is_integer(schema.field("fix").type) and all(
        kind in {pa.float32(), pa.float64()} or pa.types.is_integer(kind) for kind in numbers
    )


def pack(batch: pa.RecordBatch, plan: Plan) -> Packed | None:
    """Give the columns of a batch as samples are made of them; None when the other way has to look at them."""
    if any(batch.column(column.place).null_count for column in (plan.time, *plan.acceleration, *plan.rate)):
        return None
    t = np.empty(batch.num_rows)
    _fill(t, batch, plan.time)
    t *= plan.unit
    f_s = _axes(batch, plan.acceleration)
    w_s = _axes(batch, plan.rate) if plan.rate else None
    flags = _flags(batch.column(plan.flag.place), plan.flag.kind)
    if flags is None or f_s is None or (plan.rate and w_s is None) or not _in_order(t):
        return None
    fix_rows, none_rows = flags
    fix = _fixes(batch, plan, fix_rows)
    return None if fix is None else Packed(t, f_s, w_s, fix_rows, none_rows, fix)


def _fill(values: Floats, batch: pa.RecordBatch, column: _Column) -> None:
    """Take the numbers of a column with no nulls over."""
    stored = _values(batch.column(column.place), column.kind)
    if column.scale is None:
        values[:] = stored
    else:
        column.scale.values(stored, out=values)


def _axes(batch: pa.RecordBatch, columns: tuple[_Column, ...]) -> Floats | None:
    """Give readings side by side, (N, 3); None when one may not be finite, which a scaled integer always is."""
    axes = np.empty((batch.num_rows, len(columns)))
    for k, column in enumerate(columns):
        _fill(axes[:, k], batch, column)
    return axes if all(column.kind.kind != "f" for column in columns) or _finite(axes) else None


def _in_order(t: Floats) -> bool:
    """Tell whether times are finite and none is before the one before it: nan is in no order."""
    return math.isfinite(t[0]) and math.isfinite(t[-1]) and bool((t[1:] >= t[:-1]).all())


def _finite(values: Floats) -> bool:
    """Tell by their sum whether all values are finite; False of some that are, and huge."""
    with np.errstate(over="ignore", invalid="ignore"):
        return math.isfinite(values.sum())


def _flags(column: pa.Array, kind: np.dtype[Any]) -> tuple[Rows, Rows] | None:
    """Give the rows with 1 and those with 0; None when there is anything else but null."""
    filled = np.flatnonzero(_filled(column))
    said = _values(column, kind)[filled]
    fix_rows, none_rows = filled[said == 1], filled[said == 0]
    return (fix_rows, none_rows) if fix_rows.size + none_rows.size == filled.size else None


def _fixes(batch: pa.RecordBatch, plan: Plan, rows: Rows) -> Floats | None:
    """Give the fixes (M, 8), SI units and radians; None when one is not sound, or a number anywhere is infinite."""
    told = np.empty((len(plan.gps), rows.size))
    gaps: list[tuple[int, NDArray[np.bool_]]] = []
    before = _Filled(batch.column(plan.flag.place), None)  # it is filled on these rows
    for k, (place, kind, _) in enumerate(plan.gps):
        column = batch.column(place)
        values = _values(column, kind)
        if kind.kind == "f" and np.isinf(values).any():  # those behind nulls included
            return None
        told[k] = values[rows]
        if not before.is_as(column):  # a receiver mostly tells all or nothing
            before = _Filled(column, _gaps_at(column, rows))
        if before.gaps is not None:
            gaps.append((k, before.gaps))
    told *= plan.factors
    told += plan.offsets
    for k, empty in gaps:
        told[k, empty] = np.nan
    fix = np.full((rows.size, len(GPS)), np.nan)
    fix[:, plan.gps_places] = told.T
    return fix if _native_kernel.take_fixes(SLOW, fix) else None


def _values(column: pa.Array, kind: np.dtype[Any]) -> NDArray[Any]:
    """Give the numbers (N,), anything where there is null."""
    return np.frombuffer(column.buffers()[1], kind, len(column), column.offset * kind.itemsize)


def _filled(column: pa.Array) -> NDArray[np.bool_]:
    """Tell where there is no null, (N,)."""
    bits = column.buffers()[0]
    if bits is None:
        return np.ones(len(column), np.bool_)
    end = column.offset + len(column)
    return np.unpackbits(np.frombuffer(bits, np.uint8), count=end, bitorder="little")[column.offset :].view(np.bool_)


class _Filled(NamedTuple):
    """What is known of the nulls of a column."""

    column: pa.Array
    gaps: NDArray[np.bool_] | None
    """which of the rows asked for are null; None: none is"""

    def is_as(self, other: pa.Array) -> bool:
        """Tell whether another column of the batch has its nulls on the same rows; False where that is not seen."""
        own, others = self.column.buffers()[0], other.buffers()[0]
        same = own is others if own is None or others is None else own.equals(others)
        return same and self.column.offset == other.offset


def _gaps_at(column: pa.Array, rows: Rows) -> NDArray[np.bool_] | None:
    """Tell on which of a few rows there is null; None: on none."""
    bits = column.buffers()[0]
    if bits is None:
        return None
    places = rows + column.offset
    empty: NDArray[np.bool_] = np.frombuffer(bits, np.uint8)[places >> 3] & _BIT[places & 7] == 0
    return empty if empty.any() else None
