"""The built page: files with a hash in their name are kept for ever, the rest is asked for anew."""

from pathlib import Path

from starlette.exceptions import HTTPException
from starlette.responses import PlainTextResponse, Response
from starlette.staticfiles import StaticFiles
from starlette.types import ASGIApp, Receive, Scope, Send

STATIC = Path(__file__).parent / "static"
HASHED = "/assets/"
NOT_BUILT = "The page is not built: run `make setup`. The API is at /api/v1 and described at /openapi.json.\n"


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
            response = await self.files.get_response(self.files.get_path(scope), scope)
        except HTTPException:
            if "." in scope["path"].rsplit("/", 1)[-1]:
                raise
            response = await self.files.get_response("index.html", scope)
        immutable = scope["path"].startswith(HASHED)
        response.headers["Cache-Control"] = "public, max-age=31536000, immutable" if immutable else "no-cache"
        return response
