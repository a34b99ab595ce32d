import json
import math
import subprocess
import sys
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from api.formats import FormatError, Limits, ParsedLog, parse
from core import Samples
from core.samples import ALTITUDE, COURSE, LATITUDE, LONGITUDE, SPEED

MEDIA_TYPE = "text/vnd.livella.tmd2"
LINE = "1\t0\t12.25\t45.5\t10\t36\t90\t1\t1\t2\t100"


def read(text: str, course: str = "auto", **limits: int) -> ParsedLog:
    return parse(text.encode(), MEDIA_TYPE, None, Limits(**limits), course)


def samples(text: str, course: str = "auto") -> Samples:
    return read(text, course).samples().samples


@dataclass
class Drive:
    """A made-up drive round a circle, with a stop, as the thesis' program would write it."""

    seconds: float = 60.0
    interval: float = 0.25
    stop: tuple[float, float] = (20.0, 35.0)
    anticlockwise: bool = False
    jitter: int = 0
    """rows by which a report may come late"""

    def lines(self) -> list[str]:
        generator = np.random.default_rng(1)
        late = generator.integers(0, self.jitter + 1, int(self.seconds / self.interval) + 1)
        per_report = round(self.interval / 0.005)
        out, cells = [], "0\t0\t0\t0\t0\t0"
        due = {k * per_report + int(late[k]): k for k in range(late.size)}
        for row in range(round(self.seconds / 0.005)):
            if row in due:
                cells = self._cells(due[row] * self.interval)
            out.append(f"{row}\t{row * 5}\t{cells}\t1\t2\t100")
        return out

    def reports(self) -> int:
        return math.ceil(self.seconds / self.interval)

    def _cells(self, t: float) -> str:
        moving = t - min(max(t - self.stop[0], 0.0), self.stop[1] - self.stop[0])
        parked = self.stop[0] <= t < self.stop[1]
        angle, radius = moving * 0.1, 100.0
        north, east = radius * math.sin(angle), radius * (1 - math.cos(angle))
        course = math.degrees(angle) % 360
        if self.anticlockwise:
            course = -course % 360
        latitude, longitude = 45 + north / 111_195, 12 + east / 78_627
        speed = 0.0 if parked else 36.0
        return f"{longitude:.7f}\t{latitude:.7f}\t10.0\t{speed:.2f}\t{course:.2f}\t1"


def text(lines: list[str]) -> str:
    return "\n".join(lines) + "\n"


def test_gives_si_units_and_radians() -> None:
    got = samples(LINE)
    np.testing.assert_allclose(got.f_s, [[0.0980665, 0.196133, 9.80665]])
    np.testing.assert_allclose(
        got.fix[0, [LATITUDE, LONGITUDE, ALTITUDE, SPEED, COURSE]],
        [math.radians(45.5), math.radians(12.25), 10, 10, math.pi / 2],
    )
    assert np.isnan(got.w_s).all()


@pytest.mark.parametrize("separator", ["\t", ";", ",", " ", "   ", " ; ", " , "])
@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_separators(separator: str, end: str) -> None:
    lines = [LINE, LINE.replace("\t0\t", "\t5\t", 1).replace("100", "99.5")]
    got = samples(end.join(line.replace("\t", separator) for line in lines))
    assert got.t.tolist() == [0.0, 0.005]
    assert got.f_s[1, 2] == pytest.approx(0.995 * 9.80665)


def test_blanks_before_and_after_a_line() -> None:
    assert len(samples("  " + LINE.replace("\t", "  ") + "  \n")) == 1


def test_a_moving_vehicle_gives_a_fix_where_the_cells_change() -> None:
    drive = Drive(seconds=10)
    got = samples(text(drive.lines()))
    np.testing.assert_array_equal(got.fix_row, np.arange(0, 2000, 50))
    assert got.fix_valid.all()


@pytest.mark.parametrize("interval", [0.1, 0.25, 1.0])
def test_a_parked_vehicle_gives_a_fix_at_the_usual_interval(interval: float) -> None:
    drive = Drive(interval=interval)
    got = samples(text(drive.lines()))
    np.testing.assert_allclose(np.diff(got.t[got.fix_row]), interval, atol=1e-9)
    assert got.fix_row.size == drive.reports()


def test_reports_that_come_late_are_neither_doubled_nor_lost() -> None:
    drive = Drive(jitter=3)
    reading = read(text(drive.lines())).samples()
    fix_rows = reading.samples.fix_row[reading.samples.fix_valid]
    gaps = np.diff(reading.samples.t[fix_rows])
    assert gaps.min() > 0.2
    assert gaps.max() < 0.3
    assert abs(fix_rows.size - drive.reports()) <= 2
    assert reading.rejected.get("fix_repeated", 0) <= 2


