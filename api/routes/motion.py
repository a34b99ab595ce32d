"""Motion of a device's vehicle: what happened, how it moved, and the samples it is computed from."""

from datetime import datetime
from typing import Annotated, Any

from fastapi import APIRouter, Header, Path, Query, Request
from fastapi.responses import StreamingResponse
from pydantic import AwareDatetime

from api import schemas
from api.dependencies import AnyDevice, BeforePlace, CurrentContext, Limit
from api.overload import Gate
from api.services import fleet, happenings, kept_samples, motion, paging
from api.services.errors import NotFoundError
from storage import motion_events

router = APIRouter(prefix="/devices/{device_id}", tags=["motion"])

Number = Annotated[int, Path(ge=1, le=2**63 - 1)]
From = Annotated[AwareDatetime | None, Query(alias="from", description="RFC 3339.")]
To = Annotated[AwareDatetime | None, Query(alias="to", description="RFC 3339.")]

ARROW, CSV = "application/vnd.apache.arrow.stream", "text/csv"
MEDIA_TYPES: dict[schemas.RawFormat, str] = {"arrow": ARROW, "csv": CSV}
RAW: dict[int | str, dict[str, Any]] = {
    200: {"content": {kind: {"schema": {"type": "string", "format": "binary"}} for kind in (CSV, ARROW)}}
}


@router.get("/events")
def list_events(
    device_id: AnyDevice,
    context: CurrentContext,
    before: BeforePlace,
    start: From = None,
    end: To = None,
    kind: schemas.MotionEventKind | None = None,
    limit: Limit = 100,
) -> schemas.Page[schemas.MotionEvent]:
    """List what happened to the vehicle while a mounting was in force, newest first."""
    wanted = motion_events.Filter(start, end, kind)
    place = None if before is None else motion_events.Place(*before)
    with context.database.read() as tx:
        rows = motion_events.page(tx, fleet.number(tx, device_id), limit + 1, place, wanted)
    return paging.page(rows, limit, lambda row: paging.place(row.at, row.pk), happenings.present)


@router.get("/events/{event_id}")
def read_event(device_id: AnyDevice, event_id: Number, context: CurrentContext) -> schemas.MotionEvent:
    """Read one of them."""
    with context.database.read() as tx:
        row = motion_events.find(tx, fleet.number(tx, device_id), event_id)
    if row is None:
        raise NotFoundError("There is no such event.")
    return happenings.present(row)


@router.get("/motion")
def read_motion(
    request: Request,
    device_id: AnyDevice,
    context: CurrentContext,
    start: From = None,
    end: To = None,
    max_points: Annotated[int, Query(ge=2, le=10_000, description="Rows at most.")] = 1000,
) -> schemas.Motion:
    """Compute how the vehicle moved, from the samples kept, under the mounting that was in force then.

    The last 10 minutes of data where no period is named, 6 hours at most (422 `span-too-long`). Of more rows than asked
    for those with the largest acceleration on the plan are given. Where no samples are kept, or no mounting was in
    force (`mount` is null), the columns are empty. 503 when the process computes as much as it can.
    """
    gate: Gate = request.state.gate
    with gate.computation():
        return motion.read(context, device_id, start, end, max_points)


@router.get("/raw", response_class=StreamingResponse, responses=RAW)
def read_raw(
    device_id: AnyDevice,
    context: CurrentContext,
    start: From = None,
    end: To = None,
    session: Annotated[schemas.SessionName | None, Query(description="Needed where there are several.")] = None,
    form: Annotated[
        schemas.RawFormat | None, Query(alias="format", description="Goes before `Accept`; `csv` if neither is said.")
    ] = None,
    accept: Annotated[str, Header(include_in_schema=False)] = "",
) -> StreamingResponse:
    """Give back the samples of one session as they were sent, as a log that the upload takes: native CSV or Arrow.

    `Livella-Session` and `Livella-Session-Started-At` of the answer name the session and the zero of its clock. 409
    `several-sessions` where the period has samples of several and none is named; the sentence names them.
    """
    with context.database.read() as tx:
        span = kept_samples.find(tx, fleet.number(tx, device_id), start, end, session)
    chosen: schemas.RawFormat = form or ("arrow" if ARROW in accept else "csv")
    headers = {
        "Livella-Session": span.stretch.session,
        "Livella-Session-Started-At": _rfc3339(span.stretch.started_at),
        "Vary": "Accept",
    }
    return StreamingResponse(
        kept_samples.stream(context, span, chosen), media_type=MEDIA_TYPES[chosen], headers=headers
    )


def _rfc3339(moment: datetime) -> str:
    return moment.isoformat().replace("+00:00", "Z")
