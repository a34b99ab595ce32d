"""Columns of numbers -> samples, compiled: every rule that a sound chunk keeps, looked at in one pass.

This file imports nothing of the project, so that numba's cache, which watches a single file, can never be stale.
"""

import math
from typing import Any

import numpy as np
from numba import njit

OPTIONS: Any = {"cache": True, "nogil": True, "_nrt": False}
"""The last: who holds the arrays is not counted, which would take a fifth of the time; no array is made here."""

TIME, AX, AY, AZ, GX, GY, GZ, FIX, LATITUDE, LONGITUDE, ALTITUDE, SPEED, COURSE, CLIMB, SPEED_ERROR, COURSE_ERROR = (
    range(16)
)
"""Places of `pack`; those of a fix are in the order of `core.FIX_COLUMNS`."""
RADIANS = math.pi / 180.0


@njit(**OPTIONS)
def pack(values, place, unit, slow, t, f_s, w_s, fix_rows, none_rows, fix):
    """Put columns into the arrays that samples are made of.

    Parameters
    ----------
    values
        (columns, N) as they were sent, NaN for an empty cell
    place
        (16,) row of `values` for each of the columns named above, -1 where it was not sent
    unit
        s, in which time was sent
    slow
        m/s, speed below which the course may be missing
    t, f_s, w_s
        (N,), (N, 3), (N, 3) take time and readings; `w_s` is left alone when no rates were sent
    fix_rows, none_rows
        (N,) take the rows with a fix, and those that say there is none
    fix
        (N, 8) takes the fixes, SI units and radians

    Returns
    -------
    fixes, rows without a fix
        -1, 0 when any rule is broken; what the arrays hold then means nothing.
    """
    count, fixes, nones = values.shape[1], 0, 0
    if not gps_finite(values, place):
        return -1, 0
    before = -np.inf
    for i in range(count):
        now = values[place[TIME], i]
        x, y, z = values[place[AX], i], values[place[AY], i], values[place[AZ], i]
        if not (now >= before and math.isfinite(now) and math.isfinite(x) and math.isfinite(y) and math.isfinite(z)):
            return -1, 0
        before = now
        t[i] = now * unit
        f_s[i, 0], f_s[i, 1], f_s[i, 2] = x, y, z
    if place[GX] >= 0 and not pack_rates(values, place, w_s):
        return -1, 0
    for i in range(count):
        said = values[place[FIX], i]
        if said == 1.0:
            if not pack_fix(values, place, slow, i, fix[fixes]):
                return -1, 0
            fix_rows[fixes] = i
            fixes += 1
        elif said == 0.0:
            none_rows[nones] = i
            nones += 1
        elif not math.isnan(said):
            return -1, 0
    return fixes, nones


@njit(**OPTIONS)
def gps_finite(values, place):
    """Tell whether no cell of the receiver's columns is infinite, on any row."""
    infinite = 0
    for column in range(LATITUDE, COURSE_ERROR + 1):
        if place[column] >= 0:
            for value in values[place[column]]:
                infinite += abs(value) == np.inf
    return infinite == 0


@njit(**OPTIONS)
def pack_rates(values, place, w_s):
    """Put the rates side by side; tell whether each row has all three, finite, or none."""
    for i in range(w_s.shape[0]):
        x, y, z = values[place[GX], i], values[place[GY], i], values[place[GZ], i]
        finite = math.isfinite(x) and math.isfinite(y) and math.isfinite(z)
        if not (finite or (math.isnan(x) and math.isnan(y) and math.isnan(z))):
            return False
        w_s[i, 0], w_s[i, 1], w_s[i, 2] = x, y, z
    return True


@njit(**OPTIONS)
def pack_fix(values, place, slow, i, fix):
    """Put a fix into its row; tell whether it is complete and within the ranges."""
    for k in range(fix.size):
        column = place[LATITUDE + k]
        fix[k] = values[column, i] if column >= 0 else np.nan
    return take_fix(slow, fix)


@njit(**OPTIONS)
def take_fixes(slow, fixes):
    """Turn the degrees of fixes (M, 8) into radians; tell whether all are complete and within the ranges."""
    sound = True
    for i in range(fixes.shape[0]):
        sound &= take_fix(slow, fixes[i])
    return sound


@njit(**OPTIONS)
def take_fix(slow, fix):
    """Turn the degrees of a fix (8,) into radians; tell whether it is complete and within the ranges."""
    latitude, longitude, _, speed, course, _, speed_error, course_error = fix
    if (
        abs(latitude) > 90.0
        or abs(longitude) > 180.0
        or course < 0.0
        or course > 360.0
        or speed < 0.0
        or speed_error < 0.0
        or course_error < 0.0
        or math.isnan(latitude) != math.isnan(longitude)
    ):
        return False
    if math.isnan(latitude) and (math.isnan(speed) or (math.isnan(course) and not speed < slow)):
        return False
    fix[0] = latitude * RADIANS
    fix[1] = longitude * RADIANS
    fix[4] = course * RADIANS % (2.0 * math.pi)
    fix[7] = course_error * RADIANS
    return True
