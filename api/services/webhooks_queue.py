"""What is told to webhooks, written in the transaction it tells about; `webhooks_dispatch` sends it."""

import json
import secrets
from collections.abc import Mapping
from datetime import datetime, timedelta
from typing import Any

from api.services import presenting
from storage import alerts, deliveries, webhooks
from storage.database import WriteSession

MINUTE, HOUR = 60.0, 3600.0
SCHEDULE = (5.0, 5 * MINUTE, 30 * MINUTE, 2 * HOUR, 5 * HOUR, 10 * HOUR, 14 * HOUR, 20 * HOUR, 24 * HOUR)
"""s from one attempt to the next, as Standard Webhooks has them; the first attempt is made at once"""
SPAN = timedelta(seconds=sum(SCHEDULE))
"""How long a delivery is tried."""
TEST = "test"


def alert_changed(tx: WriteSession, alert: alerts.Alert, now: datetime, is_opened: bool) -> None:
    """Store a delivery for every webhook that wants to know of this alert."""
    wanting = [webhook for webhook in webhooks.hold_active(tx) if webhook.wants(alert.kind, alert.severity)]
    if wanting:
        kind = event_type(alert, is_opened)
        payload = message(kind, presenting.alert(alert).model_dump(mode="json"), now)
        rows = [delivery(webhook.pk, kind, payload, now) | {"device_id": alert.device_id} for webhook in wanting]
        deliveries.add(tx, rows)


def event_type(alert: alerts.Alert, is_opened: bool = False) -> str:
    """Tell what has just happened to an alert; one that is opened again is told as opened, since its end was told."""
    if alert.state == alerts.RESOLVED:
        return "alert.resolved"
    if alert.state == alerts.ACKNOWLEDGED and alert.acknowledged_at == alert.updated_at:
        return "alert.acknowledged"
    is_new = alert.occurrences == 1 and alert.opened_at == alert.updated_at
    return "alert.opened" if is_opened or is_new else "alert.updated"


def message(kind: str, data: Mapping[str, Any], now: datetime) -> str:
    """Give the body of a delivery."""
    return json.dumps({"type": kind, "timestamp": now.isoformat().replace("+00:00", "Z"), "data": data})


def delivery(webhook_pk: int, kind: str, payload: str, now: datetime) -> dict[str, Any]:
    """Give the row of a delivery that is due now."""
    return {
        "webhook_pk": webhook_pk,
        "message_id": f"msg_{secrets.token_hex(16)}",
        "type": kind,
        "device_id": None,
        "payload": payload,
        "state": deliveries.PENDING,
        "attempts": 0,
        "claims": 0,
        "created_at": now,
        "next_attempt_at": now,
        "give_up_at": now + SPAN,
    }
