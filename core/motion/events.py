"""What happens to a vehicle, told in its own axes: impacts, harsh driving, potholes.

    state = initial_state()
    state, events = advance(DEFAULT, state, q_vs, samples)

Streaming: samples in any pieces give the same events as at once.
"""

from enum import StrEnum
from typing import NamedTuple


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
