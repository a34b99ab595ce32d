"""The native columns, whether they come as CSV or as Arrow: their names, their rules, their way to SI and radians."""

from collections.abc import Sequence
from dataclasses import replace
from difflib import get_close_matches
from typing import Final, NamedTuple, Self

import numpy as np

from api.formats import _native_kernel, checks
from api.formats.checks import Fault, Locate, Rows
from api.formats.delimited import Columns, Floats, Table
from api.formats.errors import FormatError, Problem, printable
from api.formats.log import Context, Reading
from api.formats.reports import make_samples, without_fix

TIME = ("t", "t_ms")
ACCELERATION = ("ax", "ay", "az")
RATE = ("gx", "gy", "gz")
POSITION = ("lat", "lon")
VELOCITY = ("speed", "course")
GPS = ("lat", "lon", "alt", "speed", "course", "vz", "speed_acc", "course_acc")
"""in the order of `core.FIX_COLUMNS`"""
_PACKED = (*ACCELERATION, *RATE, "fix", *GPS)
"""after the time in the order of `_native_kernel`"""
FIELD = ("mx", "my", "mz")
OTHERS = ("steer", "temp", "pressure")
"""in the order of `core.Samples`"""
READ = (*TIME, *ACCELERATION, *RATE, "fix", *GPS, *FIELD, *OTHERS)

MAX_COLUMNS: Final = 100
MAX_NAME: Final = 60
UNITS: Final = {"t": 1.0, "t_ms": 1e-3}
"""s, of the columns that may tell the time"""
SLOW: Final = 1.0
"""m/s; below it a receiver may leave the course empty"""

_OTHER_NAMES = {
    "time": "t", "timestamp": "t", "seconds": "t", "time_ms": "t_ms", "ostime": "t_ms", "milliseconds": "t_ms",
    "latitude": "lat", "longitude": "lon", "lng": "lon", "altitude": "alt", "height": "alt", "elevation": "alt",
    "velocity": "speed", "sog": "speed", "heading": "course", "cog": "course", "bearing": "course", "gps_fix": "fix",
    "valid": "fix", "climb": "vz", "temperature": "temp", "steering": "steer", "baro": "pressure",
}  # fmt: skip


def check_names(names: Sequence[str], line: int | None) -> tuple[str, ...]:
    """Check the column names and give notices about the ignored ones.

    Raises
    ------
    FormatError
        422: too many or too long names, a name twice, a needed column missing, part of three axes or of a position
        missing.
    """
    if len(names) > MAX_COLUMNS or any(len(name) > MAX_NAME for name in names):
        expected = f"at most {MAX_COLUMNS} columns, their names no longer than {MAX_NAME} characters"
        raise FormatError.unreadable(Problem(line, None, expected, f"expected {expected}"))
    unknown = [name for name in names if name not in READ]
    problems = [
        *(Problem(line, printable(name), "each column once", "the column is there twice") for name in _twice(names)),
        *(Problem(line, name, f'a column "{name}"', _missing(name, unknown)) for name in _lacking(set(names))),
    ]
    if "t" in names and "t_ms" in names:
        problems.append(Problem(line, "t_ms", "either t or t_ms", 'expected either "t" or "t_ms", found both'))
    if problems:
        raise FormatError.unreadable(*problems)
    return tuple(f'column "{printable(name)}" is not known and was ignored{_hint(name)}' for name in unknown)


def _twice(names: Sequence[str]) -> list[str]:
    return sorted({name for name in names if names.count(name) > 1})


def _lacking(names: set[str]) -> list[str]:
    """Columns that are needed, or needed because of others that are there."""
    needed = [*(() if "t_ms" in names else ("t",)), *ACCELERATION, "fix"]
    needed += [name for group in (RATE, FIELD, POSITION) if names & set(group) for name in group]
    if not names & set(POSITION):
        needed += VELOCITY
    return [name for name in needed if name not in names]


def _missing(name: str, unknown: Sequence[str]) -> str:
    close = next((other for other in unknown if _known_name(other) == name), None)
    instead = f'; "{printable(close)}" stands there instead?' if close else ""
    return f'the column "{name}" is missing{instead}'


def _hint(name: str) -> str:
    known = _known_name(name)
    return f' (did you mean "{known}"?)' if known else ""


def _known_name(name: str) -> str | None:
    """Guess the known column that an unknown name stands for."""
    plain = name.strip().lower()
    axis = plain[-1:] if plain[-1:] in tuple("xyz") else ""
    for beginning, letter in (("acc", "a"), ("gyr", "g"), ("mag", "m")):
        if axis and plain.startswith(beginning):
            return letter + axis
    if plain in _OTHER_NAMES:
        return _OTHER_NAMES[plain]
    return next(iter(get_close_matches(plain, READ, 1, cutoff=0.65)), None)


class Packed(NamedTuple):
    """What is sound of a chunk and goes to the estimator, SI units and radians: N samples, M fixes."""

    t: Floats
    """(N,)"""
    f_s: Floats
    """(N, 3)"""
    w_s: Floats | None
    """(N, 3)"""
    fix_rows: Rows
    """(M,)"""
    none_rows: Rows
    """rows on which the receiver says that it has no fix"""
    fix: Floats
    """(M, 8)"""


def _time(names: Sequence[str]) -> str:
    return "t" if "t" in names else "t_ms"


