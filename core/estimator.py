"""The only door to the estimator: `advance(params, state, samples) -> (state, outcome)`.

The stages in order, as in the flow chart of thesis 6.2: samples -> epochs -> coarse alignment -> filter -> moving
average, STABLE, RELIABLE -> drive test -> confirmed mounting -> watch for an orientation change. States are values:
none of these functions changes its arguments.
"""

import math

import numpy as np
from numpy.typing import NDArray

from core import _kernel
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
from core.params import Parameters, as_record
from core.samples import Samples
from core.state import LOOKS, State, empty_clock, empty_state, independent

Floats = NDArray[np.float64]

REJECTIONS = ("duplicate_time", "before_previous_sample", "fix_without_velocity", "fix_implausible")
_VERIFICATION_STATES = ("idle", "running", "passed", "failed")
_EVENT_KINDS = (
    EventKind.VERIFICATION_STARTED,
    EventKind.VERIFICATION_PASSED,
    EventKind.VERIFICATION_FAILED,
    EventKind.CONFIRMED,
    EventKind.ORIENTATION_CHANGED,
    EventKind.FAULT,
)
_FAULTS = (
    (Fault.LEFT_HANDED, "The axes are a mirror image: no rotation explains how acceleration and turning go together."),
    (Fault.STUCK_AXIS, "An axis of the accelerometer repeats one value while the vehicle moves."),
    (Fault.SATURATED, "Readings rest at the end of the accelerometer's range."),
    (Fault.DEVICE_LOOSE, "The mounting keeps changing: the device is loose."),
)
_REASONS = (
    None,
    "the speed integrated from the accelerometer departs from the GPS speed",
    "filter and coarse alignment disagree",
    "the estimate moved on while the candidate was tested",
    "the drive did not show the mounting well enough",
)
_WITH_EVIDENCE = (EventKind.ORIENTATION_CHANGED, EventKind.FAULT)
_ROW = 14
_EVENT_ROW = 18
_EVENTS_PER_FIX = 6
_SPEED_ROW = 4


def initial_state(params: Parameters) -> State:
    """Give the state of a device nothing is known of."""
    del params  # both presets start from nothing
    return empty_state()


def begin_session(params: Parameters, state: State) -> State:
    """Begin a session of the device's clock: motion and attitude of the vehicle are unknown, the mounting is kept."""
    del params
    state = state.copy()
    state.filter["aligned"] = False
    state.merged["period"] = 0.0
    state.change["state"] = 0  # what was suspected before is not known to be of this mounting
    state.change["series_count"] = 0
    state.faults["restless_t"] = np.nan
    return state._replace(clock=empty_clock())


def restart(params: Parameters, state: State) -> State:
    """Forget everything about the mounting, because the device was refitted; the session goes on."""
    return initial_state(params)._replace(clock=state.clock.copy())


def advance(params: Parameters, state: State, samples: Samples) -> tuple[State, Outcome]:
    """Take the next samples of the session.

    A drive in any pieces gives bit for bit what the drive at once gives: the same states, estimates and events.

    Parameters
    ----------
    params
        the preset; the same for all pieces of a drive
    state
        state after the samples before
    samples
        samples that follow; those not newer than the last one are rejected and counted

    Returns
    -------
    State, Outcome
        state after the samples, and what happened
    """
    state = state.copy()
    rows = np.zeros((_row_limit(params, samples), _ROW))
    limit = _EVENTS_PER_FIX * samples.fix_row.size + 1
    events = np.empty((limit, _EVENT_ROW))
    evidence = np.empty((limit, LOOKS, 2))
    speeds = np.empty((samples.fix_row.size, _SPEED_ROW))
    epochs = np.zeros(1, _kernel.EPOCH)
    epochs["next_speed"] = np.nan
    counts = np.zeros(len(REJECTIONS), np.int64)
    row_count, event_count, speed_count = _kernel.run(
        as_record(params),
        *state,
        epochs,
        np.zeros(1, _kernel.WORK),
        samples.t,
        samples.f_s,
        samples.w_s,
        samples.fix_row,
        samples.fix_valid,
        samples.fix,
        rows,
        events,
        evidence,
        speeds,
        counts,
    )
    outcome = Outcome(
        samples=len(samples) - int(counts[0] + counts[1]),
        fixes=int(np.count_nonzero(samples.fix_valid)) - int(counts[2] + counts[3]),
        rejected={reason: int(n) for reason, n in zip(REJECTIONS, counts, strict=True) if n},
        estimates=_estimates(rows[:row_count]),
        events=tuple(_event(params, row, series) for row, series in zip(events[:event_count], evidence, strict=False)),
        status=status(params, state),
        speed=float(epochs["next_speed"][0]),
        tested=_speeds(speeds[:speed_count]),
    )
    return state, outcome


