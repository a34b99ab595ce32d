"""What evolves while events are told, and how it is kept as bytes."""

import hashlib
import math
import struct
import sys

import numpy as np
from numpy.typing import NDArray

from core.motion import _events_kernel
from core.snapshot import SnapshotError
from core.state import independent

State = NDArray[np.void]
"""State of one device's events: a structured array of shape (1,), `LAYOUT`; a value, never changed."""


MAGIC = b"LVLE"
VERSION = 1
_HEADER = struct.Struct("<4sH8s")

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
