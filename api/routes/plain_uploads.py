"""Uploads as devices send them, answered with less detour than FastAPI takes: it costs as much as the rest of HTTP.

A request that is in any way unusual is left to the route it declares in `chunks`, and so is telling what is wrong with
one. What happens here is what that route declares, in the same order: the functions are the same.
"""

import re
from typing import NamedTuple

from anyio import to_thread
from fastapi import Request
from fastapi.security import HTTPAuthorizationCredentials
from starlette.datastructures import URLPath
from starlette.routing import BaseRoute, Match, NoMatchFound
from starlette.types import Receive, Scope, Send

from api.dependencies import get_principal, own_device, read_body, ready
from api.routes.chunks import Course, upload_chunk
from api.services.context import Context

PATH = "/api/v1/devices/{device_id}/chunks"
_path = re.compile(r"/api/v1/devices/([A-Za-z0-9][A-Za-z0-9._:-]{0,63})/chunks").fullmatch
_query = re.compile(
    rb"session=([A-Za-z0-9._~:-]{1,128})&seq=(0|[1-9][0-9]{0,8})(?:&course=(clockwise|anticlockwise|auto))?"
).fullmatch
_bearer = re.compile(rb"Bearer ([!-~]+)").fullmatch
COURSES: dict[bytes | None, Course] = {
    None: "auto",
    b"auto": "auto",
    b"clockwise": "clockwise",
    b"anticlockwise": "anticlockwise",
}
FOUND = "plain_upload"
"""where a request's scope keeps what was found in it"""


class Found(NamedTuple):
    """What a plain request says beside its body."""

    device_id: str
    key: str
    session: str
    seq: int
    course: Course
    content_type: str
    content_encoding: str | None


def find(scope: Scope) -> Found | None:
    """Read a request; None when it is no upload, or not a plain one."""
    if scope["type"] != "http" or scope["method"] != "POST":
        return None
    path, query = _path(scope["path"]), _query(scope["query_string"])
    headers: dict[bytes, bytes] = dict(scope["headers"])
    bearer = _bearer(headers.get(b"authorization", b""))
    if path is None or query is None or bearer is None or len(headers) < len(scope["headers"]):
        return None
    encoding = headers.get(b"content-encoding")
    return Found(
        path[1],
        bearer[1].decode(),
        query[1].decode(),
        int(query[2]),
        COURSES[query[3]],
        headers.get(b"content-type", b"").decode("latin-1"),
        None if encoding is None else encoding.decode("latin-1"),
    )


class PlainUploads(BaseRoute):
    """The route; put before all others."""

    path = PATH

    def matches(self, scope: Scope) -> tuple[Match, Scope]:
        """Take plain uploads only."""
        found = find(scope)
        if found is None:
            return Match.NONE, {}
        told = {"route": self, "endpoint": upload_chunk, "path_params": {"device_id": found.device_id}}
        return Match.FULL, {**told, FOUND: found}

    def url_path_for(self, name: str, /, **path_params: str) -> URLPath:
        """Leave names to the declared route."""
        raise NoMatchFound(name, path_params)

    async def handle(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer an upload."""
        found: Found = scope[FOUND]
        request = Request(scope, receive, send)
        context: Context = request.state.context
        await ready(request)
        bearer = HTTPAuthorizationCredentials(scheme="Bearer", credentials=found.key)
        if context.database.is_sqlite:  # the way to a thread and back is longer than this look into a file
            principal = get_principal(request, context, bearer, None)
        else:
            principal = await to_thread.run_sync(get_principal, request, context, bearer, None)
        device_id = await own_device(found.device_id, principal)
        body = await read_body(request, context, device_id)
        response = await upload_chunk(request, device_id, body, context, *found[2:])
        await response(scope, receive, send)
