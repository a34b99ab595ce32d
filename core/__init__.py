"""Mounting-angle estimation: arrays in, values out. No clock, no files, no database, no environment.

Frames (ISO 8855, right-handed)
    s  sensor frame: the axes printed on the device
    v  vehicle frame: x forward, y left, z up; at rest the specific force is (0, 0, +g)
    n  local level frame: x east, y north, z up

Names read as products whose letters cancel: `f_v = R_vs @ f_s`, `R_ns = R_nv @ R_vs`.

Symbols
    q_vs  mounting, scalar first [w, x, y, z], Hamilton, w >= 0: `f_v = R(q_vs) f_s` (thesis eq. 5.5)
    q_nv  attitude of the vehicle
    f_s   specific force, m/s2: a device lying flat reads +9.81 on its upward axis
    w_s   angular rate, rad/s
    sigma 1 sigma of the small rotation about vehicle x, y, z, rad

SI units and radians throughout; course is clockwise from true north, yaw rate positive to the left; time in seconds on
the device's monotonic clock within a session.

The door: `advance(params, state, samples) -> (state, outcome)`. Beside it `initial_state`, `begin_session` (the device
was switched off: the vehicle's attitude is unknown, the mounting kept), `restart` (the device was refitted on purpose),
`level_start` (the vehicle stands on level ground), `status`, and `encode`/`decode` (state <-> bytes). Readings of an
accelerometer whose errors are known go through `accelerometer.apply` first.
"""

from core import accelerometer, quaternion
from core.accelerometer import AccelerometerCalibration, CalibrationError
from core.estimator import advance, begin_session, initial_state, restart, status
from core.events import (
    Estimate,
    Estimates,
    Event,
    EventKind,
    Evidence,
    Fault,
    Mount,
    Needs,
    Outcome,
    Speeds,
    Stage,
    Status,
    Verification,
)
from core.level import NotStillError, level_start
from core.params import DEFAULT, PRESETS, THESIS, Parameters, Threshold, calibrated, threshold, thresholds
from core.samples import FIX_COLUMNS, SampleError, Samples
from core.snapshot import SnapshotError, decode, encode
from core.state import State

__all__ = [
    "DEFAULT",
    "FIX_COLUMNS",
    "PRESETS",
    "THESIS",
    "AccelerometerCalibration",
    "CalibrationError",
    "Estimate",
    "Estimates",
    "Event",
    "EventKind",
    "Evidence",
    "Fault",
    "Mount",
    "Needs",
    "NotStillError",
    "Outcome",
    "Parameters",
    "SampleError",
    "Samples",
    "SnapshotError",
    "Speeds",
    "Stage",
    "State",
    "Status",
    "Threshold",
    "Verification",
    "accelerometer",
    "advance",
    "begin_session",
    "calibrated",
    "decode",
    "encode",
    "initial_state",
    "level_start",
    "quaternion",
    "restart",
    "status",
    "threshold",
    "thresholds",
]
