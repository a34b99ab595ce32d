"""The thesis' log, `text/vnd.livella.tmd2` (thesis 5.1): no header, eleven cells a line, GPS cells repeated.

Sample number, OSTime (ms), longitude, latitude, altitude (m), speed over ground (km/h), course (deg), fix (1/0), and
the three accelerations in per cent of g. Cells are separated by tabs, semicolons, commas or blanks.
"""

from functools import partial
from typing import Final

import numpy as np
from numpy.typing import NDArray

from api.formats import checks, course_sense
from api.formats.checks import Fault, Locate, Rows
from api.formats.compression import Limits
from api.formats.course_sense import Sense
from api.formats.delimited import Columns, DelimitedText, Floats, lines, text_content
from api.formats.fingerprint import Fingerprint
from api.formats.log import Context, ParsedLog, Reading
from api.formats.reports import make_samples, without_fix
from core import FIX_COLUMNS

MEDIA_TYPE = "text/vnd.livella.tmd2"

SAMPLE, TIME, LON, LAT, ALT, SPEED, COURSE, FIX = (
    "sample number", "OSTime", "longitude", "latitude", "altitude", "speed", "course", "fix",
)  # fmt: skip
ACCELERATION = ("ax", "ay", "az")
COLUMNS = (SAMPLE, TIME, LON, LAT, ALT, SPEED, COURSE, FIX, *ACCELERATION)
GPS = (LON, LAT, ALT, SPEED, COURSE)

PER_CENT_OF_G: Final = 9.80665 / 100
KMH: Final = 1 / 3.6
PARKED: Final = 1.0
"""m/s; only below it may a receiver report the same cells again"""
UNKNOWN_INTERVAL: Final = 1.0
"""s between the reports of a receiver of which no two have been seen yet"""
INTERVALS: Final = 15
"""intervals, seen while driving, whose median is the receiver's usual one"""


def parse(content: bytes, limits: Limits, fingerprint: Fingerprint, course: Sense) -> ParsedLog:
    """Read a thesis log.

    Raises
    ------
    FormatError
        413, or 422 with line, column and what was expected.
    """
    content = text_content(content, limits)
    delimiter = _delimiter(next(line for line in lines(content) if line.strip()))
    if delimiter == " ":
        content, delimiter = b"\n".join(b",".join(line.split()) for line in lines(content)), ","
    text = DelimitedText(content, COLUMNS, delimiter, header_lines=0)
    columns = text.read(COLUMNS).columns
    checks.refuse_rows(columns[TIME].size, limits)
    table = ThesisTable(columns, text.cell)
    return ParsedLog(MEDIA_TYPE, fingerprint, (), table.rows, partial(table.read, course))


def _delimiter(line: bytes) -> str:
    return next((mark for mark in "\t;," if mark.encode() in line.strip()), " ")