def status(params: Parameters, state: State) -> Status:
    """Say where the installation stands."""
    row = np.zeros(_ROW)
    clock = independent(state.clock.tobytes(), state.clock.dtype)
    settling = independent(state.settling.tobytes(), state.settling.dtype)
    known = _kernel.stand(as_record(params), clock, state.coarse, state.filter, settling, state.verification, row)
    estimate = Estimate(float(row[0]), row[1:5].copy(), row[5:8].copy(), bool(row[10]), bool(row[11]))
    return Status(
        stage=Stage(int(row[8])),
        needs=Needs(int(row[9])),
        progress=float(row[12]),
        estimate=estimate if known else None,
        verification=_verification(params, state),
        mount=_mount(params, state),
        faults=_going_on(state),
    )


def _going_on(state: State) -> tuple[Fault, ...]:
    reported = int(state.faults["reported"][0])
    return tuple(fault for which, (fault, _) in enumerate(_FAULTS) if reported >> which & 1)


def _row_limit(params: Parameters, samples: Samples) -> int:
    """Most history rows these samples can give."""
    if not len(samples):
        return 0
    span = float(samples.t[-1] - samples.t[0])
    return int(min(len(samples), math.floor(span / params.report_interval) + 2))


def _estimates(rows: Floats) -> Estimates:
    return Estimates(
        t=rows[:, 0].copy(),
        quaternion=rows[:, 1:5].copy(),
        sigma=rows[:, 5:8].copy(),
        stage=rows[:, 8].astype(np.int64),
        needs=rows[:, 9].astype(np.int64),
        stable=rows[:, 10] > 0,
        reliable=rows[:, 11] > 0,
        progress=rows[:, 12].copy(),
    )


def _speeds(rows: Floats) -> Speeds:
    return Speeds(t=rows[:, 0].copy(), gps=rows[:, 1].copy(), sensor=rows[:, 2].copy(), begins=rows[:, 3] > 0)


def _event(params: Parameters, row: Floats, series: Floats) -> Event:
    kind = _EVENT_KINDS[int(row[1])]
    looks = series[np.isfinite(series[:, 0])] if kind in _WITH_EVIDENCE else series[:0]
    evidence = Evidence(looks[:, 0].copy(), looks[:, 1].copy(), params.change.decision) if looks.size else None
    if kind is EventKind.FAULT:
        fault, sentence = _FAULTS[int(row[17])]
        since = float(row[16]) if np.isfinite(row[16]) else None
        return Event(float(row[0]), kind, None, None, None, None, sentence, None, since, evidence, fault)
    reason = _REASONS[int(row[2])]
    event = Event(float(row[0]), kind, row[3:7].copy(), row[7:10].copy(), None, None, reason)
    if kind is EventKind.ORIENTATION_CHANGED:
        angle = float(np.linalg.norm(row[13:16]))
        return event._replace(angle=angle, axis=row[13:16] / angle, since=float(row[16]), evidence=evidence)
    state = {EventKind.VERIFICATION_STARTED: "running", EventKind.VERIFICATION_FAILED: "failed"}.get(kind, "passed")
    duration = params.verification.duration
    return event._replace(verification=Verification(state, float(row[10]), duration, float(row[11]), float(row[12])))


def _verification(params: Parameters, state: State) -> Verification:
    record, test = state.verification[0], params.verification
    name = _VERIFICATION_STATES[int(record["state"])]
    return Verification(
        name, float(record["elapsed"]), test.duration, float(record["error"]), float(record["limit"]) or test.limit
    )


def _mount(params: Parameters, state: State) -> Mount | None:
    record, test = state.settling[0], params.verification
    if not record["has_mount"]:
        return None
    return Mount(
        t=float(record["mount_t"]),
        quaternion=record["mount_q_vs"].copy(),
        sigma=record["mount_sigma"].copy(),
        verification=Verification(
            "passed",
            float(record["mount_elapsed"]),
            test.duration,
            float(record["mount_error"]),
            float(record["mount_limit"]),
        ),
        suspect=bool(record["suspect"]),
    )
