"""HTTP as uvicorn reads it, with a bound on what comes before the body: httptools has none."""

import logging

from uvicorn.protocols.http.httptools_impl import HttpToolsProtocol

MAX_HEAD = 256 * 1024
"""bytes of request line and headers that are kept while they are not complete"""
REFUSAL = b"HTTP/1.1 431 Request Header Fields Too Large\r\ncontent-length: 0\r\nconnection: close\r\n\r\n"

log = logging.getLogger(__name__)


class BoundedProtocol(HttpToolsProtocol):
    """Ends a connection whose headers never end."""

    _head = 0
    _reads_head = False

    def data_received(self, data: bytes) -> None:
        """Take what came over the network."""
        super().data_received(data)
        if not self._reads_head or self.transport.is_closing():
            return
        self._head += len(data)
        if self._head > MAX_HEAD:
            log.warning("a request's headers are longer than %d bytes", MAX_HEAD)
            self.transport.write(REFUSAL)
            self.transport.close()

    def on_message_begin(self) -> None:
        """Begin a request."""
        self._head, self._reads_head = 0, True
        super().on_message_begin()

    def on_headers_complete(self) -> None:
        """Go on to the body."""
        self._reads_head = False
        super().on_headers_complete()
