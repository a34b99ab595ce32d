import math
from contextlib import suppress
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from api.formats import FormatError, Limits, ParsedLog, Problem, parse
from api.formats.delimited import DelimitedText
from api.formats.log import Reading
from api.formats.writer import write_native_csv
from core.samples import ALTITUDE, COURSE, LATITUDE, LONGITUDE, SPEED

HEADER = "t,ax,ay,az,gx,gy,gz,fix,lat,lon,alt,speed,course"
ROWS = [
    "0.000,0.1,0.2,9.8,0.01,0.02,0.03,1,45.5,12.25,10,5,90",
    "0.005,0.1,0.2,9.8,0.01,0.02,0.03,,,,,,",
    "0.010,0.1,0.2,9.8,,,,,,,,,",
    "0.015,0.1,0.2,9.8,0.01,0.02,0.03,1,45.5,12.25,,6,",
]


def read(text: str | bytes, **limits: int) -> ParsedLog:
    body = text.encode() if isinstance(text, str) else text
    return parse(body, "text/csv", None, Limits(**limits))


def log(*rows: str, header: str = HEADER) -> str:
    return "\n".join([header, *(rows or ROWS)]) + "\n"


def refused(text: str | bytes, **limits: int) -> FormatError:
    with pytest.raises(FormatError) as caught:
        read(text, **limits)
    return caught.value


def problem(text: str | bytes) -> Problem:
    error = refused(text)
    assert error.status == 422
    assert error.detail == str(error.problems[0])
    return error.problems[0]


def with_cell(column: str, value: str, row: int = 0) -> str:
    """The good log with one cell changed."""
    rows = [line.split(",") for line in ROWS]
    rows[row][HEADER.split(",").index(column)] = value
    return log(*(",".join(line) for line in rows))


def test_gives_si_units_and_radians() -> None:
    samples = read(log()).samples().samples
    assert samples.t.tolist() == [0.0, 0.005, 0.010, 0.015]
    assert samples.f_s[3].tolist() == [0.1, 0.2, 9.8]
    assert samples.w_s[0].tolist() == [0.01, 0.02, 0.03]
    assert np.isnan(samples.w_s[2]).all()
    assert samples.fix_row.tolist() == [0, 3]
    assert samples.fix_valid.all()
    np.testing.assert_allclose(
        samples.fix[0, [LATITUDE, LONGITUDE, ALTITUDE, SPEED, COURSE]],
        [math.radians(45.5), math.radians(12.25), 10, 5, math.pi / 2],
    )
    assert np.isnan(samples.fix[1, [ALTITUDE, COURSE]]).all()


def test_milliseconds_and_any_column_order() -> None:
    text = "course,speed,fix,az,ay,ax,t_ms\n90,3,1,9.8,0.2,0.1,500\n"
    samples = read(text).samples().samples
    assert samples.t.tolist() == [0.5]
    assert samples.f_s.tolist() == [[0.1, 0.2, 9.8]]
    assert np.isnan(samples.w_s).all()


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("mark", ["", "\ufeff"])
def test_line_ends_and_byte_order_mark(end: str, mark: str) -> None:
    expected = read(log()).samples().samples
    got = read(mark + log().replace("\n", end)).samples().samples
    np.testing.assert_array_equal(got.f_s, expected.f_s)
    np.testing.assert_array_equal(got.fix, expected.fix)


def test_blank_lines_quotes_signs_and_blanks_in_cells() -> None:
    text = log('"0.0", +0.1 ,0.2,9.8,,,,1,45.5,12.25,10,5,90', "", "   ", "0.1,0.1,0.2,9.8,,,,,,,,,")
    samples = read(text).samples().samples
    assert samples.t.tolist() == [0.0, 0.1]
    assert samples.f_s[0, 0] == 0.1


def test_line_numbers_count_blank_lines() -> None:
    assert problem(log(ROWS[0], "", "", ROWS[1].replace("9.8", "x"))).line == 5


def test_unknown_columns_are_reported_once_with_the_name_that_is_close() -> None:
    rows = [row + ",1,2" for row in ROWS]
    notices = read(log(*rows, header=HEADER + ",rpm,Velocity")).notices
    assert len(notices) == 2
    assert "rpm" in notices[0]
    assert '"speed"' in notices[1]


MORE = "mx,my,mz,steer,temp,pressure"


def with_more(cells: str) -> Reading:
    return read(log(*(f"{row},{cells}" for row in ROWS), header=f"{HEADER},{MORE}")).samples()


