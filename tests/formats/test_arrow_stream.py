from io import BytesIO
from typing import Any

import numpy as np
import pyarrow as pa
import pytest

from api.formats import FormatError, Limits, ParsedLog, parse

MEDIA_TYPE = "application/vnd.apache.arrow.stream"
COLUMNS: dict[str, Any] = {
    "t": [0.0, 0.005, 0.01],
    "ax": [0.1, 0.1, 0.1],
    "ay": [0.2, 0.2, 0.2],
    "az": [9.8, 9.8, 9.8],
    "fix": pa.array([1, None, 1], pa.int8()),
    "speed": [3.0, None, 4.0],
    "course": [90.0, None, 91.0],
}

NO_NUMBERS = ["", "nan", "inf", "1e31", "-1e31", "one", "0x10", "1_000", " 1", "1" * 41, "\n"]


def stream(columns: dict[str, Any] = COLUMNS, batches: int = 1, **options: Any) -> bytes:
    out, table = BytesIO(), pa.table(columns)
    with pa.ipc.new_stream(out, table.schema, options=pa.ipc.IpcWriteOptions(**options)) as writer:
        for _ in range(batches):
            writer.write_table(table)
    return out.getvalue()


def read(body: bytes, **limits: int) -> ParsedLog:
    return parse(body, MEDIA_TYPE, None, Limits(**limits))


def refused(body: bytes, **limits: int) -> FormatError:
    with pytest.raises(FormatError) as caught:
        read(body, **limits)
    return caught.value


def test_reads_the_same_as_csv() -> None:
    csv = b"t,ax,ay,az,fix,speed,course\n0,.1,.2,9.8,1,3,90\n.005,.1,.2,9.8,,,\n.01,.1,.2,9.8,1,4,91\n"
    expected, got = parse(csv, "text/csv", None).samples().samples, read(stream()).samples().samples
    for name, values in vars(expected).items():
        np.testing.assert_array_equal(getattr(got, name), values)


def test_small_integers_and_floats() -> None:
    columns = COLUMNS | {"t_ms": pa.array([0, 5, 10], pa.uint32()), "az": pa.array([9.8, 9.8, 9.8], pa.float32())}
    del columns["t"]
    samples = read(stream(columns)).samples().samples
    assert samples.t.tolist() == [0, 0.005, 0.01]
    assert samples.f_s[0, 2] == pytest.approx(9.8)


def with_metadata(name: str, values: pa.Array, metadata: dict[str, str]) -> bytes:
    """Give a stream with one column packed as the CF conventions say."""
    table = pa.table(COLUMNS | {name: values})
    field = table.schema.field(name).with_metadata(metadata)
    return stream_of(table.cast(table.schema.set(table.schema.get_field_index(name), field)))


def stream_of(table: pa.Table) -> bytes:
    out = BytesIO()
    with pa.ipc.new_stream(out, table.schema) as writer:
        writer.write_table(table)
    return out.getvalue()


def test_counts_stand_for_what_their_scale_says() -> None:
    counts = pa.array([-2, 0, 30_000], pa.int16())
    body = with_metadata("az", counts, {"scale_factor": "0.25", "add_offset": "-1e1"})
    assert read(body).samples().samples.f_s[:, 2].tolist() == [-10.5, -10.0, 7490.0]
    heights = with_metadata("alt", pa.array([5, None, -5], pa.int8()), {"add_offset": "100"})
    assert read(heights).samples().samples.fix[:, 2].tolist() == [105.0, 95.0]


def test_the_long_way_scales_too() -> None:
    """Several pieces, and times out of order, are not for the short one."""
    counts = pa.array([4, 8, 12], pa.int16())
    table = pa.table(COLUMNS | {"ax": counts})
    scaled = table.schema.set(1, table.schema.field("ax").with_metadata({"scale_factor": "0.5"}))
    out = BytesIO()
    with pa.ipc.new_stream(out, scaled) as writer:
        writer.write_table(table.slice(0, 2).cast(scaled))
        writer.write_table(table.slice(2).cast(scaled))
    assert read(out.getvalue()).samples().samples.f_s[:, 0].tolist() == [2.0, 4.0, 6.0]


def test_another_scale_is_another_log() -> None:
    counts = pa.array([1, 2, 3], pa.int16())
    first, second = (read(with_metadata("ax", counts, {"scale_factor": text})) for text in ("0.25", "0.5"))
    assert first.fingerprint.digest != second.fingerprint.digest


