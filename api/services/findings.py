"""What an event of the estimator tells the fleet's manager: kind and severity of an alert, its words and its data."""

from datetime import datetime
from typing import Any, NamedTuple

import numpy as np

import core
from api.services import presenting, words
from core import EventKind, Fault
from storage.alerts import Finding

ALERTS: dict[EventKind | Fault, tuple[str, str]] = {
    EventKind.ORIENTATION_CHANGED: ("orientation_changed", "warning"),
    Fault.DEVICE_LOOSE: ("device_loose", "critical"),
    Fault.LEFT_HANDED: ("sensor_fault", "critical"),
    Fault.STUCK_AXIS: ("sensor_fault", "critical"),
    Fault.SATURATED: ("sensor_fault", "warning"),
    EventKind.FAULT: ("sensor_fault", "warning"),
}
"""Kind and severity. Critical: no mounting can be found, or kept, until somebody acts. `FAULT`: not said which."""

FAULTS = {
    Fault.DEVICE_LOOSE: "The device is loose, it keeps moving: fasten it, then drive until a mounting is confirmed.",
    Fault.LEFT_HANDED: "The sensor's axes are a mirror image (left-handed): one axis must be negated before any "
    "mounting can be found. Correct it in the device, then restart the calibration.",
    Fault.STUCK_AXIS: "An axis of the sensor repeats one value while the others move: switch the device off and on, "
    "and replace it if the axis stays stuck.",
    Fault.SATURATED: "The sensor's readings rest at the end of their range: set a larger range in the device, "
    "and check that it does not knock against anything.",
}
"""What is wrong, and what puts it right."""
UNKNOWN_FAULT = "The sensor's readings cannot be right."


DATA = (
    *("session", "t", "at", "since_t", "since", "mount", "quaternion", "sigma_deg", "angle_deg", "axis", "evidence"),
    *("fault", "reason", "seen", "threshold", "unit"),
)
"""What the data of an alert may tell; `seen` and `threshold` are in `unit`."""


class Where(NamedTuple):
    """What an event is about."""

    session: str
    started_at: datetime | None
    """zero of the session's clock, UTC"""
    mount: int | None
    """number of the mounting in doubt"""


def finding(event: core.Event, where: Where) -> Finding | None:
    """Give the alert an event calls for, if any."""
    what = event.fault or event.kind
    if what not in ALERTS:
        return None
    kind, severity = ALERTS[what]
    return Finding(kind, severity, _message(event, where), _data(event, where))


def _message(event: core.Event, where: Where) -> str:
    since = _moment(where, event.since)
    minute = None if since is None else f"{since:%Y-%m-%d %H:%M} UTC"
    if event.kind == EventKind.ORIENTATION_CHANGED:
        moved = words.movement(event.angle, event.axis) + (f" around {minute}" if minute else "")
        return f"The device {moved}: the confirmed mounting no longer holds."
    sentence = FAULTS[event.fault] if event.fault else event.reason or UNKNOWN_FAULT
    return sentence + (f" Seen since {minute}." if minute else "")


def _data(event: core.Event, where: Where) -> dict[str, Any]:
    known = {
        "session": where.session,
        "t": event.t,
        "at": text(_moment(where, event.t)),
        "since_t": event.since,
        "since": text(_moment(where, event.since)),
        "mount": where.mount,
        "quaternion": None if event.quaternion is None else event.quaternion.tolist(),
        "sigma_deg": None if event.sigma is None else presenting.degrees(event.sigma),
        "angle_deg": None if event.angle is None else round(float(np.degrees(event.angle)), 2),
        "axis": None if event.axis is None else event.axis.tolist(),
        "evidence": None if event.evidence is None else presenting.evidence(event.evidence),
        "fault": event.fault and str(event.fault),
        "reason": event.reason,
    }
    return data(known)


def data(known: dict[str, Any]) -> dict[str, Any]:
    """Give the same keys for every alert; None is what is not known, or says nothing of this kind."""
    return dict.fromkeys(DATA) | known


def _moment(where: Where, t: float | None) -> datetime | None:
    """Give the moment at `t` seconds on the session's clock, if both are known."""
    return None if t is None or where.started_at is None else presenting.utc(where.started_at, t)


def text(moment: datetime | None) -> str | None:
    """Give a moment as RFC 3339 to the millisecond."""
    return None if moment is None else moment.isoformat(timespec="milliseconds").replace("+00:00", "Z")