def test_magnetometer_steering_wheel_temperature_and_pressure_are_read() -> None:
    samples = with_more("20,-3,41.5,0.1,,101325").samples
    assert samples.m_s is not None
    assert samples.steer is not None
    assert samples.temperature is not None
    assert samples.pressure is not None
    np.testing.assert_array_equal(samples.m_s, [[20, -3, 41.5]] * len(ROWS))
    np.testing.assert_array_equal(samples.steer, [0.1] * len(ROWS))
    assert np.isnan(samples.temperature).all()
    np.testing.assert_array_equal(samples.pressure, [101325] * len(ROWS))


def test_without_those_columns_there_are_none() -> None:
    samples = read(log(*ROWS)).samples().samples
    assert (samples.m_s, samples.steer, samples.temperature, samples.pressure) == (None, None, None, None)


def test_what_was_written_is_read_again_with_all_columns() -> None:
    samples = with_more("20,-3,41.5,0.1,21.25,101325").samples
    again = read(write_native_csv(samples)).samples().samples
    for name in ("m_s", "steer", "temperature", "pressure"):
        np.testing.assert_array_equal(getattr(again, name), getattr(samples, name))


@pytest.mark.parametrize(("cells", "column"), [("1,,3,,,", "my"), ("1,2,3,inf,,", "steer"), ("1,2,3,,,x", "pressure")])
def test_of_those_columns_too_the_faulty_cell_is_named(cells: str, column: str) -> None:
    found = problem(log(*(f"{row},{cells}" for row in ROWS), header=f"{HEADER},{MORE}"))
    assert (found.line, found.column) == (2, column)


@pytest.mark.parametrize(
    ("column", "value", "expected"),
    [
        ("t", "", "a finite number"),
        ("t", "nan", "a finite number"),
        ("ax", "abc", "a number"),
        ("ay", "inf", "a finite number"),
        ("az", "", "a finite number"),
        ("az", "1e999", "a finite number"),
        ("ax", "1_000", "a number"),
        ("ax", "0x10", "a number"),
        ("gx", "inf", "a finite number or an empty cell"),
        ("gy", "", "gx, gy and gz all filled or all empty"),
        ("fix", "2", "1, 0 or an empty cell"),
        ("fix", "yes", "a number"),
        ("lat", "90.1", "degrees from -90 to 90"),
        ("lon", "-181", "degrees from -180 to 180"),
        ("lat", "", "a latitude beside the longitude"),
        ("course", "360.5", "degrees from 0 to 360"),
        ("course", "-1", "degrees from 0 to 360"),
        ("speed", "-0.1", "m/s, not negative"),
        ("speed", "-inf", "a finite number or an empty cell"),
    ],
)
@pytest.mark.parametrize("row", [0, 3])
def test_a_bad_cell_is_named(column: str, value: str, expected: str, row: int) -> None:
    found = problem(with_cell(column, value, row))
    assert (found.line, found.column, found.expected) == (row + 2, column, expected)
    assert (repr(value) if value else "an empty cell") in found.message


def test_the_first_bad_line_comes_first() -> None:
    rows = [*ROWS[:2], ROWS[2].replace("9.8", "nan"), ROWS[3].replace("45.5", "95")]
    assert [(p.line, p.column) for p in refused(log(*rows)).problems] == [(4, "az"), (5, "lat")]


def test_values_on_rows_without_a_fix_are_not_judged() -> None:
    row = "0.02,0.1,0.2,9.8,,,,0,999,999,,-1,999"
    assert read(log(*ROWS, row)).samples().samples.fix_row.tolist() == [0, 3]


def test_time_running_backwards() -> None:
    found = problem(log(*ROWS, "0.0149,0.1,0.2,9.8,,,,,,,,,"))
    assert (found.line, found.column) == (6, "t")
    assert found.expected == "a time not before 0.015"


def test_equal_times_are_allowed() -> None:
    assert read(log(ROWS[0], ROWS[0])).rows == 2


@pytest.mark.parametrize("row", ["0,1,2", ROWS[0] + ",1"])
def test_ragged_row(row: str) -> None:
    found = problem(log(ROWS[0], row))
    assert found.line == 3
    assert found.expected == "13 cells"


def test_missing_and_misspelt_columns() -> None:
    error = refused("Time,acc_x,ay,az,fix,speed,course\n0,0,0,9.8,,,\n")
    assert [(p.line, p.column) for p in error.problems] == [(1, "t"), (1, "ax")]
    assert '"Time"' in error.problems[0].message
    assert '"acc_x"' in error.problems[1].message