class ThesisTable:
    """The columns of one chunk, checked."""

    def __init__(self, columns: Columns, locate: Locate) -> None:
        """Check the columns (N,) each, in the log's units, NaN for an empty cell.

        Raises
        ------
        FormatError
            422 with line, column and what was expected
        """
        checks.refuse(_faults(columns), locate)
        self.rows = columns[TIME].size
        self._t = columns[TIME] * 1e-3
        self._f_s = np.column_stack([columns[name] for name in ACCELERATION]) * PER_CENT_OF_G
        self._gps = np.column_stack([columns[name] for name in GPS])
        self._has_fix = (columns[FIX] == 1) & ~np.isnan(self._gps[:, [0, 1, 3, 4]]).any(axis=1)
        self._none_rows = np.flatnonzero(columns[FIX] == 0)

    def read(self, course: Sense, context: Context) -> Reading:
        """Give the samples; `context` keeps the last GPS cells, their time, the usual interval and the course sense."""
        if self._t[0] < context.get("row_t", self._t[0]):
            _forget_session(context)
        fix_rows, late = self._new_fixes(context)
        none_rows = without_fix(self._t, fix_rows, self._none_rows, context)
        samples = make_samples(
            self._t, self._f_s, None, fix_rows, self._fix_table(fix_rows, course, context), none_rows
        )
        context["row_t"] = float(self._t[-1])
        context["cells"] = _json(self._gps[-1]) if self._has_fix[-1] else None
        return Reading(samples, {"fix_repeated": late} if late else {}, context)

    def _new_fixes(self, context: Context) -> tuple[Rows, int]:
        """Find the rows on which a fix arrives, and count the changes that came just after they were given up."""
        changed = np.flatnonzero(self._changed(context.get("cells")))
        interval = self._usual_interval(changed, context)
        ends = np.append(changed, self.rows)
        chosen, late = self._repeats(0, int(ends[0]), interval, context), 0
        for row, end in zip(changed.tolist(), ends[1:].tolist(), strict=True):
            if context.get("repeated") and self._t[row] - context["report_t"] < interval / 4:
                late += 1  # the report we had already taken for a repeated one, a row later than usual
            else:
                chosen.append(row)
                context["report_t"], context["repeated"] = float(self._t[row]), False
            chosen += self._repeats(row + 1, end, interval, context)
        return np.array(chosen, np.int64), late

    def _changed(self, last: list[float | None] | None) -> NDArray[np.bool_]:
        """Tell the rows with a fix whose GPS cells are not those of the row before."""
        before = np.vstack([np.array(last or [None] * len(GPS), np.float64), self._gps[:-1]])
        had_fix = np.append(last is not None, self._has_fix[:-1])
        same = ((self._gps == before) | (np.isnan(self._gps) & np.isnan(before))).all(axis=1)
        changed: NDArray[np.bool_] = self._has_fix & ~(had_fix & same)
        return changed

    def _usual_interval(self, changed: Rows, context: Context) -> float:
        """Give the receiver's usual interval, s, from the first reports of a moving vehicle."""
        seen: list[float] = context.get("intervals", [])
        if len(seen) < INTERVALS:
            moving = np.append(context.get("changed_moving", False), self._speed(changed) >= PARKED)
            times = np.append(context.get("changed_t", np.nan), self._t[changed])
            gaps = np.diff(times)[moving[:-1] & moving[1:]]
            seen = (seen + gaps[gaps > 0].tolist())[:INTERVALS]
            context["intervals"] = seen
            if changed.size:
                context["changed_moving"], context["changed_t"] = bool(moving[-1]), float(times[-1])
        return float(np.median(seen)) if seen else UNKNOWN_INTERVAL

    def _repeats(self, row: int, end: int, interval: float, context: Context) -> list[int]:
        """Find the rows in [row, end) at which a parked vehicle's receiver reports the same cells again."""
        chosen: list[int] = []
        if (
            end <= row
            or "report_t" not in context
            or not self._has_fix[row]
            or self._speed(np.array([row]))[0] >= PARKED
        ):
            return chosen
        t, index = self._t[row:end], 0
        while (index := max(index, self._due(t, interval, context))) < t.size and self._has_fix[row + index]:
            chosen.append(row + index)
            context["report_t"], context["repeated"] = float(t[index]), True
            index += 1  # also where an interval is less than the clock's resolution
        return chosen

    @staticmethod
    def _due(t: Floats, interval: float, context: Context) -> int:
        return int(np.searchsorted(t, context["report_t"] + interval - 1e-6))

    def _speed(self, rows: Rows) -> Floats:
        speed: Floats = self._gps[rows, GPS.index(SPEED)] * KMH
        return speed

    def _fix_table(self, rows: Rows, course: Sense, context: Context) -> Floats:
        """Give the fixes (M, 8), SI and radians, as in `core.FIX_COLUMNS`."""
        longitude, latitude, altitude, _, course_angle = self._gps[rows].T
        speed = self._speed(rows)
        if course is Sense.AUTO:
            course = course_sense.decide(latitude, longitude, speed, course_angle, context)
        clockwise = course_angle if course is Sense.CLOCKWISE else -course_angle
        fix = np.full((rows.size, len(FIX_COLUMNS)), np.nan)
        fix[:, :5] = np.column_stack(
            [np.radians(latitude), np.radians(longitude), altitude, speed, np.radians(clockwise) % (2 * np.pi)]
        )
        return fix


def _json(cells: Floats) -> list[float | None]:
    return [None if np.isnan(cell) else cell for cell in cells.tolist()]


def _forget_session(context: Context) -> None:
    """Forget what belongs to the session before: the clock started anew."""
    for key in ("cells", "report_t", "repeated", "changed_t", "changed_moving", "leg", "fix_t", "none_t"):
        context.pop(key, None)


def _faults(columns: Columns) -> list[Fault]:
    rows = np.flatnonzero(columns[FIX] == 1)
    fix = {name: columns[name][rows] for name in GPS}
    between = np.isnan([fix[name] for name in GPS]).all(axis=0)
    needed = (LON, LAT, SPEED, COURSE)
    missing = [
        fault for name in needed for fault in checks.first(np.isnan(fix[name]) & ~between, name, "a number", rows)
    ]
    return [
        *checks.finite(columns, SAMPLE, TIME, *ACCELERATION),
        *checks.in_order(columns, TIME),
        *checks.finite_or_empty(columns, *GPS),
        *checks.flag(columns, FIX),
        *missing,
        *checks.within(fix[LAT], -90, 90, LAT, "degrees from -90 to 90", rows),
        *checks.within(fix[LON], -180, 180, LON, "degrees from -180 to 180", rows),
        *checks.within(fix[SPEED], 0, np.inf, SPEED, "km/h, not negative", rows),
        *checks.within(fix[COURSE], -360, 360, COURSE, "degrees from -360 to 360", rows),
    ]
