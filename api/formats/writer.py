"""Samples -> native CSV."""

from io import BytesIO

import numpy as np
import pyarrow as pa
import pyarrow.csv

from api.formats.delimited import Columns, Floats
from api.formats.native import ACCELERATION, FIELD, GPS, OTHERS, RATE
from core import Samples

_DECIMALS = dict.fromkeys(("t", "alt", "speed_acc", "course_acc", "course"), 4) | dict.fromkeys(ACCELERATION, 5)
_DECIMALS |= dict.fromkeys(RATE, 6) | {"lat": 8, "lon": 8, "speed": 4, "vz": 4}
_DECIMALS |= dict.fromkeys(FIELD, 3) | {"steer": 5, "temp": 2, "pressure": 2}
"""enough that rounding stays far below the sensors' noise: 0.1 ms, 10 um/s2, 1 urad/s, 1 mm, 0.1 mm/s, 1 nT, 1 cPa"""

_ALWAYS = frozenset({"t", *ACCELERATION, "lat", "lon", "alt", "speed", "course"})


def write_native_csv(samples: Samples) -> bytes:
    """Write samples as native CSV, rounded to sensible decimals; columns nobody filled are left out."""
    columns = {"t": samples.t, **by_name(ACCELERATION, samples.f_s), **by_name(RATE, samples.w_s)}
    if samples.m_s is not None:
        columns |= by_name(FIELD, samples.m_s)
    others = (samples.steer, samples.temperature, samples.pressure)
    columns |= {name: values for name, values in zip(OTHERS, others, strict=True) if values is not None}
    table = {
        name: pa.array(_rounded(name, values), from_pandas=True)
        for name, values in columns.items()
        if _kept(name, values)
    }
    table["fix"] = _spread(samples.fix_valid.astype(np.int8), samples, samples.fix_row.size)
    for name, values in gps_columns(samples).items():
        if _kept(name, values):
            table[name] = _spread(_rounded(name, values), samples, samples.fix_row.size)
    out = BytesIO()
    out.write((",".join(table) + "\n").encode())
    pa.csv.write_csv(pa.table(table), out, pa.csv.WriteOptions(include_header=False, quoting_style="none"))
    return out.getvalue()


def by_name(names: tuple[str, ...], values: Floats) -> Columns:
    """Give the columns (N,) of values (N, K) by their names."""
    return dict(zip(names, values.T, strict=True))


def gps_columns(samples: Samples) -> Columns:
    """Give the columns of the reports (M,) in the units of a log; a report without a fix is empty."""
    columns = by_name(GPS, np.where(samples.fix_valid[:, None], samples.fix, np.nan))
    angles = ("lat", "lon", "course", "course_acc")
    return columns | {name: np.degrees(columns[name]) for name in angles}


def _kept(name: str, values: Floats) -> bool:
    return name in _ALWAYS or bool(np.isfinite(values).any())


def _rounded(name: str, values: Floats) -> Floats:
    rounded: Floats = np.round(values, _DECIMALS[name])
    return rounded


def _spread(values: np.ndarray, samples: Samples, reports: int) -> pa.Array:
    """Put one value for each report on its row; the other rows are empty."""
    index = np.full(len(samples), -1)
    index[samples.fix_row] = np.arange(reports)
    return pa.array(values, from_pandas=True).take(pa.array(index, mask=index < 0))
