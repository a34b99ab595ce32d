"""The estimator's work on a chunk, done before the lock.

On SQLite everybody who writes waits for everybody else, and advancing the estimator takes longer than all statements of
an upload. It is a pure function, so it is computed on what is read beforehand; the transaction uses the result if it
finds the same state there, and computes anew if another upload came between.
"""

from dataclasses import replace
from typing import Any, NamedTuple, Self

import numpy as np

import core
from api import metrics
from api.formats import ParsedLog, raw
from api.formats.log import Reading
from api.services import detecting
from api.services.context import Context
from api.services.detecting import Detection
from storage import installations, standing
from storage.database import ReadSession
from storage.installations import Installation
from storage.mounts import Mount
from storage.sessions import Session

Correction = dict[str, Any] | None
"""Calibration of a device's accelerometer, as it is stored."""


class Beginning(NamedTuple):
    """What the detector of events begins a chunk with."""

    state: bytes | None
    q_vs: list[float] | None
    """mounting in force"""

    @classmethod
    def of(cls, row: Installation, mount: Mount | None) -> Self:
        """Give that of an installation with its current mounting."""
        return cls(row.motion, mount.quaternion if mount is not None and mount.in_force else None)


class Foresight(NamedTuple):
    """What a chunk does to a state."""

    session_context: dict[str, Any] | None
    reading: Reading
    before: bytes
    """snapshot of the state before"""
    correction: Correction
    state: core.State
    outcome: core.Outcome
    snapshot: bytes
    """of the state"""
    raw: bytes | None
    """the samples as they are kept, None: they are not"""
    beginning: Beginning
    """from which events were looked for"""
    detection: Detection

    def holds(self, reading: Reading, before: bytes | None, correction: Correction) -> bool:
        """Tell whether this is what `advance` would give."""
        return reading is self.reading and correction == self.correction and before == self.before


class Stand(NamedTuple):
    """Where a device stands when it sends the next chunk of a session."""

    row: Installation
    session: Session | None
    """None: it begins one"""
    mount: Mount | None
    """the one in force, or the suspect one"""


def look_up(tx: ReadSession, device_id: str, session: str, seq: int) -> Stand | None:
    """Find where a device stands; None when the chunk is not the next of its session, or the device is not known."""
    row = installations.find(tx, device_id)
    if row is None:
        return None
    found = standing.find(tx, row.device_pk, session)
    if found is None or seq != (0 if found.session is None else found.session.next_seq):
        return None
    return Stand(row, found.session, found.mount)


def foresee(context: Context, stand: Stand, parsed: ParsedLog) -> Foresight | None:
    """Advance a device's estimator by a chunk; None when that cannot be done."""
    row, session, mount = stand
    correction = row.accelerometer_calibration
    session_context = None if session is None else session.context
    begins = session is None or row.session_pk != session.pk
    if begins:
        row = row._replace(motion=detecting.begin_session(row.motion))
    try:
        state, before = _state(context.params, row, begins)
        reading = parsed.samples(session_context)
        after, outcome = advance(context.params, correction, state, reading.samples)
    except (core.SnapshotError, core.SampleError):
        return None  # the transaction says what is wrong
    beginning = Beginning.of(row, mount)
    detection = detect(beginning, correction, outcome, reading.samples)
    known = (pack(context, reading), beginning, detection)
    return Foresight(session_context, reading, before, correction, after, outcome, core.encode(after), *known)


def detect(beginning: Beginning, correction: Correction, outcome: core.Outcome, samples: core.Samples) -> Detection:
    """Look for events in the samples of a chunk."""
    return detecting.detect(*beginning, outcome.events, corrected(correction, samples))


def pack(context: Context, reading: Reading) -> bytes | None:
    """Give the samples of a chunk as they are kept; None when they are not."""
    return raw.pack(reading.samples) if context.settings.raw_retention_days > 0 else None


def _state(params: core.Parameters, row: Installation, begins: bool) -> tuple[core.State, bytes]:
    """Give the state that a chunk meets, with its snapshot."""
    state = core.initial_state(params) if row.snapshot is None else core.decode(row.snapshot)
    if begins:
        state = core.begin_session(params, state)
    return state, core.encode(state) if begins or row.snapshot is None else row.snapshot


def advance(
    params: core.Parameters, correction: Correction, state: core.State, samples: core.Samples
) -> tuple[core.State, core.Outcome]:
    """Advance by samples, less the accelerometer's errors where they are known; what is left of its bias is small."""
    if correction is not None:
        params = core.calibrated(params)
    with metrics.estimator():
        return core.advance(params, state, corrected(correction, samples))


def corrected(correction: Correction, samples: core.Samples) -> core.Samples:
    """Give samples less the accelerometer's errors, where they are known."""
    if correction is None:
        return samples
    calibration = core.AccelerometerCalibration(np.array(correction["gain"]), np.array(correction["offset"]))
    return replace(samples, f_s=core.accelerometer.apply(calibration, samples.f_s))