@pytest.mark.parametrize(
    ("header", "column"),
    [
        ("t,ax,ay,az,speed,course", "fix"),
        ("t,ax,ay,az,fix", "speed"),
        ("t,ax,ay,az,fix,speed", "course"),
        ("t,ax,ay,az,fix,lat", "lon"),
        ("t,ax,ay,az,gx,fix,lat,lon", "gy"),
        ("t,ax,ay,az,fix,lat,lon,ax", "ax"),
        ("t,t_ms,ax,ay,az,fix,lat,lon", "t_ms"),
        ("," * 5_000_000, None),
        ("x" * 100_000, None),
    ],
)
def test_headers_that_cannot_work(header: str, column: str | None) -> None:
    found = problem(f"{header}\n")
    assert (found.line, found.column) == (1, column)


@pytest.mark.parametrize(
    ("row", "column"),
    [
        ("0,0,0,9.8,1,,,,", "speed"),
        ("0,0,0,9.8,1,,,5,", "course"),
        ("0,0,0,9.8,1,,,,90", "speed"),
    ],
)
def test_a_fix_must_give_a_position_or_a_velocity(row: str, column: str) -> None:
    found = problem(log("0,0,0,9.8,1,45,12,,", row, header="t,ax,ay,az,fix,lat,lon,speed,course"))
    assert (found.line, found.column) == (3, column)


def test_a_standing_receiver_may_leave_the_course_empty() -> None:
    samples = read("t,ax,ay,az,fix,speed,course\n0,0,0,9.8,1,0.2,\n").samples().samples
    assert np.isnan(samples.fix[0, COURSE])


