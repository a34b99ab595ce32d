"""Uploads."""

from collections.abc import Sequence
from functools import partial
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Depends, Header, Query, Request, Response

from api import schemas
from api.batches import Another, Batches
from api.dependencies import AnyDevice, Body, CurrentContext, ready
from api.formats import MEDIA_TYPES
from api.overload import Gate
from api.services import ingest, intake
from api.services.context import Context
from storage import chunks

router = APIRouter(prefix="/devices/{device_id}/chunks", tags=["chunks"])

BODY: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {kind: {"schema": {"type": "string", "format": "binary"}} for kind in MEDIA_TYPES},
    }
}
MAX_SEQ = 2**31 - 2
AT_ONCE_ON_SQLITE, AT_ONCE = 8, 4
"""chunks in a batch at first: the first of them waits for the last, some 10 ms for each"""
GROWN = 32
"""chunks in a batch at most: on SQLite those are added that come in while another process writes"""
Uploads = Batches[intake.Arrival, Response]
Course = Literal["clockwise", "anticlockwise", "auto"]


@router.post(
    "",
    dependencies=[Depends(ready)],
    response_model=schemas.Upload,
    responses={202: {"model": schemas.Upload, "description": "Ahead of its turn: kept, and applied when it comes"}},
    openapi_extra=BODY,
)
async def upload_chunk(
    request: Request,
    device_id: AnyDevice,
    body: Body,
    context: CurrentContext,
    session: Annotated[schemas.SessionName, Query(description="Made by the device at power-up.")],
    seq: Annotated[int, Query(ge=0, le=MAX_SEQ, description="Number of the chunk in its session, from 0.")],
    course: Annotated[Course, Query(description="Sense of the course in a thesis log.")] = "auto",
    content_type: Annotated[str, Header(include_in_schema=False)] = "",
    content_encoding: Annotated[str | None, Header(description="`gzip`, `zstd` or none.")] = None,
) -> Response:
    """Upload one chunk of a log.

    200: durably stored, its effect applied exactly once. 202: ahead of its turn, durably kept. The same chunk again has
    no effect (`duplicate`). 409: another chunk has this number (`chunk-conflict`), or it comes too late, after its gap
    was declared lost (`sequence-passed`) or a newer session began (`session-ended`): do not send it again.
    """
    sent = chunks.Body(body, content_type, content_encoding, course)
    gate: Gate = request.state.gate
    uploads: Uploads = request.state.uploads
    with gate.upload():
        return await uploads.do(intake.arrival(device_id, ingest.Chunk(session, seq, sent)))


def open_uploads(context: Context) -> Uploads:
    """Start the threads that work on uploads: on SQLite, where one can write, a single one."""
    threads, most = (1, AT_ONCE_ON_SQLITE) if context.database.is_sqlite else (context.settings.upload_threads, AT_ONCE)
    return Batches(partial(_answers, context), threads, most, GROWN, "uploads")


def _answers(
    context: Context, arrivals: Sequence[intake.Arrival], another: Another[intake.Arrival]
) -> list[Response | Exception]:
    return [_answer(outcome) for outcome in intake.receive_together(context, arrivals, another)]


def _answer(outcome: intake.Outcome) -> Response | Exception:
    if isinstance(outcome, Exception):
        return outcome
    status = 202 if outcome.chunk.state == chunks.WAITING else 200
    return Response(outcome.model_dump_json(), status, media_type="application/json")
