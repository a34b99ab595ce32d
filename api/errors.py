"""Every error as RFC 9457 problem details: one table from what went wrong to the HTTP status."""

import logging
from collections.abc import Mapping
from http import HTTPStatus
from typing import Any

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from sqlalchemy.exc import DBAPIError, OperationalError
from sqlalchemy.exc import TimeoutError as PoolTimeoutError
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect

from api import metrics, schemas
from api.formats import FormatError
from api.services import errors

log = logging.getLogger(__name__)

MEDIA_TYPE = "application/problem+json"
TYPE_PREFIX = "urn:livella:problem:"
RETRY_AFTER = "2"
"""s until a request that met a busy or missing database is worth another try"""

STATUS: dict[type[errors.ServiceError], HTTPStatus] = {
    errors.UnauthenticatedError: HTTPStatus.UNAUTHORIZED,
    errors.ForbiddenError: HTTPStatus.FORBIDDEN,
    errors.NotFoundError: HTTPStatus.NOT_FOUND,
    errors.ConflictError: HTTPStatus.CONFLICT,
    errors.UnusableError: HTTPStatus.UNPROCESSABLE_ENTITY,
    errors.LongSpanError: HTTPStatus.UNPROCESSABLE_ENTITY,
    errors.WebhookUrlError: HTTPStatus.UNPROCESSABLE_ENTITY,
    errors.CursorError: HTTPStatus.UNPROCESSABLE_ENTITY,
    errors.ExpiryError: HTTPStatus.UNPROCESSABLE_ENTITY,
    errors.TooManyRequestsError: HTTPStatus.TOO_MANY_REQUESTS,
    errors.TooLargeError: HTTPStatus.REQUEST_ENTITY_TOO_LARGE,
    errors.StartingError: HTTPStatus.SERVICE_UNAVAILABLE,
}
HEADERS: dict[HTTPStatus, dict[str, str]] = {
    HTTPStatus.UNAUTHORIZED: {"WWW-Authenticate": 'Bearer realm="livella"'},
    HTTPStatus.SERVICE_UNAVAILABLE: {"Retry-After": RETRY_AFTER},
}


def problem(
    status: int,
    title: str,
    detail: str,
    kind: str | None = None,
    items: list[schemas.ProblemItem] | None = None,
    headers: Mapping[str, str] | None = None,
) -> JSONResponse:
    """Make the answer."""
    document = schemas.Problem(
        type="about:blank" if kind is None else TYPE_PREFIX + kind,
        title=title,
        status=status,
        detail=detail,
        errors=items or [],
    )
    content = document.model_dump(exclude={"errors"}) | {
        "errors": [item.model_dump(exclude_none=True) for item in document.errors]
    }
    known = HEADERS.get(HTTPStatus(status), {})
    return JSONResponse(content, status, {**known, **(headers or {})}, MEDIA_TYPE)


def _service_error(_: Request, error: errors.ServiceError) -> JSONResponse:
    status = next(STATUS[family] for family in type(error).__mro__ if family in STATUS)
    headers = {"Retry-After": str(error.retry_after)} if isinstance(error, errors.TooManyRequestsError) else None
    return problem(status, error.title, error.detail, error.kind, headers=headers)


def _format_error(_: Request, error: FormatError) -> JSONResponse:
    items = [
        schemas.ProblemItem(line=p.line, column=p.column, expected=p.expected, message=p.message)
        for p in error.problems
    ]
    return problem(error.status, error.title, error.detail, "unreadable-log", items)


def _http_error(_: Request, error: HTTPException) -> JSONResponse:
    return of_http(error)


def of_http(error: HTTPException) -> JSONResponse:
    """Make the answer to an error that carries its status."""
    title = HTTPStatus(error.status_code).phrase
    return problem(error.status_code, title, str(error.detail), headers=error.headers)


def _validation_error(_: Request, error: RequestValidationError) -> JSONResponse:
    items = [_item(found) for found in error.errors()]
    detail = "; ".join(f"{item.pointer}: {item.message}" for item in items[:3])
    return problem(HTTPStatus.UNPROCESSABLE_ENTITY, "The request is not valid", detail, "invalid-request", items)


def _item(found: dict[str, Any]) -> schemas.ProblemItem:
    place = [str(part).replace("~", "~0").replace("/", "~1") for part in found["loc"]]
    expected = found.get("ctx", {}).get("expected") or found.get("ctx", {}).get("pattern")
    return schemas.ProblemItem(
        pointer="/" + "/".join(place), expected=None if expected is None else str(expected), message=found["msg"]
    )


def _database_error(request: Request, error: DBAPIError | PoolTimeoutError) -> JSONResponse:
    """Locked and unreachable mean: try again. Anything else is a fault of ours."""
    gone = isinstance(error, OperationalError | PoolTimeoutError) or error.connection_invalidated
    if isinstance(error, PoolTimeoutError):
        metrics.DATABASE_ERRORS.labels("TimeoutError").inc()
    log.error("the database failed: %s", type(error).__name__, exc_info=None if gone else error)
    if gone:
        return problem(503, "The database is busy or cannot be reached", "Try again in a moment.", "unavailable")
    return _unexpected(request, error)


def _hung_up(_: Request, __: ClientDisconnect) -> JSONResponse:
    """Answer a caller who is gone, for what counts the answers; no fault of ours."""
    return problem(HTTPStatus.BAD_REQUEST, "The request broke off", "Its body did not arrive whole.", "broken-off")


def _unexpected(_: Request, __: Exception) -> JSONResponse:
    return problem(500, "Internal error", "The fault is in the service, not in the request; it was logged.")


def install(app: FastAPI) -> None:
    """Let the application answer every error this way, and describe it so."""
    app.add_exception_handler(errors.ServiceError, _service_error)  # type: ignore[arg-type]
    app.add_exception_handler(FormatError, _format_error)  # type: ignore[arg-type]
    app.add_exception_handler(HTTPException, _http_error)  # type: ignore[arg-type]
    app.add_exception_handler(RequestValidationError, _validation_error)  # type: ignore[arg-type]
    app.add_exception_handler(ClientDisconnect, _hung_up)  # type: ignore[arg-type]
    app.add_exception_handler(DBAPIError, _database_error)  # type: ignore[arg-type]
    app.add_exception_handler(PoolTimeoutError, _database_error)  # type: ignore[arg-type]
    app.add_exception_handler(Exception, _unexpected)


RESPONSES: dict[int | str, dict[str, Any]] = {
    "default": {
        "description": "Problem details (RFC 9457)",
        "model": schemas.Problem,
    }
}
"""For every route: what an error looks like. `describe` sets the media type."""


def describe(document: dict[str, Any]) -> dict[str, Any]:
    """Set the media type of the errors in an OpenAPI document, which FastAPI takes for that of the answers."""
    for path in document["paths"].values():
        for operation in path.values():
            answer = operation["responses"].get("default")
            if answer is not None:
                answer["content"] = {MEDIA_TYPE: next(iter(answer["content"].values()))}
    return document
