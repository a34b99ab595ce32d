"""What happens to a vehicle, told in its own axes: impacts, harsh driving, potholes.

    state = initial_state()
    state, events = advance(DEFAULT, state, q_vs, samples)

Streaming: samples in any pieces give the same events as at once. Only an impact that goes on at the end of the samples
is told at once, with what is known, and not told again: a device that was crashed may send no more.
"""

from enum import StrEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from core import quaternion
from core.motion import _events_kernel
from core.motion.events_params import DEFAULT, EventParameters, as_record
from core.motion.events_state import LAYOUT, State, begin_session, decode, encode, initial_state
from core.samples import Samples
from core.state import independent

__all__ = [
    "DEFAULT",
    "SECONDS_AFTER",
    "SECONDS_BEFORE",
    "EventKind",
    "EventParameters",
    "MotionEvent",
    "State",
    "advance",
    "begin_session",
    "decode",
    "encode",
    "initial_state",
]

SECONDS_BEFORE, SECONDS_AFTER = 10.0, 10.0
"""s of readings about an impact that are worth keeping"""
ROWS = 64
"""places for events in a call of the kernel, which is called again when they are nearly full"""


class EventKind(StrEnum):
    """What happened."""

    IMPACT = "impact"
    HARSH_BRAKING = "harsh_braking"
    HARSH_ACCELERATION = "harsh_acceleration"
    HARSH_CORNERING = "harsh_cornering"
    POTHOLE = "pothole"


class MotionEvent(NamedTuple):
    """One event. SI units, radians, vehicle axes."""

    kind: EventKind
    t: float
    """s, of the peak, on the session's clock"""
    start: float
    """s"""
    duration: float
    """s"""
    peak: float
    """m/s2 on the plan, gravity taken out; of a pothole: along the vehicle's vertical"""
    direction: float
    """rad on the plan, where the push came from, anti-clockwise from forward: 0 the front, pi/2 the left; nan of
    a pothole"""
    velocity_change: tuple[float, float]
    """m/s forward and to the left, the integral of the acceleration from start to end"""
    speed: float
    """m/s over ground before it, nan = not known"""


_KINDS = tuple(EventKind)


def advance(
    params: EventParameters, state: State, q_vs: ArrayLike, samples: Samples
) -> tuple[State, tuple[MotionEvent, ...]]:
    """Go on with the next samples of a session.

    Parameters
    ----------
    params
        thresholds
    state
        from `initial_state`, `begin_session` or here; not changed
    q_vs
        (4,) confirmed mounting, f_v = R(q_vs) f_s
    samples
        of the device; gyroscope and fixes are used where there are any

    Returns
    -------
    State, tuple[MotionEvent, ...]
        the state after them, and the events that ended in them, in the order they ended
    """
    state, events, first = independent(state.tobytes(), LAYOUT), list[MotionEvent](), 0
    record, r_vs = as_record(params), np.ascontiguousarray(quaternion.matrix(quaternion.normalise(q_vs)))
    rows = np.empty((ROWS, _events_kernel.OUT))
    while first < len(samples):
        first, count = _events_kernel.run(
            record[0],
            state[0],
            r_vs,
            samples.t,
            samples.f_s,
            samples.w_s,
            samples.fix_row,
            samples.fix_valid,
            samples.fix,
            first,
            rows,
        )
        events += map(_event, rows[:count].tolist())
    return state, tuple(events)


def _event(row: list[float]) -> MotionEvent:
    kind, t, start, duration, peak, direction, forward, left, speed = row
    return MotionEvent(_KINDS[int(kind)], t, start, duration, peak, direction, (forward, left), speed)
