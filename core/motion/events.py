"""What happens to a vehicle, told in its own axes: impacts, harsh driving, potholes.

    state = initial_state()
    state, events = advance(DEFAULT, state, q_vs, samples)

Streaming: samples in any pieces give the same events as at once. Only an impact that goes on at the end of the samples
is told at once, with what is known, and not told again: a device that was crashed may send no more.
"""

import hashlib
import math
import struct
import sys
from dataclasses import dataclass, fields
from enum import StrEnum
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core import quaternion
from core.motion import _events_kernel
from core.params import DEGREE, threshold
from core.samples import Samples
from core.snapshot import SnapshotError
from core.state import independent

State = NDArray[np.void]
"""State of one device's events: a structured array of shape (1,), `LAYOUT`; a value, never changed."""

SECONDS_BEFORE, SECONDS_AFTER = 10.0, 10.0
"""s of readings about an impact that are worth keeping"""
ROWS = 64
"""events the kernel tells before it has to be called again"""
MAGIC = b"LVLE"
VERSION = 1
_HEADER = struct.Struct("<4sH8s")


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


@dataclass(frozen=True)
class EventParameters:
    """What events are told by. Accelerations without gravity, the road's slope and the accelerometer's bias."""

    harsh_braking: float = threshold(3.5, "m/s2", "Harsh braking: the smoothed deceleration exceeds it.")
    harsh_acceleration: float = threshold(3.0, "m/s2", "Harsh acceleration: the smoothed acceleration exceeds it.")
    harsh_cornering: float = threshold(4.0, "m/s2", "Harsh cornering: the smoothed lateral acceleration exceeds it.")
    harsh_least: float = threshold(0.4, "s", "A harsh manoeuvre lasts at least so long.")
    harsh_end_share: float = threshold(0.75, "", "It ends below this share of its threshold.")
    harsh_smoothing: float = threshold(0.1, "s", "Time constant of each of the two low-passes before harsh driving.")
    harsh_settling: float = threshold(5.0, "s", "No harsh manoeuvre begins so soon after the first sample.")
    harsh_clip: float = 12.0
    """m/s2; more is no driving and is cut off before the low-passes"""
    moving_speed: float = threshold(1.5, "m/s", "Slower vehicles neither drive harshly nor meet potholes.")
    impact_rate: float = threshold(45.0, "Hz", "Impacts and potholes are told from this sampling rate on.")
    impact_peak: float = threshold(
        23.0, "m/s2", "Impact: the acceleration on the plan, over that before it, reaches it."
    )
    impact_level: float = threshold(
        12.0, "m/s2", "Impact: what tyres cannot do, both in all and over the acceleration before."
    )
    impact_velocity: float = threshold(0.55, "m/s", "Impact: change of the velocity while above that level.")
    impact_one_way: float = threshold(
        0.6, "", "Impact: change of the velocity over the integral of the acceleration's size; shaking has little."
    )
    impact_back: float = threshold(
        0.3, "", "Impact: largest acceleration back that tyres cannot do, over the peak; doors swing back."
    )
    impact_back_time: float = threshold(0.08, "s", "It is looked for so long after the pulse.")
    impact_sure: float = threshold(60.0, "m/s2", "It is not looked for after pulses larger than any door makes.")
    impact_shortest: float = threshold(
        0.012, "s", "Impact: that change over the peak; knocks at the device are shorter."
    )
    impact_up: float = threshold(1.2, "", "Impact: largest vertical acceleration over the peak on the plan.")
    impact_up_velocity: float = threshold(0.8, "", "Impact: change of the velocity, vertical over on the plan.")
    impact_wait: float = threshold(2.0, "s", "After the pulse the device must have stayed in its place for so long.")
    impact_refractory: float = threshold(1.0, "s", "The next impact is told this much later.")
    pulse_level: float = threshold(6.0, "m/s2", "A pulse begins above, over the acceleration just before it.")
    pulse_end_share: float = threshold(0.4, "", "A pulse ends below this share of its peak, or `impact_level`.")
    pulse_pause: float = threshold(0.025, "s", "A pulse has ended when it has been lower for so long.")
    pulse_longest: float = threshold(0.2, "s", "A pulse is not followed longer than this after its peak.")
    base_time: float = threshold(0.12, "s", "Time constant of the average a pulse stands out from.")
    base_clip: float = 15.0
    """m/s2; what stands out further counts as this much in the averages"""
    handled_tilt: float = threshold(15 * DEGREE, "rad", "The device is handled: it turns so far out of the level.")
    tilt_time: float = threshold(2.0, "s", "Time constant over which the turn is seen.")
    rest_time: float = threshold(0.5, "s", "Time constant of the two averages that follow.")
    handled_up: float = threshold(3.5, "m/s2", "The device is handled: the average vertical is so far from gravity.")
    handled_plan: float = threshold(12.0, "m/s2", "The device is handled: the average on the plan is so large.")
    handled_time: float = threshold(5.0, "s", "Nothing is told so long after the device was handled.")
    pothole: float = threshold(9.0, "m/s2", "Pothole: the vertical acceleration in the band exceeds it.")
    pothole_ratio: float = threshold(5.0, "", "Pothole: it exceeds the road's standard deviation so many times.")
    pothole_low: float = threshold(5.0, "Hz", "Band of the vertical acceleration, from.")
    pothole_high: float = threshold(40.0, "Hz", "Band of the vertical acceleration, to.")
    pothole_refractory: float = threshold(0.3, "s", "A jolt ends when it has been quiet for so long.")
    pothole_longest: float = threshold(2.0, "s", "A jolt is not followed longer.")
    road_time: float = threshold(10.0, "s", "Time constant over which the road's standard deviation is learnt.")
    offset_time: float = 8.0
    """s, time constant of gravity, slope and bias on the plan: what the acceleration of the fixes does not explain"""
    offset_time_without_fixes: float = 30.0
    """s, the same where no fixes tell the acceleration"""
    offset_clip: float = 2.0
    """m/s2; what departs further counts as this much"""
    max_fix_age: float = 2.6
    """s; an older fix tells nothing of the speed"""
    course_speed: float = 3.0
    """m/s; slower courses tell no lateral acceleration"""
    max_gap: float = 1.0
    """s; after a longer gap between samples all that was going on has ended"""
    pitch_per_acceleration: float = 0.5 * DEGREE
    """rad per m/s2, usual squat and dive, by which slow accelerations read too large"""
    roll_per_acceleration: float = 0.4 * DEGREE
    """rad per m/s2, usual lean in curves"""


