"""The estimator of one device during one transaction: loaded once, advanced chunk by chunk, saved once."""

import logging
from datetime import datetime, timedelta
from typing import Any

import numpy as np

import core
from api import metrics, schemas
from api.formats.log import Reading
from api.services import (
    alerting,
    detecting,
    findings,
    happenings,
    history,
    last_data,
    presenting,
    publishing,
    rules,
    speed_trace,
    watching,
)
from api.services.context import Context
from api.services.errors import UNKNOWN_DEVICE, NotFoundError, NotStillError, UnusableError
from api.services.foresight import Beginning, Foresight, advance, detect
from api.services.speed_trace import Trace
from core.motion.events import MotionEvent
from storage import installations, motion_events, mounts, sessions, standing
from storage.database import WriteSession
from storage.installations import Beside, Installation
from storage.mounts import Mount
from storage.sessions import Session
from storage.standing import Standing

log = logging.getLogger(__name__)

LONGEST_TIME = 1e10
"""s, largest reading of a device's clock that is believed: three centuries"""

LEVEL_WITHIN = timedelta(minutes=5)
"""Older data do not tell where the vehicle stands now; devices send about once a minute."""

STAGES = {stage.word: stage for stage in core.Stage}


class Calibration:
    """A device's installation while it is being changed; holds the device's lock."""

    def __init__(self, tx: WriteSession, context: Context, device_id: str, row: Installation) -> None:
        self.tx = tx
        self.context = context
        self.device_id = device_id
        self.row = row
        self.now = context.clock()
        self.foresight: Foresight | None = None
        self._standing: Standing | None = None
        """what was read of the device at the beginning; None: nothing, or it may have changed"""
        self._others = 0
        """of the transaction, when that was read"""
        self._state: core.State | None = None
        self._shown: schemas.Installation | None = None

    @classmethod
    def open(cls, tx: WriteSession, context: Context, device_id: str) -> "Calibration":
        """Lock the device and load its installation."""
        row = installations.lock(tx, device_id)
        if row is None:
            raise NotFoundError(UNKNOWN_DEVICE)
        return cls(tx, context, device_id, row)

    def find_session(self, name: str) -> Session:
        """Find a session, a new one if need be, and read what else an upload has to know of its device."""
        found = standing.find(self.tx, self.row.device_pk, name)
        self._standing, self._others = found, self.tx.others
        session = None if found is None else found.session
        return session or sessions.find_or_add(self.tx, self.row.device_pk, name, self.now)

    def look_anew(self) -> None:
        """What was read at the beginning holds no longer."""
        self._standing = None

    @property
    def _known(self) -> Standing | None:
        """What was read at the beginning; None once anything else than the rows of every upload was written."""
        return self._standing if self.tx.others == self._others else None

    @property
    def nothing_waits(self) -> bool:
        """True when it is known that no chunk waits."""
        known = self._known
        return known is not None and not known.waits

    def _mount(self) -> Mount | None:
        """Give the mounting in force, or the suspect one."""
        known = self._known
        return mounts.current(self.tx, self.row.device_pk) if known is None else known.mount

    def _beside(self) -> Beside:
        known = self._known
        return installations.beside(self.tx, self.row) if known is None else known.beside(self.row.since_session_pk)

    @property
    def state(self) -> core.State:
        """The estimator's state."""
        if self._state is None:
            self._state = self._load()
        return self._state

    def _load(self) -> core.State:
        if self.row.snapshot is None:
            return core.initial_state(self.context.params)
        try:
            return core.decode(self.row.snapshot)
        except core.SnapshotError as error:
            log.warning("device %s: calibration starts anew, its snapshot cannot be read: %s", self.device_id, error)
            return core.initial_state(self.context.params)

    def _snapshot(self) -> bytes | None:
        if self._state is None:
            return self.row.snapshot
        if self.foresight is not None and self._state is self.foresight.state:
            return self.foresight.snapshot
        return core.encode(self._state)

    def begin(self, session: Session) -> None:
        """The device was switched on: a new session, a new clock."""
        self._state = core.begin_session(self.context.params, self.state)
        self.row = self.row._replace(
            session_pk=session.pk,
            status=speed_trace.end_session(self.row.status),
            motion=detecting.begin_session(self.row.motion),
        )

    def restart(self) -> None:
        """The device was refitted on purpose: forget the mounting, keep the history."""
        self._state = core.restart(self.context.params, self.state)
        mounts.supersede(self.tx, self.row.device_pk, self.now)
        alerting.refitted(self.tx, self.row.device_pk, self.now)
        self.row = self.row._replace(watch=rules.forget(self.row.watch, rules.OF_MOUNTING), motion=None)
        self._show_anew()
        self.row = self.row._replace(since_session_pk=None, since_t=None, since_at=self.now)

    def level_start(self) -> None:
        """The vehicle stands on level ground now.

        Raises
        ------
        NotStillError
            the last data are old, or do not show it standing still; nothing has changed.
        """
        last_data_at = self.row.last_data_at
        if last_data_at is not None and self.now - last_data_at > LEVEL_WITHIN:
            minutes = LEVEL_WITHIN // timedelta(minutes=1)
            raise NotStillError(
                f"The device has sent nothing for {minutes} minutes: nobody can tell if it stands still."
            )
        try:
            self._state = core.level_start(self.context.params, self.state)
        except core.NotStillError as error:
            raise NotStillError(str(error)) from error
        before = self.row.stage
        self._show_anew()
        if self.row.stage != before:
            self.row = self.row._replace(since_session_pk=None, since_t=None, since_at=self.now)

    def apply(
        self, session: Session, seq: int, reading: Reading, received_at: datetime
    ) -> tuple[Session, core.Outcome | None]:
        """Advance by one chunk of the current session; give the session as it is then, and what the chunk did.

        Raises
        ------
        UnusableError
            the samples cannot be used; nothing has changed.
        """
        session = session._replace(context=reading.context)
        if len(reading.samples) == 0:
            return session, None
        t_last = last_time(reading.samples)
        try:
            state, outcome = self._advance(reading)
        except core.SampleError as error:
            raise UnusableError(str(error)) from error
        self._state = state
        began = received_at - timedelta(seconds=t_last)
        started_at = min(session.started_at or began, began)
        if session.started_at is not None and started_at < session.started_at:
            motion_events.move(self.tx, session.pk, session.started_at - started_at)
        session = session._replace(started_at=started_at)
        if self._standing is not None:
            self._standing = self._standing.as_begun(session)
        lag = self.now - started_at - timedelta(seconds=t_last)
        metrics.LAG.observe(max(lag.total_seconds(), 0.0))
        mount = self._mount()
        self._record(session, reading, outcome, received_at)
        happened = self._detect(session, seq, reading.samples, outcome, mount)
        self._watch(session, reading.samples, outcome, happened, received_at)
        return session, outcome

    def _advance(self, reading: Reading) -> tuple[core.State, core.Outcome]:
        correction = self.row.accelerometer_calibration
        if self.foresight is not None and self.foresight.holds(reading, self._snapshot(), correction):
            return self.foresight.state, self.foresight.outcome
        return advance(self.context.params, correction, self.state, reading.samples)

    def _record(self, session: Session, reading: Reading, outcome: core.Outcome, received_at: datetime) -> None:
        """Keep what a chunk brought: history, mountings, alerts, status."""
        before = STAGES[self.row.stage]
        history.append(self.tx, self.row.device_pk, session.pk, outcome.estimates, before, received_at)
        for event in outcome.events:
            self._follow(session, event, speed_trace.carry_on(self._trace, outcome.tested, event.t))
        since = stage_began(before, outcome, float(reading.samples.t[-1]))
        if since is not None:
            self.row = self.row._replace(since_session_pk=session.pk, since_t=since, since_at=self.now)
        trace = speed_trace.carry_on(self._trace, outcome.tested)
        self._show(outcome.status, trace, last_data.describe(session.name, reading, outcome))
        self.row = self.row._replace(last_data_at=max(received_at, self.row.last_data_at or received_at))

    def _follow(self, session: Session, event: core.Event, trace: Trace | None) -> None:
        """Turn an event into a mounting or an alert."""
        device_pk = self.row.device_pk
        if event.kind == core.EventKind.CONFIRMED:
            self._confirm(session, event, trace)
            alerting.end(self.tx, device_pk, [alerting.MOVED], "A new mounting was confirmed.", self.now)
        if event.kind == core.EventKind.ORIENTATION_CHANGED:
            mounts.suspect(self.tx, device_pk, self._moment(session, event.t))
        current = mounts.current(self.tx, device_pk)
        where = findings.Where(session.name, session.started_at, None if current is None else current.n)
        alerting.raise_for(self.tx, self.context, device_pk, event, where, self.now)

    def _detect(
        self, session: Session, seq: int, samples: core.Samples, outcome: core.Outcome, mount: Mount | None
    ) -> tuple[MotionEvent, ...]:
        """Look for what happened to the vehicle; `mount` is the current one before the chunk."""
        beginning, foresight = Beginning.of(self.row, mount), self.foresight
        if foresight is not None and outcome is foresight.outcome and beginning == foresight.beginning:
            state, found = foresight.detection
        else:
            state, found = detect(beginning, self.row.accelerometer_calibration, outcome, samples)
        self.row = self.row._replace(motion=state)
        newest = mounts.current(self.tx, self.row.device_pk) if found else mount
        confirmed = sum(event.kind is core.EventKind.CONFIRMED for event in outcome.events)
        for before, event in found:
            n = newest.n - confirmed + before if newest is not None else 0
            happenings.record(self.tx, self.context, self.row.device_pk, (session, seq), event, n, self.now)
        return tuple(event for _, event in found)

    def _watch(
        self,
        session: Session,
        samples: core.Samples,
        outcome: core.Outcome,
        happened: tuple[MotionEvent, ...],
        received_at: datetime,
    ) -> None:
        """Let the rules of the alerts see the chunk."""
        seen = rules.see((session.pk, session.name, session.started_at), samples, outcome, happened, received_at)
        watch = watching.observe(self.tx, self.context, self.row, seen, self.now)
        self.row = self.row._replace(watch=watch)

    def _confirm(self, session: Session, event: core.Event, trace: Trace | None) -> None:
        if event.quaternion is None or event.sigma is None or event.verification is None:
            raise ValueError("a confirmed mounting without its values")
        mounts.add(
            self.tx,
            self.row.device_pk,
            session.pk,
            event.t,
            event.quaternion.tolist(),
            presenting.degrees(event.sigma),
            presenting.drive_test(event.verification, trace),
            self._moment(session, event.t),
        )

    def _moment(self, session: Session, t: float) -> datetime:
        return self.now if session.started_at is None else presenting.utc(session.started_at, t)

    @property
    def _trace(self) -> Trace | None:
        trace: Trace | None = self.row.status["verification"].get("trace")
        return trace

    def _show_anew(self) -> None:
        """Let it be seen where the installation stands without new data."""
        status = core.status(self.context.params, self.state)
        self._show(status, self._trace, self.row.status.get("data"))

    def _show(self, status: core.Status, trace: Trace | None, data: dict[str, Any] | None) -> None:
        shown = presenting.status(status, trace, data)
        self.row = self.row._replace(stage=status.stage.word, status=shown, revision=self.row.revision + 1)

    def save(self) -> None:
        """Store the installation and tell the live stream, if anything has changed."""
        if self._state is None:
            return
        self.row = self.row._replace(snapshot=self._snapshot())
        self._shown = None
        installations.save(self.tx, self.row)
        publishing.installation_changed(self.tx, self.shown(), self.now)

    def shown(self) -> schemas.Installation:
        """Give the installation resource."""
        if self._shown is None:
            self._shown = presenting.installation(self.row, self.device_id, self._beside(), self.context.params)
        return self._shown


def last_time(samples: core.Samples) -> float:
    """Give the last time of samples, refusing a clock that no device can have."""
    first, last = float(samples.t[0]), float(samples.t[-1])
    if max(abs(first), abs(last)) > LONGEST_TIME:
        raise UnusableError(f"The time is out of range: expected at most {LONGEST_TIME:.0e} s.")
    return last


def stage_began(before: core.Stage, outcome: core.Outcome, t_last: float) -> float | None:
    """Give the time at which the stage now reached began, None when it began before these samples."""
    t, stage = outcome.estimates.t, outcome.estimates.stage
    other = np.flatnonzero(stage != outcome.status.stage)
    first = int(other[-1]) + 1 if other.size else 0
    if other.size == 0 and before == outcome.status.stage:
        return None
    return float(t[first]) if first < t.size else t_last
