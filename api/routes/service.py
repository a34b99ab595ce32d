"""Liveness, readiness, figures for Prometheus and the description of the API, outside `/api/v1`."""

import hmac
from pathlib import Path
from typing import Annotated

import anyio
from anyio import CapacityLimiter, to_thread
from fastapi import APIRouter, Header, Request
from fastapi.responses import HTMLResponse, PlainTextResponse, Response
from prometheus_client import CONTENT_TYPE_LATEST
from sqlalchemy import literal, select

from api import metrics, schemas
from api.services.context import Context
from api.services.errors import UnauthenticatedError
from api.services.monitoring import Fleet

router = APIRouter(tags=["service"])

ONE = select(literal(1))
PATIENCE = 5.0
"""s the database may take to answer when it is asked whether it does"""

STATIC = Path(__file__).parent.parent / "static"
SWAGGER = STATIC / "swagger"
DOCS = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<title>Livella API</title>
<link rel="icon" href="/swagger/favicon-32x32.png">
<link rel="stylesheet" href="/swagger/swagger-ui.css">
</head>
<body>
<div id="swagger-ui"></div>
<script src="/swagger/swagger-ui-bundle.js"></script>
<script src="/docs/start.js"></script>
</body>
</html>
"""
START = 'SwaggerUIBundle({url: "/openapi.json", dom_id: "#swagger-ui", deepLinking: true});\n'
NOT_BUILT = "The page is not built. `make setup` builds it; the API is described at /openapi.json.\n"


@router.get("/healthz")
async def health() -> schemas.Health:
    """The process answers."""
    return schemas.Health(status="ok")


@router.get("/readyz", responses={503: {"model": schemas.Health, "description": "Not ready"}})
async def readiness(request: Request, response: Response) -> schemas.Health:
    """The tables are up to date, the estimator is compiled, and the database answers."""
    response.status_code = 503
    if not request.state.ready.is_set():
        return schemas.Health(status="starting")
    state: Watch = request.state.watch
    with anyio.move_on_after(PATIENCE):
        await to_thread.run_sync(_ask, request.state.context, limiter=state.threads, abandon_on_cancel=True)
        response.status_code = 200
        return schemas.Health(status="ok")
    return schemas.Health(status="unavailable")


def _ask(context: Context) -> None:
    with context.database.read() as tx:
        tx.value(ONE)


@router.get("/metrics", include_in_schema=False)
async def figures(request: Request, authorization: Annotated[str, Header()] = "") -> Response:
    """Tell Prometheus."""
    context: Context = request.state.context
    token = context.settings.metrics_token
    if token is not None and not hmac.compare_digest(authorization, f"Bearer {token.get_secret_value()}"):
        raise UnauthenticatedError("Send the token of the setting `LIVELLA_METRICS_TOKEN`.")
    watch: Watch = request.state.watch
    content = await to_thread.run_sync(watch.render, limiter=watch.threads)
    return Response(content, media_type=CONTENT_TYPE_LATEST)


class Watch:
    """What looks after the service, with threads of its own, so that it answers when there is much to do."""

    def __init__(self, context: Context) -> None:
        self.threads = CapacityLimiter(2)
        self.fleet = Fleet(context)

    def render(self) -> bytes:
        """Give all figures."""
        return metrics.render() + self.fleet.render()


@router.get("/docs", include_in_schema=False)
def docs() -> Response:
    """Describe the API for people, without any other server's help."""
    return HTMLResponse(DOCS) if SWAGGER.is_dir() else PlainTextResponse(NOT_BUILT, 404)


@router.get("/docs/start.js", include_in_schema=False)
def docs_start() -> Response:
    """Start the page above; a file of its own because no page here may contain scripts."""
    return Response(START, media_type="text/javascript")
