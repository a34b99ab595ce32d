"""HTTP as uvicorn reads it, with bounds on what a connection keeps: of a request that is not whole, or is over."""

import asyncio
import logging

from uvicorn.protocols.http.httptools_impl import HttpToolsProtocol

MAX_HEAD = 256 * 1024
"""bytes of request line and headers, or of trailers, that are kept while they are not complete"""
REFUSAL = b"HTTP/1.1 431 Request Header Fields Too Large\r\ncontent-length: 0\r\nconnection: close\r\n\r\n"

log = logging.getLogger(__name__)


class BoundedProtocol(HttpToolsProtocol):
    """Ends a connection whose headers are too long or too slow; uvicorn ends those that are idle between requests."""

    HEAD_SECONDS = 60.0
    """from the first byte of a request, or from the connection, to the end of the headers"""

    _unfinished = 0
    """bytes that have not become a part of a body or a whole head"""
    _patience: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Begin a connection."""
        super().connection_made(transport)
        self._await_head()

    def connection_lost(self, exc: Exception | None) -> None:
        """End a connection."""
        self._stop_waiting()
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Take what came over the network."""
        self._unfinished += len(data)
        super().data_received(data)
        if self._unfinished > MAX_HEAD and not self.transport.is_closing():
            log.warning("a request's headers are longer than %d bytes", MAX_HEAD)
            if getattr(self.cycle, "response_complete", True):  # else it would stand inside another answer
                self.transport.write(REFUSAL)
            self.transport.close()

    def on_message_begin(self) -> None:
        """Begin a request."""
        self._unfinished = 0
        if self._patience is None:
            self._await_head()
        super().on_message_begin()

    def on_headers_complete(self) -> None:
        """Go on to the body."""
        self._unfinished = 0
        self._stop_waiting()
        super().on_headers_complete()

    def on_body(self, body: bytes) -> None:
        """Take a part of the body."""
        self._unfinished = 0
        super().on_body(body)

    def on_response_complete(self) -> None:
        """Go on to the next request; what came of a body that nobody read is not kept until then."""
        if self.cycle.response_complete:  # else it is that of a request behind this one
            self.cycle.body = bytearray()
        super().on_response_complete()

    def _await_head(self) -> None:
        self._patience = self.loop.call_later(self.HEAD_SECONDS, self.transport.close)

    def _stop_waiting(self) -> None:
        if self._patience is not None:
            self._patience.cancel()
            self._patience = None
