"""One line in the log and one count for every request; plain ASGI, so that streams pass through untouched."""

import logging
import re
import secrets
import time

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from api import logs, metrics
from api.schemas import DEVICE_ID
from api.services.access import KEY_PREFIX

HEADER = b"x-request-id"
SOUND = re.compile(rb"[A-Za-z0-9._-]{1,64}")
METHODS = frozenset({"GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS"})
BASE = "/api/v1"
ELSEWHERE = "other"
"""the route of the page, of its files, and of what does not exist"""
QUIET = frozenset({"/healthz", "/readyz", "/metrics"})
"""asked for every few seconds by machines: told at level DEBUG"""

log = logging.getLogger(logs.ACCESS)


class Observing:
    """Gives every request an id, and tells how it went."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        request_id = _request_id(scope)
        token = logs.REQUEST_ID.set(request_id)
        begun = time.perf_counter()
        status = 500

        async def send_with_id(message: Message) -> None:
            nonlocal status
            if message["type"] == "http.response.start":
                status = message["status"]
                message["headers"] = [*message.get("headers", ()), (HEADER, request_id.encode())]
            await send(message)

        try:
            await self.app(scope, receive, send_with_id)
        finally:
            _tell(scope, status, time.perf_counter() - begun)
            logs.REQUEST_ID.reset(token)


def _request_id(scope: Scope) -> str:
    given = next((value for name, value in scope["headers"] if name == HEADER), b"")
    return given.decode() if SOUND.fullmatch(given) else secrets.token_hex(16)


def _tell(scope: Scope, status: int, seconds: float) -> None:
    method = scope["method"] if scope["method"] in METHODS else ELSEWHERE
    route = _route(scope)
    metrics.REQUESTS.labels(method, route, str(status)).inc()
    metrics.DURATION.labels(route).observe(seconds)
    line = {"method": method, "route": route, "status": status, "duration_ms": round(seconds * 1000, 1)}
    device_id = _device(scope)
    if device_id is not None:
        line["device_id"] = device_id
    log.log(logging.DEBUG if route in QUIET else logging.INFO, "request", extra=line)


def _route(scope: Scope) -> str:
    """Give the template of the path, which inside the API is told without the base."""
    template: str = getattr(scope.get("route"), "path", ELSEWHERE)
    inside = template != ELSEWHERE and scope["path"].startswith(BASE) and not template.startswith(BASE)
    return BASE + template if inside else template


def _device(scope: Scope) -> str | None:
    """Give the device a request is about, unless what stands there may be a key put in the wrong place."""
    device_id = str(scope.get("path_params", {}).get("device_id", ""))
    if not re.fullmatch(DEVICE_ID, device_id) or device_id.startswith(KEY_PREFIX):
        return None
    return device_id
