"""The installation of a device: where it stands, its history, its mountings."""

from datetime import timedelta
from typing import Annotated, Any

from fastapi import APIRouter, Header, Path, Query, Response
from pydantic import AwareDatetime

from api import schemas
from api.dependencies import AnyDevice, BeforeNumber, CurrentContext, Installer, Limit
from api.services import fleet, history, paging, presenting, reception
from api.services.errors import NotFoundError
from storage import mounts

router = APIRouter(prefix="/devices/{device_id}", tags=["installation"])

Number = Annotated[int, Path(ge=1, le=2**31 - 1, description="Number of the mounting, from 1.")]


IfNoneMatch = Annotated[str | None, Header()]


@router.get("/installation", responses={304: {"description": "Not modified: nothing has changed since the ETag"}})
def read_installation(
    device_id: AnyDevice, context: CurrentContext, response: Response, if_none_match: IfNoneMatch = None
) -> schemas.Installation:
    """Tell where the installation stands and what is missing."""
    tag, shown = fleet.read_installation(context, device_id, _tags(if_none_match))
    response.headers.update(_caching(tag))
    return _not_modified(tag) if shown is None else shown


@router.post("/installation/restart")
def restart_installation(principal: Installer, device_id: AnyDevice, context: CurrentContext) -> schemas.Installation:
    """Begin anew after a deliberate refit: the mounting is forgotten, the history kept."""
    return fleet.restart(context, device_id, principal)


@router.post("/installation/level")
def level_installation(principal: Installer, device_id: AnyDevice, context: CurrentContext) -> schemas.Installation:
    """Take it that the vehicle stands on level ground now: gravity then shows how the device is tilted.

    409 `not-still`: the device's last data do not show it standing still, or are not new enough to tell.
    """
    return fleet.level_start(context, device_id, principal)


@router.get("/estimates")
def read_estimates(
    device_id: AnyDevice,
    context: CurrentContext,
    start: Annotated[AwareDatetime | None, Query(alias="from", description="RFC 3339.")] = None,
    end: Annotated[AwareDatetime | None, Query(alias="to", description="RFC 3339.")] = None,
    max_points: Annotated[int, Query(ge=2, le=10_000, description="Rows at most.")] = 1000,
) -> schemas.Estimates:
    """Give the angle history, thinned: first, last and changes of stage are kept."""
    with context.database.read() as tx:
        return history.read(tx, fleet.number(tx, device_id), start, end, max_points)


@router.get("/health")
def read_health(
    device_id: AnyDevice,
    context: CurrentContext,
    hours: Annotated[int, Query(ge=1, le=720, description="Length of the period that ends now, h.")] = 24,
) -> schemas.Reception:
    """Tell what became of the data of the last hours: what came in, what was not used, what was lost."""
    until = context.clock()
    since = until - min(timedelta(hours=hours), timedelta(days=context.settings.receipt_days))
    with context.database.read() as tx:
        return reception.read(tx, fleet.number(tx, device_id), since, until)


@router.get("/mounts")
def list_mounts(
    device_id: AnyDevice, context: CurrentContext, before: BeforeNumber, limit: Limit = 100
) -> schemas.Page[schemas.Mount]:
    """List the confirmed mountings, newest first."""
    with context.database.read() as tx:
        rows = mounts.page(tx, fleet.number(tx, device_id), limit + 1, before)
    return paging.page(rows, limit, lambda row: row.n, presenting.mount)


@router.get("/mounts/{n}")
def read_mount(device_id: AnyDevice, n: Number, context: CurrentContext) -> schemas.Mount:
    """Read a confirmed mounting."""
    with context.database.read() as tx:
        row = mounts.find(tx, fleet.number(tx, device_id), n)
    return presenting.mount(_found(row, "There is no such mounting."))


@router.get("/mount", responses={304: {"description": "Not modified: the mounting is the one of the ETag"}})
def read_current_mount(
    device_id: AnyDevice,
    context: CurrentContext,
    response: Response,
    if_none_match: IfNoneMatch = None,
) -> schemas.Mount:
    """Give the mounting in force; still readable, and marked, when it is suspect."""
    with context.database.read() as tx:
        row = _found(mounts.current(tx, fleet.number(tx, device_id)), "No mounting is confirmed yet.")
    tag = f'"{row.n}-{row.status}"'
    response.headers.update(_caching(tag))
    return _not_modified(tag) if tag in _tags(if_none_match) else presenting.mount(row)


def _caching(tag: str) -> dict[str, str]:
    return {"ETag": tag, "Cache-Control": "no-cache"}


def _not_modified(tag: str) -> Any:
    return Response(status_code=304, headers=_caching(tag))


def _tags(if_none_match: str | None) -> list[str]:
    return [tag.strip().removeprefix("W/") for tag in (if_none_match or "").split(",")]


def _found(row: mounts.Mount | None, otherwise: str) -> mounts.Mount:
    if row is None:
        raise NotFoundError(otherwise)
    return row