DEFAULT = EventParameters()

LAYOUT = np.dtype(
    [
        ("t", "f8"),  # s, of the last sample, nan = none
        ("session_start", "f8"),  # s, or the end of the last gap
        ("step", "f8"),  # s between samples, that the filters' shares belong to
        ("interval", "f8"),  # s, mean of late between samples
        ("offset", "f8", (2,)),  # m/s2 on the plan: gravity on slopes, bias
        ("fix_t", "f8"),  # s, last fix with a speed
        ("fix_speed", "f8"),
        ("fix_course", "f8"),
        ("reference", "f8", (2,)),  # m/s2 forward and left between the last two fixes
        ("reference_end", "f8"),  # s, trusted until
        ("base", "f8", (3,)),  # m/s2 just now: what a pulse stands out from
        ("rest", "f8", (3,)),  # m/s2, of the last half second: is the device upright?
        ("tilt", "f8", (2,)),  # rad about forward and left, of late
        ("handled", "f8"),  # s, nothing is told until
        ("phase", "i8"),  # of a pulse: idle, going on, just after
        ("told", "i8"),
        ("pulse_start", "f8"),
        ("pulse_end", "f8"),  # s, last time it was large
        ("peak_t", "f8"),
        ("pulse_speed", "f8"),  # m/s over ground before it
        ("peak", "f8"),  # m/s2 on the plan
        ("excess", "f8"),  # m/s2, the same over the base
        ("up", "f8"),  # m/s2, largest vertical
        ("change", "f8", (2,)),  # m/s, integral of the acceleration
        ("push", "f8", (2,)),  # m/s, integral over the base where it is more than tyres can do
        ("change_up", "f8"),  # m/s
        ("back", "f8"),  # m/s2, largest against the push
        ("path", "f8"),  # m/s, integral of its size
        ("costs", "f8", (_events_kernel.COURSES,)),  # m2/s3, of directions of the push
        ("range_end", "f8"),  # m/s2, end of the accelerometer's range, 0 = not seen
        ("clipped", "f8"),  # s at the end of the range
        ("before", "f8", (3,)),  # m/s2, last reading, sensor axes
        ("before_excess", "f8", (3,)),  # m/s2, the same over the base
        ("before_flat", "i8", (3,)),  # at the end of the range
        ("before_dt", "f8"),  # s
        ("active", "i8", (3,)),  # scratch
        ("quiet_end", "f8"),  # s, no impact begins before
        ("smooth", "f8", (4,)),  # m/s2, of the two low-passes
        ("harsh_on", "i8", (3,)),  # braking, acceleration, cornering
        ("harsh_start", "f8", (3,)),
        ("harsh_peak", "f8", (3,)),
        ("harsh_peak_t", "f8", (3,)),
        ("harsh_direction", "f8", (3,)),
        ("harsh_change", "f8", (3, 2)),
        ("harsh_speed", "f8", (3,)),
        ("low", "f8"),  # m/s2, vertical below the band
        ("high", "f8"),  # m/s2, vertical in the band
        ("variance", "f8"),  # m2/s4, of `high`
        ("pothole_on", "i8"),
        ("pothole_start", "f8"),
        ("pothole_end", "f8"),
        ("pothole_t", "f8"),
        ("pothole_peak", "f8"),
        ("pothole_speed", "f8"),
    ]
)
_FINGERPRINT = hashlib.sha256(str(LAYOUT.descr).encode()).digest()[:8]
_KINDS = tuple(EventKind)


