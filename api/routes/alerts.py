"""Alerts."""

from typing import Annotated

from fastapi import APIRouter, Depends, Path, Query
from pydantic import AwareDatetime

from api import schemas
from api.dependencies import BeforePlace, CurrentContext, Limit, Manager, Requires
from api.services import alerting, paging, presenting
from api.services.access import Role
from storage import alerts

router = APIRouter(prefix="/alerts", tags=["alerts"], dependencies=[Depends(Requires(Role.MANAGER))])

Number = Annotated[int, Path(ge=1, le=2**63 - 1)]


@router.get("")
def list_alerts(
    context: CurrentContext,
    before: BeforePlace,
    state: schemas.AlertState | None = None,
    kind: schemas.AlertKind | None = None,
    severity: schemas.Severity | None = None,
    device_id: schemas.Words | None = None,
    since: Annotated[AwareDatetime | None, Query(description="Opened at or after.")] = None,
    until: Annotated[AwareDatetime | None, Query(description="Opened before.")] = None,
    limit: Limit = 100,
) -> schemas.Page[schemas.Alert]:
    """List alerts, newest first."""
    wanted = alerts.Filter(state, kind, severity, device_id, since, until)
    with context.database.read() as tx:
        rows = alerts.page(tx, limit + 1, None if before is None else alerts.Place(*before), wanted)
    return paging.page(rows, limit, lambda row: paging.place(row.opened_at, row.pk), presenting.alert)


@router.get("/{alert_id}")
def read_alert(alert_id: Number, context: CurrentContext) -> schemas.Alert:
    """Read an alert."""
    return alerting.find(context, alert_id)


@router.post("/{alert_id}/acknowledge")
def acknowledge_alert(
    alert_id: Number, note: schemas.AlertNote, principal: Manager, context: CurrentContext
) -> schemas.Alert:
    """Record that somebody has seen the alert."""
    return alerting.acknowledge(context, principal, alert_id, note.note)


@router.post("/{alert_id}/resolve")
def resolve_alert(
    alert_id: Number, note: schemas.AlertNote, principal: Manager, context: CurrentContext
) -> schemas.Alert:
    """Record that the alert is over."""
    return alerting.resolve(context, principal, alert_id, note.note)