def _pack(table: Table) -> Packed | None:
    """Give the columns as samples are made of them; None when any rule is broken."""
    n, has_rates, time = table.rows, "gx" in table.names, _time(table.names)
    place = [table.names.index(name) if name in table.names else -1 for name in (time, *_PACKED)]
    t, f_s = np.empty(n), np.empty((n, 3))
    w_s = np.empty((n, 3)) if has_rates else None
    fix_rows, none_rows, fix = np.empty(n, np.int64), np.empty(n, np.int64), np.empty((n, len(GPS)))
    fixes, nones = _native_kernel.pack(
        table.values, np.array(place), UNITS[time], SLOW, t, f_s, f_s if w_s is None else w_s, fix_rows, none_rows, fix
    )
    if fixes < 0:
        return None
    # copies: what was set aside for the rows that there might have been is given back
    return Packed(t, f_s, w_s, fix_rows[:fixes].copy(), none_rows[:nones].copy(), fix[:fixes].copy())


class NativeTable:
    """The columns of one chunk, checked, in SI units and radians."""

    def __init__(self, packed: Packed, others: Columns) -> None:
        self._packed = packed
        self._m_s = np.stack([others[name] for name in FIELD], axis=-1) if FIELD[0] in others else None
        self._others = [others.get(name) for name in OTHERS]

    @classmethod
    def of(cls, table: Table, locate: Locate) -> Self:
        """Check columns and convert them.

        Parameters
        ----------
        table
            the columns, in the units of the format
        locate
            gives the place of a cell in the log, for messages

        Raises
        ------
        FormatError
            422 with line, column and what was expected
        """
        packed = _pack(table)
        others = {name: table.columns[name] for name in (*FIELD, *OTHERS) if name in table.names}
        if packed is None or not _sound(others):
            checks.refuse(_faults(table.columns, _time(table.names)), locate)
            raise AssertionError("a sound chunk was found to be none")
        return cls(packed, others)

    def read(self, context: Context) -> Reading:
        """Give the samples; `context` keeps the time of the last fix."""
        t, f_s, w_s, fix_rows, none_rows, fix = self._packed
        samples = make_samples(t, f_s, w_s, fix_rows, fix, without_fix(t, fix_rows, none_rows, context))
        if self._m_s is not None or any(column is not None for column in self._others):
            steer, temperature, pressure = self._others
            samples = replace(samples, m_s=self._m_s, steer=steer, temperature=temperature, pressure=pressure)
        return Reading(samples, {}, context)


def _sound(others: Columns) -> bool:
    """Tell whether the columns that the estimator does not use keep their rules."""
    return not any(np.isinf(column).any() for column in others.values()) and not _incomplete_rows(others, FIELD)


def _faults(columns: Columns, time: str) -> list[Fault]:
    rows = np.flatnonzero(columns["fix"] == 1)
    fix = {name: columns[name][rows] if name in columns else np.full(rows.size, np.nan) for name in GPS}
    return [
        *checks.finite(columns, time, *ACCELERATION),
        *checks.in_order(columns, time),
        *checks.finite_or_empty(columns, *RATE, *GPS, *FIELD, *OTHERS),
        *checks.flag(columns, "fix"),
        *_incomplete_rows(columns, RATE),
        *_incomplete_rows(columns, FIELD),
        *_out_of_range(fix, rows),
        *_incomplete_fixes(fix, rows),
    ]


def _incomplete_rows(columns: Columns, axes: tuple[str, str, str]) -> list[Fault]:
    """Find rows that give some but not all axes of the gyroscope or the magnetometer."""
    if axes[0] not in columns:
        return []
    empty = np.isnan([columns[name] for name in axes])
    partly = empty.any(axis=0) & ~empty.all(axis=0)
    expected = f"{axes[0]}, {axes[1]} and {axes[2]} all filled or all empty"
    return [fault for i, name in enumerate(axes) for fault in checks.first(partly & empty[i], name, expected)]


def _out_of_range(fix: Columns, rows: Rows) -> list[Fault]:
    return [
        *checks.within(fix["lat"], -90, 90, "lat", "degrees from -90 to 90", rows),
        *checks.within(fix["lon"], -180, 180, "lon", "degrees from -180 to 180", rows),
        *checks.within(fix["course"], 0, 360, "course", "degrees from 0 to 360", rows),
        *checks.within(fix["speed"], 0, np.inf, "speed", "m/s, not negative", rows),
        *checks.within(fix["speed_acc"], 0, np.inf, "speed_acc", "m/s, not negative", rows),
        *checks.within(fix["course_acc"], 0, np.inf, "course_acc", "degrees, not negative", rows),
    ]


def _incomplete_fixes(fix: Columns, rows: Rows) -> list[Fault]:
    """Find fixes that give neither a position nor a velocity, or half a position."""
    no_lat, no_lon, no_speed, no_course = (np.isnan(fix[name]) for name in (*POSITION, *VELOCITY))
    no_course &= ~(fix["speed"] < SLOW)
    needed = " on a row with fix = 1 that gives no position"
    return [
        *checks.first(no_lat & ~no_lon, "lat", "a latitude beside the longitude", rows),
        *checks.first(no_lon & ~no_lat, "lon", "a longitude beside the latitude", rows),
        *checks.first(no_lat & no_lon & no_speed, "speed", f"a speed{needed}", rows),
        *checks.first(no_lat & no_lon & no_course, "course", f"a course{needed}", rows),
    ]
