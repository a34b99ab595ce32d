"""Devices: register, list, edit, remove; the counts over all of them."""

import secrets
from collections.abc import Collection
from datetime import datetime
from typing import Any

from sqlalchemy.exc import IntegrityError

from api import schemas
from api.services import auditing, keyring, presenting, publishing
from api.services.access import Principal, Role
from api.services.calibration import STAGES, Calibration
from api.services.context import Context
from api.services.errors import UNKNOWN_DEVICE, ConflictError, NotFoundError
from api.services.rules import device_silent
from core import Stage, initial_state, status
from storage import alerts, devices, installations, mounts
from storage.database import ReadSession, WriteSession


def register(
    context: Context, draft: schemas.DeviceDraft, principal: Principal = auditing.SERVICE
) -> schemas.RegisteredDevice:
    """Register a device and make its key."""
    device_id = draft.id or f"dev-{secrets.token_hex(6)}"
    try:
        with context.database.write() as tx:
            made = _add(tx, context, principal, device_id, draft)
    except IntegrityError as error:
        raise ConflictError(f"There is a device {device_id} already.") from error
    context.wake()
    return made


def _add(
    tx: WriteSession, context: Context, principal: Principal, device_id: str, draft: schemas.DeviceDraft
) -> schemas.RegisteredDevice:
    now = context.clock()
    pk = devices.add(tx, device_id, draft.model_dump(exclude={"id"}), now)
    installations.add(tx, _fresh(context, pk, now))
    _, key = keyring.make(tx, principal, keyring.Wanted(Role.DEVICE.word, device_id), now, pk)
    auditing.record(tx, principal, "device.register", target(device_id), {"name": draft.name}, now)
    return schemas.RegisteredDevice(device=publishing.device_changed(tx, device_id, "registered", now), key=key)


def target(device_id: str) -> str:
    """Name a device in the audit trail."""
    return f"devices/{device_id}"


def _fresh(context: Context, device_pk: int, now: datetime) -> installations.Installation:
    """Give the installation of a device that has sent nothing yet."""
    shown = presenting.status(status(context.params, initial_state(context.params)))
    return installations.Installation(
        device_pk, None, None, Stage.WAITING.word, None, None, now, shown, last_data_at=None, revision=0
    )


def find(context: Context, device_id: str) -> schemas.Device:
    """Give a device."""
    with context.database.read() as tx:
        row = devices.find(tx, device_id)
    if row is None:
        raise NotFoundError(UNKNOWN_DEVICE)
    return presenting.device(row)


def edit(context: Context, device_id: str, changes: dict[str, Any], principal: Principal) -> schemas.Device:
    """Change the texts of a device, or the calibration of its accelerometer for the chunks still to be applied."""
    now = context.clock()
    with context.database.write() as tx:
        devices.edit(tx, locked(tx, device_id), changes)
        auditing.record(tx, principal, "device.edit", target(device_id), changes, now)
        device = publishing.device_changed(tx, device_id, "edited", now)
    context.wake()
    return device


def remove(context: Context, device_id: str, principal: Principal) -> None:
    """Remove a device with its key, its history and its alerts."""
    now = context.clock()
    with context.database.write() as tx:
        devices.remove(tx, locked(tx, device_id))
        auditing.record(tx, principal, "device.remove", target(device_id), None, now)
        publishing.device_removed(tx, device_id, now)
    context.wake()


def rotate_key(context: Context, device_id: str, principal: Principal) -> schemas.RegisteredDevice:
    """Make a new key for a device; what it had is revoked."""
    now = context.clock()
    with context.database.write() as tx:
        key = keyring.replace_of_device(tx, principal, locked(tx, device_id), device_id, now)
        auditing.record(tx, principal, "device.rotate_key", target(device_id), None, now)
        row = devices.find(tx, device_id)
    if row is None:
        raise NotFoundError(UNKNOWN_DEVICE)
    return schemas.RegisteredDevice(device=presenting.device(row), key=key)


def locked(tx: WriteSession, device_id: str) -> int:
    """Lock a device and give its number."""
    row = installations.lock(tx, device_id)
    if row is None:
        raise NotFoundError(UNKNOWN_DEVICE)
    return row.device_pk


def number(tx: ReadSession, device_id: str) -> int:
    """Give the number of a device."""
    pk = devices.exists(tx, device_id)
    if pk is None:
        raise NotFoundError(UNKNOWN_DEVICE)
    return pk


def read_installation(
    context: Context, device_id: str, known: Collection[str] = ()
) -> tuple[str, schemas.Installation | None]:
    """Give the tag and the installation of a device; None when its tag is one of those that are known."""
    with context.database.read() as tx:
        row = installations.find(tx, device_id)
        if row is None:
            raise NotFoundError(UNKNOWN_DEVICE)
        tag = f'"{row.device_pk}-{row.revision}"'
        return tag, None if tag in known else publishing.show(tx, row, device_id, context.params)


def restart(context: Context, device_id: str, principal: Principal) -> schemas.Installation:
    """Begin the calibration of a refitted device anew."""
    with context.database.write() as tx:
        calibration = Calibration.open(tx, context, device_id)
        calibration.restart()
        calibration.save()
        auditing.record(tx, principal, "installation.restart", target(device_id), None, calibration.now)
        shown = calibration.shown()
    context.wake()
    return shown


def level_start(context: Context, device_id: str, principal: Principal) -> schemas.Installation:
    """Take it from an installer that the vehicle stands on level ground."""
    with context.database.write() as tx:
        calibration = Calibration.open(tx, context, device_id)
        calibration.level_start()
        calibration.save()
        auditing.record(tx, principal, "installation.level", target(device_id), None, calibration.now)
        shown = calibration.shown()
    context.wake()
    return shown


def summary(context: Context, principal: Principal) -> schemas.FleetSummary:
    """Count devices by stage and open alerts by kind and severity; a device counts itself alone."""
    with context.database.read() as tx:
        stages = devices.stages(tx, principal.device_pk)
        counts = alerts.counts(tx, principal.device_pk)
        severities = alerts.devices_by_severity(tx, principal.device_pk)
        suspect = mounts.suspects(tx, principal.device_pk)
    by_kind: dict[str, dict[str, int]] = {}
    for kind, severity, count in counts:
        by_kind.setdefault(kind, {})[severity] = count
    return schemas.FleetSummary.model_validate(
        {
            "devices": sum(stages.values()),
            "stages": {stage: stages.get(stage, 0) for stage in STAGES},
            "open_alerts": sum(count for _, _, count in counts),
            "alerts": by_kind,
            "severities": {severity: severities.get(severity, 0) for severity in alerts.SEVERITIES},
            "silent": sum(by_kind.get(device_silent.KIND, {}).values()),  # a device has one of a kind at most
            "suspect": suspect,
        }
    )
