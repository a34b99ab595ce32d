"""Alerts: opened by what the estimator finds, and when they are over.

What the estimator reports is raised here as it comes; the rest, and when each kind is over, is decided by the rules
(`rules/`). That the device was turned is over when the new mounting is confirmed. A deliberate refit (restart) ends
what is about the mounting. An alert that comes back soon after it was over by itself is opened again; one that was
resolved by hand, or by a refit, stays resolved, and a new one is opened.
"""

from collections.abc import Callable, Sequence
from datetime import datetime, timedelta

import core
from api import schemas
from api.services import auditing, findings, presenting, publishing, rules
from api.services.access import Principal
from api.services.context import Context
from api.services.errors import NotFoundError
from storage import alerts, installations
from storage.database import ReadSession, WriteSession

MOVED = "orientation_changed"
NEVER_REOPENED = ("device_silent",)
"""Each silence is one of its own."""
SERVICE = "service"
"""Who resolved an alert that nobody resolved by hand."""


def raise_for(
    tx: WriteSession, context: Context, device_pk: int, event: core.Event, where: findings.Where, now: datetime
) -> None:
    """Open the alert an event calls for, or count it once more."""
    finding = findings.finding(event, where)
    if finding is not None:
        raise_(tx, context, device_pk, finding, now)


def raise_(tx: WriteSession, context: Context, device_pk: int, finding: alerts.Finding, now: datetime) -> None:
    """Open an alert, count it once more, or open it again."""
    window = timedelta(minutes=context.settings.alert_reopen_minutes)
    reopen_since = None if finding.kind in NEVER_REOPENED else now - window
    is_opened = not alerts.find_open(tx, device_pk, [finding.kind])
    publishing.alert_changed(tx, alerts.raise_(tx, device_pk, finding, now, reopen_since), now, is_opened)


def end(tx: WriteSession, device_pk: int, kinds: Sequence[str], note: str, now: datetime) -> None:
    """Resolve alerts whose condition is over by itself."""
    _end(tx, device_pk, kinds, note, now, automatically=True)


def refitted(tx: WriteSession, device_pk: int, now: datetime) -> None:
    """Resolve what a deliberate refit puts right; what is found afterwards is found of another mounting."""
    _end(tx, device_pk, rules.OF_MOUNTING, "The calibration was restarted.", now, automatically=False)


def _end(tx: WriteSession, device_pk: int, kinds: Sequence[str], note: str, now: datetime, automatically: bool) -> None:
    for alert in alerts.find_open(tx, device_pk, kinds):
        alerts.resolve(tx, alert.pk, SERVICE, note, now, automatically)
        publishing.alert_changed(tx, alert.pk, now)


def find(context: Context, pk: int) -> schemas.Alert:
    """Give an alert."""
    with context.database.read() as tx:
        return presenting.alert(_found(tx, pk))


def acknowledge(context: Context, principal: Principal, pk: int, note: str | None) -> schemas.Alert:
    """Record who has seen an open alert; one that was seen or is over stays as it is."""
    return _settle(context, principal, pk, note, "acknowledge", (alerts.OPEN,), alerts.acknowledge)


def resolve(context: Context, principal: Principal, pk: int, note: str | None) -> schemas.Alert:
    """Record who says that an alert is over; one that is over stays as it is. Its rule begins anew."""
    return _settle(context, principal, pk, note, "resolve", (alerts.OPEN, alerts.ACKNOWLEDGED), _resolve)


def _resolve(tx: WriteSession, pk: int, by: str, note: str | None, now: datetime) -> None:
    alerts.resolve(tx, pk, by, note, now)
    alert = _found(tx, pk)
    row = installations.find(tx, alert.device_id)
    if row is not None:
        installations.remember(tx, row.device_pk, rules.forget(row.watch, [alert.kind]))


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
