"""What the rules look at: a chunk, summed up."""

from collections.abc import Callable
from datetime import datetime
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

import core
from api.services import findings, presenting
from core.motion.events import MotionEvent
from storage.alerts import Finding

LONGEST_STEP = 10.0
"""s between two samples; a longer step is a hole, in which nothing was seen"""
FIX_HOLDS = 5.0
"""s for which a fix counts"""
MOVING = 1.0
"""m/s, slower is standing"""
SPEED = core.FIX_COLUMNS.index("speed")

Floats = NDArray[np.float64]


class Seen(NamedTuple):
    """A chunk of a session, after the estimator has taken it in."""

    session: str
    session_pk: int
    started_at: datetime | None
    """zero of the session's clock, UTC, as far as it is known"""
    received_at: datetime
    t_first: float
    """s, device clock"""
    t_last: float
    samples: int
    back: int
    """samples that are not newer than the chunk before"""
    repeated: int
    """samples with the time of the sample before"""
    span: float
    """s of data"""
    with_fix: float
    """s of it with a GPS fix"""
    driving: float
    """s of it in motion"""
    stage: core.Stage
    needs: tuple[str, ...]
    faults: tuple[core.Fault, ...]
    """faults of the sensor that go on"""
    events: tuple[core.Event, ...]
    happened: tuple[MotionEvent, ...] = ()
    """events of the vehicle's motion"""

    def moment(self, t: float) -> str | None:
        """Give a time of the session's clock as RFC 3339, if its zero is known."""
        return findings.text(None if self.started_at is None else presenting.utc(self.started_at, t))


class Over(NamedTuple):
    """The condition of an alert is over."""

    note: str


Verdict = Finding | Over | None
"""What a rule says after a chunk."""


class Rule(NamedTuple):
    """One rule: a pure step from memory to memory."""

    kind: str
    begin: Any
    """the memory of a rule that has seen nothing, a NamedTuple of JSON values"""
    step: Callable[[Any, Seen, Any], tuple[Any, Verdict]]
    """(memory, Seen, Limits) -> (memory, Verdict)"""
    of_mounting: bool
    """about this mounting: a deliberate refit ends it"""
    open: Any
    """the memory of a rule whose alert is open"""


def see(
    session: tuple[int, str, datetime | None],
    samples: core.Samples,
    outcome: core.Outcome,
    happened: tuple[MotionEvent, ...],
    received_at: datetime,
) -> Seen:
    """Sum up a chunk with at least one sample; `session` is its number, name and zero of the clock."""
    t, now = samples.t, outcome.status
    session_pk, name, started_at = session
    span = _span(t)
    with_fix = min(span, _covered(t[samples.fix_row[samples.fix_valid]], float(t[-1])))
    return Seen(
        name,
        session_pk,
        started_at,
        received_at,
        float(t[0]),
        float(t[-1]),
        len(samples),
        outcome.rejected.get("before_previous_sample", 0),
        outcome.rejected.get("duplicate_time", 0),
        span,
        with_fix,
        with_fix * _moving(samples.fix[samples.fix_valid, SPEED], now.needs),
        now.stage,
        now.needs.words,
        now.faults,
        outcome.events,
        happened,
    )


def finding(
    kind: str,
    seen: Seen,
    message: str,
    measured: tuple[float, float, str],
    since: str | None = None,
    reason: str | None = None,
    severity: str = "warning",
) -> Finding:
    """Give the alert of a rule; `measured` is what was seen, the threshold, and their unit."""
    value, threshold, unit = measured
    known = {
        "session": seen.session,
        "t": seen.t_last,
        "at": seen.moment(seen.t_last),
        "since": since,
        "reason": reason,
        "seen": round(value, 3),
        "threshold": threshold,
        "unit": unit,
    }
    return Finding(kind, severity, message, findings.data(known))


def _span(t: Floats) -> float:
    """Give the seconds of data, without holes."""
    if t.size < 2:
        return 0.0
    steps = t[1:] - t[:-1]
    if float(steps.max()) <= LONGEST_STEP:
        return float(t[-1] - t[0])
    return float(steps[steps <= LONGEST_STEP].sum())


def _covered(fixes: Floats, end: float) -> float:
    """Give the seconds for which one of the fixes at these times counts."""
    if not fixes.size:
        return 0.0
    between = np.minimum(fixes[1:] - fixes[:-1], FIX_HOLDS).sum()
    return float(between) + min(end - float(fixes[-1]), FIX_HOLDS)


def _moving(speed: Floats, needs: core.Needs) -> float:
    """Give the share of fixes in motion; of a receiver that gives no speed the estimator knows whether it moved."""
    known = speed[np.isfinite(speed)]
    if not known.size:
        return float(core.Needs.MOTION not in needs)
    return float(np.count_nonzero(known > MOVING)) / known.size
