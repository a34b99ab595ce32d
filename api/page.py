"""The built page: files with a hash in their name are kept for ever, the rest is asked for anew.

Beside most files stand the same compressed, made when the page was built; a browser gets the smallest it takes.
"""

from mimetypes import guess_type
from pathlib import Path

from starlette.datastructures import Headers
from starlette.exceptions import HTTPException
from starlette.responses import PlainTextResponse, Response
from starlette.staticfiles import StaticFiles
from starlette.types import ASGIApp, Receive, Scope, Send

STATIC = Path(__file__).parent / "static"
HASHED = "/assets/"
NOT_BUILT = "The page is not built: run `make setup`. The API is at /api/v1 and described at /openapi.json.\n"
COMPRESSED = {"br": ".br", "gzip": ".gz"}
"""endings of compressed files by their content coding, the smallest first"""


class Page:
    """Answers what no route answers: a file of the page, or its start, which finds its own way from the address."""

    def __init__(self, otherwise: ASGIApp, directory: Path) -> None:
        self.otherwise = otherwise
        self.files = StaticFiles(directory=directory, check_dir=False)
        self.start = directory / "index.html"

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request."""
        is_page = scope["type"] == "http" and scope["method"] in {"GET", "HEAD"}
        if not is_page or scope["path"].startswith("/api/"):
            await self.otherwise(scope, receive, send)
            return
        response = await self._respond(scope)
        await response(scope, receive, send)

    async def _respond(self, scope: Scope) -> Response:
        if not self.start.is_file():
            return PlainTextResponse(NOT_BUILT, 404)
        try:
            response = await self._file(self.files.get_path(scope), scope)
        except HTTPException:
            if "." in scope["path"].rsplit("/", 1)[-1]:
                raise
            response = await self._file("index.html", scope)
        immutable = scope["path"].startswith(HASHED)
        response.headers["Vary"] = "Accept-Encoding"
        response.headers["Cache-Control"] = "public, max-age=31536000, immutable" if immutable else "no-cache"
        return response

    async def _file(self, path: str, scope: Scope) -> Response:
        accepted = _codings(Headers(scope=scope).get("accept-encoding", ""))
        for coding, ending in COMPRESSED.items():
            if coding in accepted and self.files.lookup_path(path + ending)[1] is not None:
                response = await self.files.get_response(path + ending, scope)
                kind = guess_type(path)[0] or "application/octet-stream"
                response.headers.update({"Content-Encoding": coding, "Content-Type": kind})
                return response
        return await self.files.get_response(path, scope)


def _codings(accepted: str) -> set[str]:
    """Give the content codings that a client takes (RFC 9110, 12.5.3); one with the weight 0 it does not."""
    parts = [part.replace(" ", "").lower().partition(";q=") for part in accepted.split(",")]
    return {coding for coding, _, weight in parts if weight.strip("0.") or not weight}
