"""What the estimator may report: estimates in time order, events, and where it stands now."""

from enum import IntEnum, IntFlag, StrEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class Stage(IntEnum):
    """Stage of an installation, in the order of a good drive."""

    WAITING = 0
    """no usable data yet"""
    ALIGNING = 1
    """coarse alignment"""
    SETTLING = 2
    """filter running"""
    VERIFYING = 3
    """candidate on the drive test"""
    CONFIRMED = 4
    """mounting confirmed"""

    @property
    def word(self) -> str:
        """Name used in files and in the API."""
        return self.name.lower()


class Needs(IntFlag):
    """What is missing now."""

    DATA = 1
    GPS_FIX = 2
    MOTION = 4
    TURN = 8
    ACCELERATE_OR_BRAKE = 16
    TIME = 32

    @property
    def words(self) -> tuple[str, ...]:
        """Names used in files and in the API."""
        return tuple(str(need.name).lower() for need in Needs if need in self)


class EventKind(StrEnum):
    """Kinds of events."""

    VERIFICATION_STARTED = "verification_started"
    VERIFICATION_PASSED = "verification_passed"
    VERIFICATION_FAILED = "verification_failed"
    CONFIRMED = "confirmed"
    ORIENTATION_CHANGED = "orientation_changed"
    FAULT = "fault"


class Fault(StrEnum):
    """What a `fault` event found."""

    LEFT_HANDED = "left_handed"
    """the axes are a mirror image: acceleration and turning contradict each other under every rotation"""
    STUCK_AXIS = "stuck_axis"
    """an axis repeats one value while the others move"""
    SATURATED = "saturated"
    """readings rest at the end of the range"""
    DEVICE_LOOSE = "device_loose"
    """the mounting keeps moving"""


class Evidence(NamedTuple):
    """The series a sequential test decided on, oldest first; E looks."""

    t: Floats
    """(E,) s, session clock"""
    value: Floats
    """(E,) the statistic, no unit"""
    threshold: float
    """the value that decides"""


class Verification(NamedTuple):
    """The drive test (thesis 5.4): forward specific force integrated against the GPS speed."""

    state: str
    """idle, running, passed or failed"""
    elapsed: float
    """s of driving tested so far"""
    duration: float
    """s of driving the test takes"""
    error: float
    """m/s, speed error after the test (equivalent of thesis 5.4)"""
    limit: float
    """m/s, largest error that passes"""


class Event(NamedTuple):
    """Something that happened at time `t` of the session."""

    t: float
    """s, session clock"""
    kind: EventKind
    quaternion: Floats | None
    """(4,) q_vs the event is about: candidate, confirmed mounting, or the new orientation as far as it is known"""
    sigma: Floats | None
    """(3,) rad, 1 sigma about the vehicle axes"""
    verification: Verification | None
    """the drive test, with the verification events and `confirmed`"""
    angle: float | None
    """rad, size of the orientation change"""
    reason: str | None
    """with a fault or a failed verification: what is wrong, in words"""
    axis: Floats | None = None
    """(3,) unit vector, vehicle axes: axis of the orientation change, right-handed with `angle`"""
    since: float | None = None
    """s, session clock: when the device moved, or the fault began, as far as it shows"""
    evidence: Evidence | None = None
    """with an orientation change or a loose device: what the test saw"""
    fault: Fault | None = None
    """with a fault: which one"""


class Estimates(NamedTuple):
    """Estimates in time order, one row per report interval, columns as arrays of K rows."""

    t: Floats
    """(K,) s, session clock"""
    quaternion: Floats
    """(K, 4) q_vs"""
    sigma: Floats
    """(K, 3) rad, 1 sigma about vehicle x, y, z"""
    stage: NDArray[np.int64]
    """(K,) `Stage`"""
    needs: NDArray[np.int64]
    """(K,) `Needs`"""
    stable: NDArray[np.bool_]
    reliable: NDArray[np.bool_]
    progress: Floats
    """(K,) 0..1"""


class Speeds(NamedTuple):
    """Drive tests as they went: a row about each second of driving tested, one at the end, columns of K rows."""

    t: Floats
    """(K,) s, session clock"""
    gps: Floats
    """(K,) m/s, speed by the GPS"""
    sensor: Floats
    """(K,) m/s, speed by the accelerometer under the candidate; at the end of a test it is off by the error"""
    begins: NDArray[np.bool_]
    """(K,) the first row of a test"""


class Estimate(NamedTuple):
    """The estimate now."""

    t: float
    quaternion: Floats
    sigma: Floats
    stable: bool
    reliable: bool


class Mount(NamedTuple):
    """The confirmed mounting."""

    t: float
    """s on the clock of the session in which it was confirmed"""
    quaternion: Floats
    sigma: Floats
    verification: Verification
    suspect: bool
    """True once the device was seen to have moved"""


class Status(NamedTuple):
    """Where an installation stands."""

    stage: Stage
    needs: Needs
    progress: float
    estimate: Estimate | None
    verification: Verification
    mount: Mount | None
    faults: tuple[Fault, ...] = ()
    """faults of the sensor that go on"""


class Outcome(NamedTuple):
    """What one call of `advance` did."""

    samples: int
    """IMU samples used"""
    fixes: int
    """valid fixes used"""
    rejected: dict[str, int]
    """samples and fixes not used, counted by reason"""
    estimates: Estimates
    events: tuple[Event, ...]
    status: Status
    speed: float
    """m/s over ground at the last valid fix of the samples, NaN when it tells none that can be"""
    tested: Speeds
    """speeds of the drive tests"""
