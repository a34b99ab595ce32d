"""Devices."""

from typing import Annotated

from fastapi import APIRouter, Depends, Query

from api import schemas
from api.dependencies import CurrentContext, Cursor, Installer, KnownId, Limit, Requires
from api.services import fleet, paging, presenting
from api.services.access import Role
from storage import device_lists
from storage.device_lists import Filter

router = APIRouter(prefix="/devices", tags=["devices"], dependencies=[Depends(Requires(Role.INSTALLER))])


@router.post("", status_code=201)
def register_device(
    draft: schemas.DeviceDraft, principal: Installer, context: CurrentContext
) -> schemas.RegisteredDevice:
    """Register a device. Its key is shown only in this answer."""
    return fleet.register(context, draft, principal)


@router.get("")
def list_devices(
    context: CurrentContext,
    q: Annotated[
        schemas.Words | None, Query(description="Found in id, name, vehicle or notes (their first 1000 characters).")
    ] = None,
    stage: schemas.StageName | None = None,
    has_open_alert: bool | None = None,
    alert_kind: Annotated[schemas.AlertKind | None, Query(description="With an open alert of this kind.")] = None,
    alert_severity: Annotated[
        schemas.Severity | None, Query(description="With an open alert of this severity; of that kind, if both.")
    ] = None,
    mount_status: Annotated[schemas.CurrentMountStatus | None, Query(description="With a mounting that is so.")] = None,
    sort: Annotated[
        schemas.DeviceOrder,
        Query(description="`-` turns the order round; a device that never sent data comes last either way."),
    ] = "id",
    cursor: Cursor = None,
    limit: Limit = 100,
) -> schemas.Page[schemas.Device]:
    """List devices, by their ids unless another order is asked for; names are compared without regard to case."""
    after = None if cursor is None else paging.decode_place_in(sort, cursor)
    wanted = Filter(q, stage, has_open_alert, alert_kind, alert_severity, mount_status)
    with context.database.read() as tx:
        rows = device_lists.page(tx, limit + 1, after, wanted, sort)
    return paging.page(rows, limit, lambda row: paging.place_in(sort, row), presenting.device)


@router.get("/{device_id}")
def read_device(device_id: KnownId, context: CurrentContext) -> schemas.Device:
    """Read a device."""
    return fleet.find(context, device_id)


@router.patch("/{device_id}")
def edit_device(
    device_id: KnownId, patch: schemas.DevicePatch, principal: Installer, context: CurrentContext
) -> schemas.Device:
    """Change what is known of a device; what is left out stays, null clears it.

    A calibration tells on the chunks applied from then on. A mounting found with other readings may be off by what the
    calibration corrects: restart the installation afterwards.
    """
    return fleet.edit(context, device_id, patch.model_dump(exclude_unset=True), principal)


@router.delete("/{device_id}", status_code=204)
def remove_device(device_id: KnownId, principal: Installer, context: CurrentContext) -> None:
    """Remove a device with its key, its history and its alerts."""
    fleet.remove(context, device_id, principal)


@router.post("/{device_id}/key")
def rotate_device_key(device_id: KnownId, principal: Installer, context: CurrentContext) -> schemas.RegisteredDevice:
    """Make a new key for a device, shown only in this answer. Every key it had is revoked at once."""
    return fleet.rotate_key(context, device_id, principal)
