"""What one process takes on at once: bodies in memory, uploads in work. More is refused at once, before it is read."""

import asyncio
import re
import secrets
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import NoReturn

from starlette.exceptions import HTTPException
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from api import errors, metrics
from api.settings import Settings

UPLOAD = re.compile(r"/api/v1/devices/[^/]+/chunks")
MAX_OTHER_BYTES = 1024 * 1024
"""of a body that is no chunk"""
MAX_HEADER_BYTES = 32 * 1024
MOST_COMPUTATIONS = 2
"""at once, of motion: uploads need the processor too"""
LONGEST_RETRY = 5
"""s at most until a refused upload is worth another try; at random, so that not all come back at once"""
WORDS = "The service has more work than it can take on; try again after the time in Retry-After."


class Gate:
    """The work of one process."""

    def __init__(self, settings: Settings) -> None:
        self.settings = settings
        self.uploads = 0
        self.held = 0
        self._computations = threading.BoundedSemaphore(MOST_COMPUTATIONS)

    @property
    def is_full(self) -> bool:
        """True when no upload more is taken on."""
        return self.uploads >= self.settings.max_uploads

    @contextmanager
    def upload(self) -> Iterator[None]:
        """Count an upload in work or waiting; refuse one that is too many."""
        if self.is_full:
            refuse("uploads")
        self.uploads += 1
        metrics.QUEUE.inc()
        try:
            yield
        finally:
            self.uploads -= 1
            metrics.QUEUE.dec()

    @contextmanager
    def computation(self) -> Iterator[None]:
        """Count an answer that takes much to compute, in a thread of its own; refuse one that is too many."""
        if not self._computations.acquire(blocking=False):
            refuse("computations")
        try:
            yield
        finally:
            self._computations.release()

    def has_room(self, size: int, own: int = 0) -> bool:
        """Tell whether so many bytes more may be held by a body that has `own`; a body alone always may."""
        return self.held == own or self.held + size <= self.settings.max_inflight_bytes


class Body:
    """The bytes of one request."""

    def __init__(self, gate: Gate) -> None:
        self.gate = gate
        self.received = 0
        self.held = 0

    def hold(self, size: int) -> None:
        """Count so many bytes more."""
        if size == 0:
            return
        self.held += size
        self.gate.held += size
        metrics.BODIES.inc(size)

    def release(self) -> None:
        """The request is answered."""
        self.hold(-self.held)

    def arrived(self, size: int, limit: int) -> None:
        """Count a part; refuse what is too much for the limit or for the memory."""
        self.received += size
        if self.received > limit:
            raise HTTPException(413, f"A body may have at most {limit} bytes here.")
        more = self.received - self.held
        if more > 0:
            if not self.gate.has_room(more, self.held):
                refuse("bytes")
            self.hold(more)


class Limits:
    """Refuse what is too large, too slow or too much; every answer is one of ours."""

    def __init__(self, app: ASGIApp, gate: Gate) -> None:
        self.app = app
        self.gate = gate

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        is_upload = UPLOAD.fullmatch(scope["path"]) is not None
        stated, limit = _stated(scope), MAX_OTHER_BYTES
        if is_upload:  # the route tells what is too large, to those who may send one
            limit = sys.maxsize
            stated = min(stated, self.gate.settings.max_chunk_bytes)
        try:
            self._check(scope, stated, limit, is_upload)
        except HTTPException as error:
            await errors.of_http(error)(scope, receive, send)
            return
        body = Body(self.gate)
        body.hold(stated)
        try:
            await self.app(scope, self._counted(receive, body, limit), send)
        finally:
            body.release()

    def _check(self, scope: Scope, stated: int, limit: int, is_upload: bool) -> None:
        if sum(len(name) + len(value) for name, value in scope["headers"]) > MAX_HEADER_BYTES:
            raise HTTPException(431, f"Headers may have at most {MAX_HEADER_BYTES} bytes.")
        if stated > limit:
            raise HTTPException(413, f"A body may have at most {limit} bytes here.", {"Connection": "close"})
        if stated and not self.gate.has_room(stated):
            refuse("bytes")
        if is_upload and self.gate.is_full:
            refuse("uploads")

    def _counted(self, receive: Receive, body: Body, limit: int) -> Receive:
        deadline = asyncio.get_running_loop().time() + self.gate.settings.body_timeout
        complete = False

        async def counted() -> Message:
            nonlocal complete
            if complete:
                return await receive()
            try:
                async with asyncio.timeout_at(deadline):
                    message = await receive()
            except TimeoutError:
                raise HTTPException(408, "The body took too long to arrive.", {"Connection": "close"}) from None
            body.arrived(len(message.get("body", b"")), limit)
            complete = not message.get("more_body", False)
            return message

        return counted


def _stated(scope: Scope) -> int:
    """Give the bytes a body will have, 0 when that is not said."""
    length = next((value for name, value in scope["headers"] if name == b"content-length"), b"")
    return int(length) if length.isdigit() else 0


def refuse(limit: str) -> NoReturn:
    """Refuse a request that is one too many."""
    metrics.OVERLOADED.labels(limit).inc()
    raise HTTPException(503, WORDS, {"Retry-After": str(1 + secrets.randbelow(LONGEST_RETRY))})