@pytest.mark.parametrize(
    ("body", "words"),
    [
        (b"", "empty"),
        (b" \r\n\n", "empty"),
        (b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", "not text"),
        (b"\xff\xd8\xff\xe0JFIF rubbish", "not text"),
        ("t,ax\n".encode("utf-16"), "not text"),
        (HEADER.encode(), "no samples"),
        (HEADER.replace(",", ";").encode(), "commas"),
        (b"0,1,2,3\n", "found numbers"),
    ],
)
def test_bodies_that_are_no_log(body: bytes, words: str) -> None:
    assert words in problem(body).message


def test_too_many_rows() -> None:
    assert read(log(), max_rows=4).rows == 4
    assert refused(log(), max_rows=3).status == 413
    assert refused(log().replace("\n", "\r"), max_rows=3).status == 413


def test_zeros_between_fixes_are_filling_but_a_lasting_zero_is_a_report() -> None:
    header = "t,ax,ay,az,fix,speed,course"
    times = np.arange(0, 20, 0.1)
    rows = [f"{t:.1f},0,0,9.8,{1 if t < 10 and round(t * 10) % 10 == 0 else 0},3,90" for t in times]
    samples = read(log(*rows, header=header)).samples().samples
    reports = samples.t[samples.fix_row]
    np.testing.assert_allclose(reports[samples.fix_valid], np.arange(10))
    np.testing.assert_allclose(reports[~samples.fix_valid], [14.1, 15.1, 16.1, 17.1, 18.1, 19.1])


@given(cuts=st.sets(st.integers(1, 199)))
def test_reports_without_a_fix_are_the_same_however_the_log_is_cut(cuts: set[int]) -> None:
    generator = np.random.default_rng(5)
    fix = np.where(generator.random(200) < 0.03, 1, 0)
    rows = [f"{t:.2f},0,0,9.8,{fix[i]},3,90" for i, t in enumerate(np.cumsum(generator.random(200)))]
    header = "t,ax,ay,az,fix,speed,course"
    whole = read(log(*rows, header=header)).samples().samples
    context: dict[str, Any] = {}
    reports: list[tuple[Any, Any]] = []
    bounds = [0, *sorted(cuts), 200]
    for start, stop in pairwise(bounds):
        samples, _, context = read(log(*rows[start:stop], header=header)).samples(context)
        reports += zip(samples.t[samples.fix_row], samples.fix_valid, strict=True)
    assert reports == list(zip(whole.t[whole.fix_row], whole.fix_valid, strict=True))


def test_a_new_session_starts_with_a_fresh_clock() -> None:
    header = "t,ax,ay,az,fix,speed,course"
    context = read(log("1000,0,0,9.8,1,3,90", header=header)).samples().context
    samples = read(log("0,0,0,9.8,0,,", header=header)).samples(context).samples
    assert samples.fix_row.tolist() == [0]


CELLS = st.one_of(
    st.floats(allow_nan=False, allow_infinity=False).map(repr),
    st.sampled_from(["", " ", "1", "-0", "1e5", ".5", "5.", "nan", "inf", "+1", "x", '"2"', "1_0", "--1", "1 2", "١"]),
)


@settings(max_examples=200)
@given(st.lists(st.tuples(CELLS, CELLS, CELLS), min_size=1, max_size=4))
def test_the_quick_and_the_patient_reader_agree(rows: list[tuple[str, str, str]]) -> None:
    content = "\n".join(["a,b,c", *(",".join(row) for row in rows)]).encode()
    text = DelimitedText(content, ("a", "b", "c"), ",", header_lines=1)
    wanted = ("a", "c")
    try:
        patient = text._patient(wanted)
    except FormatError:
        with pytest.raises(FormatError):
            text.read(wanted)
        return
    np.testing.assert_array_equal(text.read(wanted).values, patient)


NUMBERS = st.one_of(
    st.floats(allow_nan=False, allow_infinity=False).map(repr),
    st.from_regex(r"[+-]?[0-9]{1,20}(\.[0-9]{0,20})?", fullmatch=True),
    st.from_regex(r"-?[0-9]{0,3}\.[0-9]{1,6}", fullmatch=True),
    st.from_regex(r"[+-]?[0-9]{1,18}(\.[0-9]{0,9})?[eE][+-]?[0-9]{1,12}", fullmatch=True),
    st.sampled_from(["0e999999999999", "-0.0", "9007199254740993", "1e22", "1e23", "5e-324", "0" * 30 + "1.5"]),
)


@settings(max_examples=500)
@given(st.lists(NUMBERS, min_size=1, max_size=8), st.sampled_from(["\n", "\r\n", "\r"]), st.booleans())
def test_compiled_numbers_are_those_of_python_to_the_last_bit(cells: list[str], end: str, ended: bool) -> None:
    content = end.join(["a,b", *(f"{cell}," for cell in cells)]).encode() + (end.encode() if ended else b"")
    columns = DelimitedText(content, ("a", "b"), ",", header_lines=1)._compiled(("b", "a"))
    assert columns is not None
    assert columns[1].tobytes() == np.array([float(cell) for cell in cells]).tobytes()
    assert np.isnan(columns[0]).all()
    assert columns[0].size == len(cells)


@settings(max_examples=500)
@given(st.text('01.,-+eE \n\r"nax;', max_size=60))
def test_what_the_compiled_reader_reads_the_patient_one_reads_too(rows: str) -> None:
    text = DelimitedText(f"a,b\n{rows}".encode(), ("a", "b"), ",", header_lines=1)
    columns = text._compiled(("b",))
    if columns is not None:
        assert columns.tobytes() == text._patient(("b",)).tobytes()


def test_numbers_with_more_digits_than_a_double_are_few_or_read_otherwise() -> None:
    rows = [f"{n}.0123456789012345678" for n in range(9000)]
    text = DelimitedText("\n".join(["a", *rows]).encode(), ("a",), ",", header_lines=1)
    assert text._compiled(("a",)) is None
    assert text.read(("a",)).columns["a"].tolist() == [float(row) for row in rows]


@settings(max_examples=300)
@given(
    st.binary(max_size=200),
    st.sampled_from(["text/csv", "text/vnd.livella.tmd2", "application/vnd.apache.arrow.stream"]),
)
def test_any_bytes_are_read_or_refused(body: bytes, media_type: str) -> None:
    with suppress(FormatError):  # and nothing else
        assert len(parse(body, media_type, None).samples().samples)


@settings(max_examples=300)
@given(st.integers(0, 400), st.binary(min_size=1, max_size=3))
def test_a_good_log_with_any_bytes_written_over_it_is_read_or_refused(place: int, damage: bytes) -> None:
    body = bytearray(log().encode())
    body[place : place + len(damage)] = damage
    with suppress(FormatError):  # and nothing else
        assert len(read(bytes(body)).samples().samples)


def test_a_fix_without_a_position_names_the_column_that_is_not_there() -> None:
    found = problem("t,ax,ay,az,fix,lat,lon\n0,0,0,9.8,1,,\n")
    assert (found.line, found.column) == (2, "speed")
    assert "an empty cell" in found.message


def test_names_cannot_steer_a_terminal_or_begin_a_line() -> None:
    (notice,) = read("t,ax,ay,az,fix,speed,course,\x1b[31m\n0,0,0,9.8,1,3,90,\n").notices
    assert notice.isprintable()
    assert "\\x1b[31m" in notice


def test_readings_whose_sum_is_not_finite_are_finite() -> None:
    samples = read("t,ax,ay,az,fix,speed,course\n0,1e308,0,9.8,1,0,0\n1,1e308,0,9.8,,,\n").samples().samples
    assert samples.f_s[:, 0].tolist() == [1e308, 1e308]
    assert problem("t,ax,ay,az,fix,speed,course\n0,inf,0,9.8,1,0,0\n1,-inf,0,9.8,,,\n").column == "ax"
