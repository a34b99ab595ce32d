"""Alerts: which event of the estimator opens one, and when it is over.

`orientation_changed` and `sensor_fault` end by themselves when a mounting is confirmed, not before: that is the
hysteresis, a single good moment does not clear them. A deliberate refit (restart) ends them too.
"""

from collections.abc import Callable
from datetime import datetime
from typing import Any, NamedTuple

import numpy as np

import core
from api import schemas
from api.services import presenting, publishing
from api.services.context import Context
from api.services.errors import NotFoundError
from storage import alerts, installations
from storage.database import ReadSession, WriteSession

ENDED_BY_CONFIRMATION = ("orientation_changed", "sensor_fault")
SERVICE = "service"
"""Who resolved an alert that nobody resolved by hand."""


class Where(NamedTuple):
    """What an event is about."""

    session: str
    mount: int | None
    """number of the mounting in doubt"""


def orientation_changed(event: core.Event, where: Where) -> alerts.Finding:
    """The device sits otherwise than when its mounting was confirmed."""
    angle = None if event.angle is None else round(float(np.degrees(event.angle)), 2)
    size = "" if angle is None else f" by {angle:.1f} degrees"
    message = f"The device has moved{size} since its mounting was confirmed."
    return alerts.Finding("orientation_changed", "warning", message, {"angle_deg": angle} | _data(event, where))


def sensor_fault(event: core.Event, where: Where) -> alerts.Finding:
    """The readings contradict what a sensor can measure."""
    reason = event.reason or "The sensor's readings cannot be right."
    return alerts.Finding("sensor_fault", "warning", reason, {"reason": reason} | _data(event, where))


FINDINGS: dict[core.EventKind, Callable[[core.Event, Where], alerts.Finding]] = {
    core.EventKind.ORIENTATION_CHANGED: orientation_changed,
    core.EventKind.FAULT: sensor_fault,
}


def _data(event: core.Event, where: Where) -> dict[str, Any]:
    return {
        "session": where.session,
        "t": event.t,
        "mount": where.mount,
        "quaternion": None if event.quaternion is None else event.quaternion.tolist(),
        "sigma_deg": None if event.sigma is None else presenting.degrees(event.sigma),
    }


def raise_for(tx: WriteSession, device_pk: int, event: core.Event, where: Where, now: datetime) -> None:
    """Open the alert an event calls for, or count it once more."""
    finding = FINDINGS.get(event.kind)
    if finding is not None:
        publishing.alert_changed(tx, alerts.raise_(tx, device_pk, finding(event, where), now), now)


def end(tx: WriteSession, device_pk: int, note: str, now: datetime) -> None:
    """Resolve what a newly confirmed mounting, or a deliberate refit, puts right."""
    for alert in alerts.find_open(tx, device_pk, ENDED_BY_CONFIRMATION):
        alerts.resolve(tx, alert.pk, SERVICE, note, now)
        publishing.alert_changed(tx, alert.pk, now)


def find(context: Context, pk: int) -> schemas.Alert:
    """Give an alert."""
    with context.database.read() as tx:
        return presenting.alert(_found(tx, pk))


def acknowledge(context: Context, pk: int, by: str, note: str | None) -> schemas.Alert:
    """Record who has seen an open alert; one that was seen or is over stays as it is."""
    return _settle(context, pk, by, note, (alerts.OPEN,), alerts.acknowledge)


def resolve(context: Context, pk: int, by: str, note: str | None) -> schemas.Alert:
    """Record who says that an alert is over; one that is over stays as it is."""
    return _settle(context, pk, by, note, (alerts.OPEN, alerts.ACKNOWLEDGED), alerts.resolve)


def _settle(
    context: Context,
    pk: int,
    by: str,
    note: str | None,
    from_states: tuple[str, ...],
    change: Callable[[WriteSession, int, str, str | None, datetime], None],
) -> schemas.Alert:
    now = context.clock()
    with context.database.write() as tx:
        device_id = _found(tx, pk).device_id
        row = installations.lock(tx, device_id)
        if row is not None and _found(tx, pk).state in from_states:
            change(tx, pk, by, note, now)
            publishing.alert_changed(tx, pk, now)
            publishing.installation_touched(tx, row, device_id, now)
        shown = presenting.alert(_found(tx, pk))
    context.wake()
    return shown


def _found(tx: ReadSession, pk: int) -> alerts.Alert:
    row = alerts.find(tx, pk)
    if row is None:
        raise NotFoundError("There is no such alert.")
    return row
