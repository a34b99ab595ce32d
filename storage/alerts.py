"""Alerts. One open alert per device and kind: a recurrence raises its count."""

from collections.abc import Callable, Sequence
from datetime import datetime
from typing import Any, NamedTuple

import sqlalchemy as sa

from storage.database import ReadSession, WriteSession
from storage.models import Instant, alert_unresolved, alerts, devices

OPEN, ACKNOWLEDGED, RESOLVED = "open", "acknowledged", "resolved"
SEVERITIES = ("info", "warning", "critical")
"""Mildest first."""
REOPENED = {
    "state": OPEN,
    "resolved_at": None,
    "resolved_by": None,
    "resolve_note": None,
    "resolved_automatically": None,
}
"""What changes with an alert that is opened again; who had seen it stays on record."""


class Alert(NamedTuple):
    """An alert."""

    pk: int
    device_id: str
    kind: str
    severity: str
    state: str
    opened_at: datetime
    updated_at: datetime
    occurrences: int
    message: str
    data: dict[str, Any]
    acknowledged_at: datetime | None
    acknowledged_by: str | None
    acknowledge_note: str | None
    resolved_at: datetime | None
    resolved_by: str | None
    resolve_note: str | None


class Finding(NamedTuple):
    """What an alert tells."""

    kind: str
    severity: str
    message: str
    data: dict[str, Any]


class Place(NamedTuple):
    """A place in a list of alerts."""

    opened_at: datetime
    pk: int


class Filter(NamedTuple):
    """Which alerts to list."""

    state: str | None = None
    kind: str | None = None
    severity: str | None = None
    device_id: str | None = None
    since: datetime | None = None
    until: datetime | None = None


_select = sa.select(
    alerts.c.pk, devices.c.id, *(alerts.c[name] for name in Alert._fields if name not in {"pk", "device_id"})
).join_from(alerts, devices)
_find = _select.where(alerts.c.pk == sa.bindparam("pk"))
_find_open = _select.where(
    alerts.c.device_pk == sa.bindparam("device_pk"),
    alert_unresolved,
    alerts.c.kind.in_(sa.bindparam("kinds", expanding=True)),
).order_by(alerts.c.pk)
_device_id = sa.select(devices.c.id).where(devices.c.pk == sa.bindparam("of_device_pk")).scalar_subquery()
_add = sa.insert(alerts).values(device_id=_device_id).returning(alerts.c.pk)
_now = sa.bindparam("now", type_=Instant)
_not_before = sa.case((alerts.c.updated_at > _now, alerts.c.updated_at), else_=_now)
_change = sa.update(alerts).where(alerts.c.pk == sa.bindparam("of_pk")).values(updated_at=_not_before)
_acknowledge = _change.values(acknowledged_at=_not_before)
_resolve = _change.values(resolved_at=_not_before)
"""Times of an alert never run backwards, whatever the clock does."""
_find_over = (
    _select.where(
        alerts.c.device_pk == sa.bindparam("device_pk"),
        alerts.c.kind == sa.bindparam("kind"),
        alerts.c.resolved_automatically,
        alerts.c.resolved_at >= sa.bindparam("since"),
    )
    .order_by(alerts.c.pk.desc())
    .limit(1)
)
_newest = sa.select(sa.func.max(alerts.c.pk)).where(
    alerts.c.device_pk == sa.bindparam("device_pk"), alerts.c.kind == sa.bindparam("kind")
)
_counts = (
    sa.select(alerts.c.kind, alerts.c.severity, sa.func.count())
    .where(alert_unresolved)
    .group_by(alerts.c.kind, alerts.c.severity)
)
_each_device = sa.select(alerts.c.severity, alerts.c.device_id).where(alert_unresolved).distinct()


def find(tx: ReadSession, pk: int) -> Alert | None:
    """Find an alert by its number."""
    return tx.one(Alert, _find, pk=pk)


def find_open(tx: ReadSession, device_pk: int, kinds: Sequence[str]) -> list[Alert]:
    """Give the alerts of a device of these kinds that are not resolved."""
    return tx.all(Alert, _find_open, device_pk=device_pk, kinds=kinds)


