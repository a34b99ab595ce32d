"""Which rows that say "no fix" are reports of the receiver.

Many logs fill the rows between two fixes with zeros. Such a zero says nothing; one that comes when no fix has arrived
for a while says that the receiver has none.
"""

import numpy as np
from numpy.typing import NDArray

from api.formats.log import Context
from core import Samples
from core.samples import no_rates

Rows = NDArray[np.int64]
Floats = NDArray[np.float64]

SILENCE = 5.0
"""s without a fix before "no fix" is believed: longer than the period of any receiver in use"""
REPEAT = 1.0
"""s between two reports that there is no fix"""


def without_fix(t: Floats, fix_rows: Rows, none_rows: Rows, context: Context) -> Rows:
    """Choose from the rows that say "no fix" those that are reports, and keep the times in `context`."""
    if t[0] < max(context.get("fix_t", t[0]), context.get("none_t", t[0])):
        context.pop("fix_t", None)  # the clock started anew: another session
        context.pop("none_t", None)
    candidates = none_rows[t[none_rows] - _last_fix(t, fix_rows, none_rows, context) > SILENCE]
    chosen = _thin(t, candidates, context.get("none_t", -np.inf) + REPEAT)
    if fix_rows.size:
        context["fix_t"] = float(t[fix_rows[-1]])
    if chosen.size:
        context["none_t"] = float(t[chosen[-1]])
    return chosen


def _last_fix(t: Floats, fix_rows: Rows, none_rows: Rows, context: Context) -> Floats:
    """Time of the last fix before each row that says "no fix"; -inf before the first of the session."""
    times = np.concatenate([[context.get("fix_t", -np.inf)], t[fix_rows]])
    return times[np.searchsorted(fix_rows, none_rows)]


def _thin(t: Floats, rows: Rows, due: float) -> Rows:
    """Keep the rows that are at least `REPEAT` apart."""
    times = t[rows]
    chosen: list[int] = []
    index = int(np.searchsorted(times, due))
    while index < rows.size:
        chosen.append(index)
        index = max(index + 1, int(np.searchsorted(times, times[index] + REPEAT)))
    return rows[chosen]


def make_samples(t: Floats, f_s: Floats, w_s: Floats | None, fix_rows: Rows, fix: Floats, none_rows: Rows) -> Samples:
    """Put fixes and reports without a fix into one table in the order of their rows; all are known to be sound."""
    w_s = no_rates(t.size) if w_s is None else w_s
    if not none_rows.size:
        return Samples(t, f_s, w_s, fix_rows, np.ones(fix_rows.size, np.bool_), fix)
    rows = np.concatenate([fix_rows, none_rows])
    order = np.argsort(rows, kind="stable")
    valid = np.arange(rows.size) < fix_rows.size
    table = np.concatenate([fix, np.full((none_rows.size, fix.shape[1]), np.nan)])
    return Samples(t, f_s, w_s, rows[order], valid[order], table[order])
