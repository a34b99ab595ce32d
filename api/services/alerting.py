"""Alerts: opened by what the estimator finds, and when they are over.

They end by themselves when a mounting is confirmed, not before: that is the hysteresis, a single good moment does not
clear them. A deliberate refit (restart) ends them too.
"""

from collections.abc import Callable
from datetime import datetime

import core
from api import schemas
from api.services import auditing, findings, presenting, publishing
from api.services.access import Principal
from api.services.context import Context
from api.services.errors import NotFoundError
from storage import alerts, installations
from storage.database import ReadSession, WriteSession

ENDED_BY_CONFIRMATION = sorted({kind for kind, _ in findings.ALERTS.values()})
SERVICE = "service"
"""Who resolved an alert that nobody resolved by hand."""


def raise_for(tx: WriteSession, device_pk: int, event: core.Event, where: findings.Where, now: datetime) -> None:
    """Open the alert an event calls for, or count it once more."""
    finding = findings.finding(event, where)
    if finding is not None:
        publishing.alert_changed(tx, alerts.raise_(tx, device_pk, finding, now), now)


def end(tx: WriteSession, device_pk: int, note: str, now: datetime) -> None:
    """Resolve what a newly confirmed mounting, or a deliberate refit, puts right."""
    for alert in alerts.find_open(tx, device_pk, ENDED_BY_CONFIRMATION):
        alerts.resolve(tx, alert.pk, SERVICE, note, now)
        publishing.alert_changed(tx, alert.pk, now)


def find(context: Context, pk: int) -> schemas.Alert:
    """Give an alert."""
    with context.database.read() as tx:
        return presenting.alert(_found(tx, pk))


def acknowledge(context: Context, principal: Principal, pk: int, note: str | None) -> schemas.Alert:
    """Record who has seen an open alert; one that was seen or is over stays as it is."""
    return _settle(context, principal, pk, note, "acknowledge", (alerts.OPEN,), alerts.acknowledge)


def resolve(context: Context, principal: Principal, pk: int, note: str | None) -> schemas.Alert:
    """Record who says that an alert is over; one that is over stays as it is."""
    return _settle(context, principal, pk, note, "resolve", (alerts.OPEN, alerts.ACKNOWLEDGED), alerts.resolve)


def _settle(
    context: Context,
    principal: Principal,
    pk: int,
    note: str | None,
    verb: str,
    from_states: tuple[str, ...],
    change: Callable[[WriteSession, int, str, str | None, datetime], None],
) -> schemas.Alert:
    now = context.clock()
    with context.database.write() as tx:
        device_id = _found(tx, pk).device_id
        row = installations.lock(tx, device_id)
        if row is not None and _found(tx, pk).state in from_states:
            change(tx, pk, principal.name, note, now)
            told = {"device_id": device_id, "note": note}
            auditing.record(tx, principal, f"alert.{verb}", f"alerts/{pk}", told, now)
            publishing.alert_changed(tx, pk, now)
            publishing.installation_touched(tx, row, device_id, context.params, now)
        shown = presenting.alert(_found(tx, pk))
    context.wake()
    return shown


def _found(tx: ReadSession, pk: int) -> alerts.Alert:
    row = alerts.find(tx, pk)
    if row is None:
        raise NotFoundError("There is no such alert.")
    return row