def page(tx: ReadSession, limit: int, before: Place | None, wanted: Filter) -> list[Alert]:
    """Give up to `limit` alerts, newest first, from before a place in that order."""
    compare: dict[str, Callable[[Any], sa.ColumnElement[bool]]] = {
        "state": alerts.c.state.__eq__,
        "kind": alerts.c.kind.__eq__,
        "severity": alerts.c.severity.__eq__,
        "device_id": lambda value: alerts.c.device_pk == _pk_of(value),
        "since": alerts.c.opened_at.__ge__,
        "until": alerts.c.opened_at.__lt__,
    }
    chosen = [compare[name](value) for name, value in wanted._asdict().items() if value is not None]
    if before is not None:
        place = sa.tuple_(sa.literal(before.opened_at, Instant), sa.literal(before.pk, sa.BigInteger))
        chosen.append(sa.tuple_(alerts.c.opened_at, alerts.c.pk) < place)
    statement = _select.where(*chosen).order_by(alerts.c.opened_at.desc(), alerts.c.pk.desc()).limit(limit)
    return tx.all(Alert, statement)


def _pk_of(device_id: str) -> sa.ScalarSelect[int]:
    return sa.select(devices.c.pk).where(devices.c.id == device_id).correlate(None).scalar_subquery()


def raise_(
    tx: WriteSession, device_pk: int, finding: Finding, now: datetime, reopen_since: datetime | None = None
) -> int:
    """Open an alert, or count it once more when one of this kind is open; give its number.

    An open alert tells the latest finding, unless that is a milder one. The newest alert of the kind is opened again
    when it is over by itself, and no longer than since `reopen_since`.
    """
    for alert in find_open(tx, device_pk, [finding.kind]):
        _count(tx, alert, finding, now)
        return alert.pk
    over = None if reopen_since is None else _find_newest_over(tx, device_pk, finding.kind, reopen_since)
    if over is not None:
        _count(tx, over, finding, now, **REOPENED)
        return over.pk
    opened = {"state": OPEN, "opened_at": now, "updated_at": now, "occurrences": 1}
    return int(
        tx.execute(_add, device_pk=device_pk, of_device_pk=device_pk, **opened, **finding._asdict()).scalar_one()
    )


def _count(tx: WriteSession, alert: Alert, finding: Finding, now: datetime, **changes: Any) -> None:
    milder = SEVERITIES.index(finding.severity) < SEVERITIES.index(alert.severity)
    told = {} if milder and alert.state != RESOLVED else finding._asdict()
    tx.execute(_change, of_pk=alert.pk, occurrences=alert.occurrences + 1, now=now, **told, **changes)


def _find_newest_over(tx: ReadSession, device_pk: int, kind: str, since: datetime) -> Alert | None:
    """Give the newest alert of a kind, if it is over by itself since a moment."""
    over = tx.one(Alert, _find_over, device_pk=device_pk, kind=kind, since=since)
    newest = tx.value(_newest, device_pk=device_pk, kind=kind)
    return over if over is not None and over.pk == newest else None


def acknowledge(tx: WriteSession, pk: int, by: str, note: str | None, now: datetime) -> None:
    """Somebody has seen it."""
    values = {"state": ACKNOWLEDGED, "acknowledged_by": by, "acknowledge_note": note}
    tx.execute(_acknowledge, of_pk=pk, now=now, **values)


def resolve(tx: WriteSession, pk: int, by: str, note: str | None, now: datetime, automatically: bool = False) -> None:
    """It is over: by itself when `automatically`, else somebody says so."""
    values = {"state": RESOLVED, "resolved_by": by, "resolve_note": note, "resolved_automatically": automatically}
    tx.execute(_resolve, of_pk=pk, now=now, **values)


def counts(tx: ReadSession, device_pk: int | None = None) -> list[tuple[str, str, int]]:
    """Count alerts that are not resolved: (kind, severity, count)."""
    statement = _counts if device_pk is None else _counts.where(alerts.c.device_pk == device_pk)
    return tx.all(lambda kind, severity, count: (kind, severity, count), statement)


def devices_by_severity(tx: ReadSession, device_pk: int | None = None) -> dict[str, int]:
    """Count devices with an alert that is not resolved, by its severity."""
    each = (_each_device if device_pk is None else _each_device.where(alerts.c.device_pk == device_pk)).subquery("some")
    statement = sa.select(each.c.severity, sa.func.count()).group_by(each.c.severity)
    return dict(tx.all(lambda severity, count: (severity, count), statement))