def test_frozen_cells_of_a_moving_vehicle_are_not_new() -> None:
    lines = Drive(seconds=5).lines()
    frozen = [f"{1000 + k}\t{5000 + 5 * k}\t" + "\t".join(lines[-1].split("\t")[2:]) for k in range(400)]
    assert samples(text(lines + frozen)).t[-1] > 6.9
    assert samples(text(lines + frozen)).fix_row.size == 20


def test_cells_only_on_the_rows_of_fixes() -> None:
    empty = LINE.split("\t")
    empty[2:8] = [""] * 6
    rows = []
    for k in range(400):
        cells = LINE.split("\t") if k % 50 == 0 else list(empty)
        cells[1] = str(5 * k)
        rows.append("\t".join(cells))
    np.testing.assert_array_equal(samples(text(rows)).fix_row, np.arange(0, 400, 50))


def test_no_fix() -> None:
    got = samples(text([f"{k}\t{5 * k}\t0\t0\t0\t0\t0\t0\t1\t2\t100" for k in range(1000)]))
    assert not got.fix_valid.any()
    np.testing.assert_allclose(got.t[got.fix_row], [0, 1, 2, 3, 4])


@pytest.mark.parametrize("written", ["clockwise", "anticlockwise"])
@pytest.mark.parametrize("asked", ["auto", "clockwise", "anticlockwise"])
def test_sense_of_the_course(written: str, asked: str) -> None:
    got = samples(text(Drive(anticlockwise=written == "anticlockwise").lines()), asked)
    bearing = 0.1 * np.where(got.t < 20, got.t, np.maximum(got.t - 15, 20))[got.fix_row]
    sign = 1.0 if asked in {"auto", written} else -1.0
    np.testing.assert_allclose(np.exp(1j * got.fix[:, COURSE]), np.exp(1j * sign * bearing), atol=1e-3)


def test_straight_north_leaves_the_sense_undecided_and_clockwise() -> None:
    lines = [f"{k}\t{250 * k}\t12\t{45 + 0.0001 * k:.6f}\t10\t160\t{k % 5 * 0.1}\t1\t1\t2\t100" for k in range(200)]
    reading = read(text(lines)).samples()
    assert "sense" not in reading.context
    assert reading.samples.fix[4, COURSE] == pytest.approx(math.radians(0.4))


def test_course_noise_of_a_parked_vehicle_does_not_decide() -> None:
    generator = np.random.default_rng(3)
    lines = [
        f"{k}\t{250 * k}\t{12 + 1e-4 * generator.normal():.6f}\t{45 + 1e-4 * generator.normal():.6f}"
        f"\t10\t{generator.random():.2f}\t{360 * generator.random():.1f}\t1\t1\t2\t100"
        for k in range(2000)
    ]
    assert "sense" not in read(text(lines)).samples().context


def in_pieces(lines: list[str], cuts: set[int], course: str) -> tuple[list[NDArray[np.float64]], list[str | None]]:
    """Fixes (t, columns...) of each piece, and the decision after it; the context goes through JSON, as in storage."""
    context, fixes, decided = "{}", [], []
    for start, stop in pairwise([0, *sorted(cuts), len(lines)]):
        reading = read(text(lines[start:stop]), course).samples(json.loads(context))
        context = json.dumps(reading.context, allow_nan=False)
        fixes.append(np.column_stack([reading.samples.t[reading.samples.fix_row], reading.samples.fix]))
        decided.append(reading.context.get("sense"))
    return fixes, decided


DRIVES = st.builds(
    Drive,
    seconds=st.just(40.0),
    interval=st.sampled_from([0.2, 0.25, 1.0]),
    stop=st.sampled_from([(12.0, 30.0), (18.0, 21.0)]),
    anticlockwise=st.booleans(),
    jitter=st.sampled_from([0, 2]),
)


@settings(max_examples=25, deadline=None)
@given(drive=DRIVES, cuts=st.sets(st.integers(1, 7999), max_size=12))
def test_a_log_in_pieces_reads_as_the_whole(drive: Drive, cuts: set[int]) -> None:
    """Exact where the receiver keeps time: the vehicle moves, and so tells the usual interval, before it stops."""
    whole, _ = in_pieces(drive.lines(), set(), "clockwise")
    pieces, _ = in_pieces(drive.lines(), cuts, "clockwise")
    if drive.jitter == 0:
        np.testing.assert_array_equal(np.vstack(pieces), whole[0])
    assert abs(np.vstack(pieces).shape[0] - whole[0].shape[0]) <= 2