def initial_state() -> State:
    """Give the state of a device nothing is known of."""
    state = np.zeros(1, LAYOUT)
    for name in ("t", "fix_t", "fix_speed", "fix_course"):
        state[name] = math.nan
    for name in ("handled", "quiet_end", "pothole_end", "reference_end"):
        state[name] = -math.inf
    state["step"] = state["interval"] = 0.01
    return state


def begin_session(state: State) -> State:
    """Give the state after the device was switched off: its clock starts anew; what was going on is forgotten.

    Only the offset, mostly bias, and the roughness of the roads are kept.
    """
    fresh = initial_state()
    for name in ("offset", "variance"):
        fresh[name] = state[name]
    return fresh


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
    record, r_vs = _as_record(params), np.ascontiguousarray(quaternion.matrix(quaternion.normalise(q_vs)))
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


def encode(state: State) -> bytes:
    """Give the state as bytes (less than 1 kB)."""
    return _HEADER.pack(MAGIC, VERSION, _FINGERPRINT) + state.tobytes()


def decode(data: bytes) -> State:
    """Give the state of `encode`.

    Raises
    ------
    SnapshotError
        not such bytes, or made by another version
    """
    if sys.byteorder != "little":
        raise SnapshotError("snapshots are little-endian")
    if len(data) < _HEADER.size or data[:4] != MAGIC:
        raise SnapshotError("not a snapshot of events")
    _, version, fingerprint = _HEADER.unpack_from(data)
    if version != VERSION or fingerprint != _FINGERPRINT:
        raise SnapshotError(f"snapshot of format version {version} cannot be read by version {VERSION}")
    if len(data) != _HEADER.size + LAYOUT.itemsize:
        raise SnapshotError(f"snapshot has {len(data)} bytes, expected {_HEADER.size + LAYOUT.itemsize}")
    return independent(data[_HEADER.size :], LAYOUT)


def _event(row: list[float]) -> MotionEvent:
    kind, t, start, duration, peak, direction, forward, left, speed = row
    return MotionEvent(_KINDS[int(kind)], t, start, duration, peak, direction, (forward, left), speed)


@lru_cache(maxsize=32)
def _as_record(params: EventParameters) -> NDArray[np.void]:
    """Give the parameters as a structured array of shape (1,) for the kernel."""
    names = [item.name for item in fields(params)]
    record = np.zeros(1, np.dtype([(name, "f8") for name in names]))
    for name in names:
        record[name] = getattr(params, name)
    return record
