"""Where fuzzing begins: a sound input of each kind, and some that were once trouble."""

import gzip
from io import BytesIO

import pyarrow as pa
import zstandard

import core
from api.services import paging
from core import snapshot
from tests.fuzz.targets import ENCODINGS

CSV = (
    b"t,ax,ay,az,gx,gy,gz,fix,lat,lon,alt,speed,course,vz,speed_acc,course_acc\n"
    b"0.00,0.1,-0.2,9.8,0,0,0.01,1,45.1,7.6,240,11.5,359.9,0.1,0.2,1.5\n"
    b"0.02,0.1,-0.2,9.8,0,0,0.01,,,,,,,,,\n"
    b"0.04,0.1,-0.2,9.8,,,,0,,,,,,,,\n"
    b"1.00,0.1,-0.2,9.8,0,0,0.01,1,45.1001,7.6001,241,11.6,0.1,,,\n"
)
THESIS = (
    b"1\t1000\t7.6\t45.1\t240\t40\t90\t1\t1.0\t2.0\t100.0\n"
    b"2\t1020\t7.6\t45.1\t240\t40\t90\t1\t1.0\t2.0\t100.0\n"
    b"3\t2000\t7.601\t45.1\t240\t41\t91\t1\t1.0\t2.0\t100.0\n"
    b"4\t2020\t\t\t\t\t\t0\t1.0\t2.0\t100.0\n"
)


def _arrow(compression: str | None = None) -> bytes:
    columns = {name: [0.0, 0.02, 1.0] for name in ("t", "ax", "ay", "az", "speed", "course")}
    table = pa.table(columns | {"fix": pa.array([1, None, 0], pa.int8())})
    sink = BytesIO()
    with pa.ipc.new_stream(sink, table.schema, options=pa.ipc.IpcWriteOptions(compression=compression)) as writer:
        writer.write_table(table)
    return sink.getvalue()


def _arrow_without_position() -> bytes:
    names = ("t", "ax", "ay", "az", "fix")
    empty = pa.array([None], pa.float64())
    table = pa.table({name: [1.0] for name in names} | {"lat": empty, "lon": empty})
    sink = BytesIO()
    with pa.ipc.new_stream(sink, table.schema) as writer:
        writer.write_table(table)
    return sink.getvalue()


def _arrow_counts() -> bytes:
    scale = {"scale_factor": "1e-3", "add_offset": "-1"}
    plain = [pa.field(name, pa.int32()) for name in ("t_ms", "fix", "lat", "lon")]
    schema = pa.schema([*plain, *(pa.field(name, pa.int16(), metadata=scale) for name in ("ax", "ay", "az", "alt"))])
    sink = BytesIO()
    with pa.ipc.new_stream(sink, schema) as writer:
        writer.write_table(pa.table({name: [1, 1, 1] for name in schema.names}, schema=schema))
    return sink.getvalue()


def _state() -> bytes:
    return snapshot.encode(core.begin_session(core.DEFAULT, core.initial_state(core.DEFAULT)))


CLOCK_TOO_COARSE = b"\x001\t0\t7.64\t5.1\t24\t0\t9\t1\t1\t2\t100\n2\t1" + b"3" * 45 + b"\t6\t1\t4\t1\t91\t1\t1\t2\t1"
INTERVAL_TOO_SHORT = b"\0" + b"".join(
    b"%d\t%.7f\t7.%d\t45\t240\t%d\t90\t1\t1\t2\t100\n" % (n, n * 1e-4, min(n, 5), 40 if n < 5 else 1) for n in range(9)
)


def _encoded(name: str, body: bytes) -> bytes:
    return bytes([ENCODINGS.index(name)]) + body


SEEDS: dict[str, list[bytes]] = {
    "native_csv": [
        b"",
        CSV,
        b"\xef\xbb\xbf" + CSV.replace(b"\n", b"\r\n"),
        b't_ms,"ax",ay,az,fix,speed,course\n"0",1,2,3,1,3,90\n1e308,1,2,3,1,3,90\n',
        b"t,ax,ay,az,fix,speed,course\n0,1e308,1e308,1e308,1,1e308,360\n",
        b"t,ax,ay,az,fix,speed,course\n0,nan,0,0,1,3,90\n",
        b"t,ax,ay,az,fix,speed,course\n-1e308,0,0,0,1,3,90\n1e308,0,0,0,1,3,90\n",
        b"t,ax,ay,az,fix,lat,lon\n0,0,0,0,1,,\n",
        b"t,ax,ay,az,fix,speed,course,\x1b[31m\n0,0,0,0,1,3,90,\n",
    ],
    "thesis_log": [
        b"",
        b"\0",
        b"\0" + THESIS,
        CLOCK_TOO_COARSE,
        INTERVAL_TOO_SHORT,
        b"\1" + THESIS.replace(b"\t", b";"),
        b"\2" + THESIS.replace(b"\t", b"  "),
    ],
    "arrow_stream": [
        b"",
        _arrow(),
        _arrow("lz4"),
        _arrow("zstd"),
        _arrow()[:-9],
        _arrow_without_position(),
        _arrow_counts(),
    ],
    "compression": [
        b"",
        _encoded("gzip", gzip.compress(CSV, mtime=0)),
        _encoded("gzip", gzip.compress(CSV, mtime=0) * 3 + bytes(8)),
        _encoded("zstd", zstandard.compress(CSV)),
        _encoded("zstd", zstandard.compress(bytes(2**21))),
        _encoded("identity", CSV),
        _encoded("br", CSV),
    ],
    "estimator": [
        CSV,
        b"t,ax,ay,az,fix,speed,course\n-1e308,0,0,0,1,3,90\n1e308,0,0,0,1,3,90\n",
        b"t,ax,ay,az,fix,speed,course\n0,1e308,1e308,1e308,1,1e308,360\n1,0,0,9.8,,,\n",
    ],
    "cursor": [
        *(b"", b"AA", b"!", "é".encode()),
        *(
            paging.encode(key).encode()
            for key in ("van-7", 2**62, "name van-7 box 7", "-last_data_at van-7 1714979289")
        ),
    ],
    "estimator_snapshot": [b"", _state(), _state()[:-1], b"LVLA" + bytes(10)],
    "event_position": [b"", b"0.1", b"123456789012345678.1", b"1.1.1", "١.١".encode(), b"-1.2"],
}
