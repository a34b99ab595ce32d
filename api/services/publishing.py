"""What the live stream and webhooks are told, written in the transaction it tells about."""

from datetime import datetime
from typing import Literal

import core
from api import schemas
from api.services import presenting, webhooks_queue
from storage import alerts, devices, events, installations
from storage.database import ReadSession, WriteSession


def show(
    tx: ReadSession, row: installations.Installation, device_id: str, params: core.Parameters
) -> schemas.Installation:
    """Give the installation resource of a row."""
    return presenting.installation(row, device_id, installations.beside(tx, row), params)


def installation_changed(tx: WriteSession, shown: schemas.Installation, now: datetime) -> None:
    """Tell how an installation stands."""
    events.add(tx, shown.device_id, "installation", shown.model_dump_json(), now)


def installation_touched(
    tx: WriteSession, row: installations.Installation, device_id: str, params: core.Parameters, now: datetime
) -> None:
    """Something shown with the installation has changed: raise its revision and tell."""
    installations.touch(tx, row.device_pk)
    installation_changed(tx, show(tx, row._replace(revision=row.revision + 1), device_id, params), now)


def alert_changed(tx: WriteSession, pk: int, now: datetime, is_opened: bool = False) -> None:
    """Tell how an alert stands, to the live stream and to webhooks; `is_opened`: just now, perhaps again."""
    row = alerts.find(tx, pk)
    if row is not None:
        events.add(tx, row.device_id, "alert", presenting.alert(row).model_dump_json(), now)
        webhooks_queue.alert_changed(tx, row, now, is_opened)


def device_changed(
    tx: WriteSession, device_id: str, change: Literal["registered", "edited"], now: datetime
) -> schemas.Device:
    """Tell that a device came or was edited; give it as it is now."""
    row = devices.find(tx, device_id)
    if row is None:
        raise LookupError(f"device {device_id} is not there")
    shown = presenting.device(row)
    _tell(tx, schemas.DeviceChange(device_id=device_id, change=change, device=shown), now)
    return shown


def device_removed(tx: WriteSession, device_id: str, now: datetime) -> None:
    """Tell that a device went."""
    _tell(tx, schemas.DeviceChange(device_id=device_id, change="removed", device=None), now)


def _tell(tx: WriteSession, change: schemas.DeviceChange, now: datetime) -> None:
    events.add(tx, change.device_id, "device", change.model_dump_json(), now)
