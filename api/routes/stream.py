"""The live stream."""

import time
from collections.abc import AsyncIterator
from typing import Annotated, Any

from anyio import to_thread
from fastapi import APIRouter, Header
from fastapi.sse import EventSourceResponse, ServerSentEvent

from api import schemas
from api.dependencies import Caller, CurrentContext, CurrentHub
from api.services import sign_ins
from api.services.access import Principal, Role
from api.services.context import Context
from storage import events
from storage.events import Event, Position

router = APIRouter(prefix="/stream", tags=["stream"])

RETRY_MS = 2000
"""ms a browser waits before it connects again"""
CHECK_INTERVAL = 30.0
"""s between two looks whether the listener's key, and sign-in, still hold"""


@router.get("", response_class=EventSourceResponse)
async def stream(
    principal: Caller,
    context: CurrentContext,
    hub: CurrentHub,
    last_event_id: Annotated[str | None, Header(description="Resume after this event.")] = None,
) -> AsyncIterator[schemas.Installation | schemas.Alert | schemas.DeviceChange]:
    """Follow what happens, as server-sent events `installation`, `alert` and `device`.

    A device sees itself; alerts are for managers. `reset` says that events were missed which are kept no longer: read
    everything anew. Events before the connection are not told, except when it resumes.
    """
    start = Position.parse(last_event_id or "")
    if last_event_id and (start is None or await to_thread.run_sync(_is_lost, context, start)):
        start = None
        yield _message(event="reset", data={})
    async with hub.listening() as now:
        start = start or now
        yield _message(comment="connected", id=str(start), retry=RETRY_MS)
        checked = time.monotonic()
        async for batch in hub.follow(start):
            if time.monotonic() - checked > CHECK_INTERVAL:
                checked = time.monotonic()
                if not await to_thread.run_sync(sign_ins.is_valid, context, principal):
                    return
            for event in batch:
                if _may_see(principal, event):
                    yield _message(raw_data=event.data, event=event.type, id=str(event.position))


def _message(**fields: Any) -> Any:
    """Make a message; untyped because the annotation of `stream` names the data in it, for the API's description."""
    return ServerSentEvent(**fields)


def _is_lost(context: Context, position: Position) -> bool:
    with context.database.read() as tx:
        return position < events.pruned(tx)


def _may_see(principal: Principal, event: Event) -> bool:
    if event.type == "alert":
        return principal.role >= Role.MANAGER
    return principal.role > Role.DEVICE or event.device_id == principal.device_id