@settings(max_examples=25, deadline=None)
@given(cuts=st.sets(st.integers(1, 11999), max_size=12))
def test_the_decision_on_the_sense_is_the_same_in_pieces(cuts: set[int]) -> None:
    lines = Drive(anticlockwise=True).lines()
    whole, _ = in_pieces(lines, set(), "auto")
    pieces, decided = in_pieces(lines, cuts, "auto")
    first = next(index for index, sense in enumerate(decided) if sense)
    assert set(decided[first:]) == {"anticlockwise"}
    later = np.vstack(pieces[first:])
    np.testing.assert_array_equal(later, whole[0][whole[0].shape[0] - later.shape[0] :])


def test_the_sense_and_the_interval_outlive_the_session() -> None:
    lines = Drive(anticlockwise=True).lines()
    context = read(text(lines)).samples().context
    parked = Drive(seconds=2, stop=(0, 100), anticlockwise=True).lines()
    reading = read(text(parked)).samples(context)
    assert reading.context["sense"] == "anticlockwise"
    np.testing.assert_allclose(np.diff(reading.samples.t[reading.samples.fix_row]), 0.25)


@pytest.mark.parametrize(
    ("place", "value", "column", "expected"),
    [
        (0, "x", "sample number", "a number"),
        (1, "", "OSTime", "a finite number"),
        (2, "181", "longitude", "degrees from -180 to 180"),
        (3, "91", "latitude", "degrees from -90 to 90"),
        (3, "", "latitude", "a number"),
        (4, "inf", "altitude", "a finite number or an empty cell"),
        (5, "-1", "speed", "km/h, not negative"),
        (6, "400", "course", "degrees from -360 to 360"),
        (7, "3", "fix", "1, 0 or an empty cell"),
        (10, "nan", "az", "a finite number"),
    ],
)
def test_a_bad_cell_is_named(place: int, value: str, column: str, expected: str) -> None:
    cells = LINE.split("\t")
    cells[place] = value
    with pytest.raises(FormatError) as caught:
        read(f"{LINE}\n{chr(9).join(cells)}\n")
    problem = caught.value.problems[0]
    assert (problem.line, problem.column, problem.expected) == (2, column, expected)


@pytest.mark.parametrize("line", ["1 2 3", LINE + "\t1", LINE.replace("\t1\t2", "\t1")])
def test_ragged(line: str) -> None:
    with pytest.raises(FormatError, match="line 2: expected 11 cells") as caught:
        read(f"{LINE}\n{line}\n")
    assert caught.value.status == 422


def test_a_sample_number_that_jumps_is_fine_but_too_many_rows_are_not() -> None:
    lines = [LINE, LINE.replace("1\t0\t", "1000000000\t5\t", 1)]
    assert len(samples(text(lines))) == 2
    with pytest.raises(FormatError) as caught:
        read(text(lines), max_rows=1)
    assert caught.value.status == 413


def test_time_running_backwards() -> None:
    with pytest.raises(FormatError, match="line 2, column OSTime: expected a time not before 0"):
        read(LINE + "\n" + LINE.replace("1\t0\t", "2\t-5\t", 1))


def test_an_unknown_sense_is_refused() -> None:
    with pytest.raises(FormatError, match="course='left'"):
        read(LINE, "left")


READ_ALL = """
from api.formats import parse
from api.formats.errors import FormatError
import sys
try:
    parse(sys.stdin.buffer.read(), "text/vnd.livella.tmd2", None).samples()
except FormatError:
    pass
"""
CLOCK_TOO_COARSE = f"1\t0\t7.64\t5.1\t24\t0\t9\t1\t1\t2\t100\n2\t1{'3' * 45}\t6\t1\t4\t1\t91\t1\t1\t2\t1"
INTERVAL_TOO_SHORT = "".join(
    f"{n}\t{n * 1e-4:.7f}\t7.{min(n, 5)}\t45\t240\t{40 if n < 5 else 1}\t90\t1\t1\t2\t100\n" for n in range(9)
)


@pytest.mark.parametrize("text", [CLOCK_TOO_COARSE, INTERVAL_TOO_SHORT])
def test_an_interval_the_clock_cannot_tell_comes_to_an_end(text: str) -> None:
    """In a process of its own, which can be ended when it does not end by itself."""
    ended = subprocess.run([sys.executable, "-c", READ_ALL], input=text.encode(), timeout=60, check=False)
    assert ended.returncode == 0