@pytest.mark.parametrize(
    ("key", "text"),
    [
        *((key, text) for key in ("scale_factor", "add_offset") for text in NO_NUMBERS),
        *(("scale_factor", text) for text in ("0", "0.0", "-0e5")),
    ],
)
def test_what_is_no_scale_is_refused(key: str, text: str) -> None:
    problem = refused(with_metadata("ay", pa.array([1, 2, 3], pa.int16()), {key: text})).problems[0]
    assert problem.column == "ay"
    assert key in problem.message
    assert "\n" not in problem.message


def test_a_scale_goes_with_integers_only() -> None:
    problem = refused(with_metadata("ay", pa.array([1.0, 2.0, 3.0]), {"scale_factor": "2"})).problems[0]
    assert (problem.column, problem.expected) == ("ay", "integers where there is a scale_factor")
    problem = refused(with_metadata("fix", pa.array([1, 0, 1], pa.int8()), {"scale_factor": "2"})).problems[0]
    assert (problem.column, problem.expected) == ("fix", "fix without a scale")


def test_a_scale_of_an_ignored_column_does_not_matter() -> None:
    body = with_metadata("other", pa.array([1, 2, 3], pa.int8()), {"scale_factor": "much"})
    assert "other" in read(body).notices[0]


def test_a_bad_cell_is_named_by_its_row() -> None:
    problem = refused(stream(COLUMNS | {"ay": [0.2, np.nan, 0.2]})).problems[0]
    assert (problem.line, problem.column, problem.expected) == (2, "ay", "a finite number")


@pytest.mark.parametrize("values", [["a", "b", "c"], [[1.0], [2.0], [3.0]], [b"x", b"y", b"z"]])
@pytest.mark.parametrize("name", ["ax", "unknown"])
def test_columns_that_are_no_numbers(name: str, values: list[Any]) -> None:
    error = refused(stream(COLUMNS | {name: pa.array(values)}))
    assert (error.status, error.problems[0].column) == (422, name)


def test_unknown_and_missing_columns() -> None:
    assert "rpm" in read(stream(COLUMNS | {"rpm": [1, 2, 3]})).notices[0]
    columns = dict(COLUMNS)
    del columns["fix"]
    assert refused(stream(columns)).problems[0].column == "fix"


@pytest.mark.parametrize("compression", ["lz4", "zstd"])
def test_compression_inside_the_stream_is_refused(compression: str) -> None:
    zeros = np.zeros(1_000_000)
    columns = dict.fromkeys(COLUMNS, zeros)
    error = refused(stream(columns, compression=compression))
    assert error.status == 422
    assert "compress the whole body" in error.detail


def test_too_many_rows() -> None:
    assert read(stream(), max_rows=3).rows == 3
    assert refused(stream(COLUMNS, batches=2), max_rows=5).status == 413


@pytest.mark.parametrize(
    "body",
    [b"", b"\xff\xff\xff\xff", b"\xff" * 4 + bytes(4), b"t,ax\n1,2\n", b"ARROW1\0\0" + bytes(100), stream()[:200]],
)
def test_no_stream(body: bytes) -> None:
    assert refused(body).status == 422


def test_no_rows() -> None:
    empty = {name: pa.array([], pa.float64()) for name in COLUMNS}
    assert "no samples" in refused(stream(empty)).detail


def test_damaged_streams_are_refused_or_read() -> None:
    generator = np.random.default_rng(7)
    for _ in range(300):
        body = bytearray(stream())
        body[generator.integers(len(body))] = generator.integers(256)
        try:
            assert read(bytes(body)).rows <= 3
        except FormatError as error:
            assert error.problems or error.status == 413  # noqa: PT017 either outcome is right, another exception is not


def test_a_fix_without_a_position_names_the_column_that_is_not_there() -> None:
    empty = pa.array([None] * 3, pa.float64())
    places = {"lat": empty, "lon": empty}
    columns = {name: column for name, column in COLUMNS.items() if name not in {"speed", "course"}}
    with pytest.raises(FormatError) as caught:
        read(stream(columns | places))
    assert caught.value.problems[0].column == "speed"


def test_names_cannot_begin_a_line_of_a_log() -> None:
    with pytest.raises(FormatError) as caught:
        read(stream(COLUMNS | {"x\nforged": ["a", "b", "c"]}))
    assert str(caught.value).isprintable()
