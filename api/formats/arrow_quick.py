"""The Arrow columns that devices usually send, packed with no detour over a table of 64-bit numbers: half the work.

Whatever is unusual or not sound is left to that detour, which tells exactly what is wrong.
"""

import math
from typing import Any, Final

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from api.formats import _native_kernel
from api.formats.arrow_scale import Scale, Scales
from api.formats.checks import Rows
from api.formats.delimited import Floats
from api.formats.native import ACCELERATION, FIELD, GPS, OTHERS, RATE, SLOW, TIME, UNITS, Packed

_Columns = dict[str, pa.Array]
_DENSE: Final = frozenset({*TIME, *ACCELERATION, *RATE})


def pack(batch: pa.RecordBatch, scales: Scales) -> Packed | None:
    """Give the columns of a batch as samples are made of them; None when the other way has to look at them."""
    columns: _Columns = dict(zip(batch.schema.names, batch.columns, strict=True))
    if not _usual(columns):
        return None
    time = next(name for name in TIME if name in columns)
    t = np.empty(batch.num_rows)
    _fill(t, columns[time], scales.get(time))
    t *= UNITS[time]
    f_s = _axes(columns, ACCELERATION, scales)
    w_s = _axes(columns, RATE, scales) if RATE[0] in columns else None
    flags = _flags(columns["fix"])
    if flags is None or not (_in_order(t) and _finite(f_s) and (w_s is None or _finite(w_s))):
        return None
    fix_rows, none_rows = flags
    fix = _fixes(columns, fix_rows, scales)
    return None if fix is None else Packed(t, f_s, w_s, fix_rows, none_rows, fix)


def _usual(columns: _Columns) -> bool:
    """Tell whether the readings are all there, and numbers of a kind that is read without being cast."""
    if any(name in columns for name in (*FIELD, *OTHERS)):
        return False
    dense = all(column.null_count == 0 for name, column in columns.items() if name in _DENSE)
    numbers = (column.type for name, column in columns.items() if name in _DENSE or name in GPS)
    return (
        dense
        and all(kind in {pa.float32(), pa.float64()} or pa.types.is_integer(kind) for kind in numbers)
        and pa.types.is_integer(columns["fix"].type)
    )


def _fill(values: Floats, column: pa.Array, scale: Scale | None) -> None:
    """Take the numbers of a column with no nulls over."""
    if scale is None:
        values[:] = column.to_numpy()
    else:
        scale.values(column.to_numpy(), out=values)


def _axes(columns: _Columns, names: tuple[str, ...], scales: Scales) -> Floats:
    axes = np.empty((len(columns[names[0]]), len(names)))
    for k, name in enumerate(names):
        _fill(axes[:, k], columns[name], scales.get(name))
    return axes


def _in_order(t: Floats) -> bool:
    """Tell whether times are finite and none is before the one before it: nan is in no order."""
    return math.isfinite(t[0]) and math.isfinite(t[-1]) and bool((t[1:] >= t[:-1]).all())


def _finite(values: Floats) -> bool:
    """Tell by their sum whether all values are finite; False of some that are, and huge."""
    with np.errstate(over="ignore", invalid="ignore"):
        return math.isfinite(values.sum())


def _flags(column: pa.Array) -> tuple[Rows, Rows] | None:
    """Give the rows with 1 and those with 0; None when there is anything else but null."""
    said, filled = _values(column), _filled(column)
    fix_rows, none_rows = np.flatnonzero((said == 1) & filled), np.flatnonzero((said == 0) & filled)
    return (fix_rows, none_rows) if fix_rows.size + none_rows.size + column.null_count == len(column) else None


def _fixes(columns: _Columns, rows: Rows, scales: Scales) -> Floats | None:
    """Give the fixes (M, 8), SI units and radians; None when one is not sound, or a number anywhere is infinite."""
    fix = np.full((rows.size, len(GPS)), np.nan)
    for k, name in enumerate(GPS):
        if name in columns:
            values = _values(columns[name])
            if values.dtype.kind == "f" and np.isinf(values).any():  # those behind nulls included
                return None
            scale, told = scales.get(name), values[rows]
            fix[:, k] = np.where(_filled_at(columns[name], rows), told if scale is None else scale.values(told), np.nan)
    return fix if _native_kernel.take_fixes(SLOW, fix) else None


def _values(column: pa.Array) -> NDArray[Any]:
    """Give the numbers (N,), anything where there is null."""
    start = column.offset * column.type.bit_width // 8
    return np.frombuffer(column.buffers()[1], column.type.to_pandas_dtype(), len(column), start)


def _filled(column: pa.Array) -> NDArray[np.bool_]:
    """Tell where there is no null, (N,)."""
    bits = column.buffers()[0]
    if bits is None:
        return np.ones(len(column), np.bool_)
    end = column.offset + len(column)
    return np.unpackbits(np.frombuffer(bits, np.uint8), count=end, bitorder="little")[column.offset :].view(np.bool_)


def _filled_at(column: pa.Array, rows: Rows) -> NDArray[np.bool_]:
    """Tell on which of a few rows there is no null."""
    bits = column.buffers()[0]
    if bits is None:
        return np.ones(rows.size, np.bool_)
    places = rows + column.offset
    filled: NDArray[np.bool_] = (np.frombuffer(bits, np.uint8)[places >> 3] >> (places & 7) & 1).astype(np.bool_)
    return filled
