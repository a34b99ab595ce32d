"""Uploads."""

from typing import Annotated, Any, Literal

from fastapi import APIRouter, Depends, Header, Query, Request, Response

from api import schemas
from api.dependencies import AnyDevice, Body, CurrentContext, ready
from api.formats import MEDIA_TYPES
from api.overload import Gate
from api.services import ingest
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
    return await gate.work(_answer, context, device_id, ingest.Chunk(session, seq, sent))


def _answer(context: Context, device_id: str, chunk: ingest.Chunk) -> Response:
    answer = ingest.receive(context, device_id, chunk)
    status = 202 if answer.chunk.state == chunks.WAITING else 200
    return Response(answer.model_dump_json(), status, media_type="application/json")
