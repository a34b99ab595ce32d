"""Headers that tell a caller of the API how often it may call: draft-ietf-httpapi-ratelimit-headers."""

from starlette.datastructures import MutableHeaders
from starlette.requests import Request
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from api.services.limiting import Rates, Standing

STANDING = "standing"
"""where a request's state keeps how its key stands, once that is known"""


class RateHeaders:
    """Put the headers on every answer of the API; plain ASGI, so that streams pass through untouched."""

    def __init__(self, app: ASGIApp, rates: Rates) -> None:
        self.app = app
        self.rates = rates

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request."""
        if scope["type"] != "http" or not scope["path"].startswith("/api/"):
            await self.app(scope, receive, send)
            return

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                standing = scope.get("state", {}).get(STANDING) or self.rates.of_address(address(Request(scope)))
                MutableHeaders(scope=message).update(_headers(standing))
            await send(message)

        await self.app(scope, receive, send_with_headers)


def address(request: Request) -> str:
    """Tell where a request comes from, as far as proxies that are believed tell."""
    return request.client.host if request.client is not None else "unknown"


def _headers(now: Standing) -> dict[str, str]:
    return {
        "RateLimit-Policy": f'"{now.policy}";q={now.quota};w={now.window}',
        "RateLimit": f'"{now.policy}";r={now.remaining};t={now.reset}',
    }
