"""Liveness, readiness and the description of the API, outside `/api/v1`."""

from pathlib import Path

from fastapi import APIRouter, Request
from fastapi.responses import HTMLResponse, PlainTextResponse, Response
from sqlalchemy import literal, select

from api import schemas
from api.dependencies import CurrentContext

router = APIRouter(tags=["service"])

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
def health() -> schemas.Health:
    """The process answers."""
    return schemas.Health(status="ok")


@router.get("/readyz", responses={503: {"model": schemas.Health, "description": "Not ready"}})
def readiness(request: Request, response: Response, context: CurrentContext) -> schemas.Health:
    """The tables are up to date, the estimator is compiled, and the database answers."""
    if not request.state.ready.is_set():
        response.status_code = 503
        return schemas.Health(status="starting")
    with context.database.read() as tx:
        tx.value(select(literal(1)))
    return schemas.Health(status="ok")


@router.get("/docs", include_in_schema=False)
def docs() -> Response:
    """Describe the API for people, without any other server's help."""
    return HTMLResponse(DOCS) if SWAGGER.is_dir() else PlainTextResponse(NOT_BUILT, 404)


@router.get("/docs/start.js", include_in_schema=False)
def docs_start() -> Response:
    """Start the page above; a file of its own because no page here may contain scripts."""
    return Response(START, media_type="text/javascript")
