"""Drives as devices send them: a pool of different ones, each with minutes before the run and minutes for it."""

from collections.abc import Sequence
from io import BytesIO
from typing import NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.compute
import zstandard

from api.formats import arrow_stream, native_csv
from api.formats.native import ACCELERATION
from api.formats.writer import write_native_csv
from benchmarks.load_study.client import Body
from core import Samples
from core.simulation import Scenario, simulate

CHUNK = 60.0
"""s"""
IMU_RATE = 200.0
"""Hz, three axes"""
GPS_RATE = 4.0
"""Hz"""
DRIVES = 20
BEFORE = 6
"""minutes driven before the run: every mounting is confirmed by then"""
DURING = 4
"""minutes of the run"""
CSV, ARROW = "CSV zstd", "Arrow zstd"
ENCODINGS = (CSV, ARROW)

COUNTED = {
    **dict.fromkeys(ACCELERATION, (pa.int16(), 4 * 9.80665 / 2**15)),
    **{"lat": (pa.int32(), 1e-7), "lon": (pa.int32(), 1e-7), "alt": (pa.int32(), 1e-3)},
    **{"speed": (pa.int32(), 1e-3), "course": (pa.int32(), 1e-5)},
}
"""how an accelerometer of +-4 g and a usual receiver count: 16 bit, and the integers of its binary protocol"""


class Drive(NamedTuple):
    """One of the pool."""

    before: list[Samples]
    during: list[Samples]


def pool(drives: int = DRIVES, before: int = BEFORE, during: int = DURING) -> list[Drive]:
    """Simulate different drives, each in whole minutes."""
    return [_drive(seed, before, during) for seed in range(drives)]


def _drive(seed: int, before: int, during: int) -> Drive:
    seconds = CHUNK * (before + during)
    scenario = Scenario(seconds=seconds, seed=seed, gyro=False, imu_rate=IMU_RATE, gps_rate=GPS_RATE)
    samples = simulate(scenario).samples
    cuts = np.searchsorted(samples.t, CHUNK * np.arange(before + during + 1)).tolist()
    minutes = [samples.slice(first, last) for first, last in zip(cuts, [*cuts[1:-1], len(samples)], strict=False)]
    return Drive(minutes[:before], minutes[before:])


def encode(samples: Samples, encoding: str) -> Body:
    """Give a minute as it is sent."""
    content = write_arrow(samples) if encoding == ARROW else write_native_csv(samples)
    kind = arrow_stream.MEDIA_TYPE if encoding == ARROW else native_csv.MEDIA_TYPE
    content = zstandard.compress(content)
    headers = f"Content-Type: {kind}\r\nContent-Encoding: zstd\r\nContent-Length: {len(content)}\r\n"
    return Body(headers.encode(), content)


def encode_all(drives: Sequence[Drive], encoding: str) -> list[list[Body]]:
    """Give the minutes of the run, by drive."""
    return [[encode(minute, encoding) for minute in drive.during] for drive in drives]


def write_arrow(samples: Samples) -> bytes:
    """Write samples as an Arrow stream of what the sensors count, each column with its scale."""
    read = pa.csv.read_csv(BytesIO(write_native_csv(samples)))
    columns = {name: _counted(read[name], *COUNTED[name]) for name in read.column_names if name in COUNTED}
    columns |= {"t_ms": _counted(read["t"], pa.int32(), 1e-3), "fix": read["fix"].cast(pa.int8())}
    assert {"t", "fix", *COUNTED} == set(read.column_names)
    fields = [pa.field(name, column.type, metadata=_scale(name)) for name, column in columns.items()]
    table = pa.table(columns, schema=pa.schema(fields))
    out = BytesIO()
    with pa.ipc.new_stream(out, table.schema) as stream:
        stream.write_table(table.combine_chunks())
    return out.getvalue()


def _counted(column: pa.ChunkedArray, kind: pa.DataType, scale: float) -> pa.ChunkedArray:
    return pa.compute.round(pa.compute.divide(column.cast(pa.float64()), scale)).cast(kind)


def _scale(name: str) -> dict[str, str] | None:
    return {"scale_factor": repr(COUNTED[name][1])} if name in COUNTED else None
