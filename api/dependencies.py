"""What routes ask for: the context, who is calling, the body."""

import re
from datetime import datetime
from typing import Annotated
from urllib.parse import urlsplit

from fastapi import Depends, Query, Request, Security
from fastapi.security import APIKeyCookie, HTTPAuthorizationCredentials, HTTPBearer

from api import rates
from api.live import Hub
from api.schemas import DEVICE_ID
from api.services import access, limiting, paging, sign_ins
from api.services.access import Principal, Role
from api.services.context import Context
from api.services.errors import (
    UNKNOWN_DEVICE,
    ForbiddenError,
    NotFoundError,
    StartingError,
    TooLargeError,
    UnauthenticatedError,
)
from api.services.limiting import Rates

COOKIE = "livella_session"
SAFE_METHODS = frozenset({"GET", "HEAD", "OPTIONS"})

_bearer = HTTPBearer(auto_error=False, description="A key, as `Authorization: Bearer KEY`.")
_cookie = APIKeyCookie(name=COOKIE, auto_error=False, description="Sign-in of the page, see `POST /api/v1/session`.")


async def get_context(request: Request) -> Context:
    """Give what the services need."""
    context: Context = request.state.context
    return context


async def get_hub(request: Request) -> Hub:
    """Give the live stream."""
    hub: Hub = request.state.hub
    return hub


def get_rates(request: Request) -> Rates:
    """Give what counts the calls."""
    counted: Rates = request.state.rates
    return counted


CurrentContext = Annotated[Context, Depends(get_context)]
CurrentHub = Annotated[Hub, Depends(get_hub)]


def get_principal(
    request: Request,
    context: CurrentContext,
    bearer: Annotated[HTTPAuthorizationCredentials | None, Security(_bearer)],
    cookie: Annotated[str | None, Security(_cookie)],
) -> Principal:
    """Tell who is calling, by key or by the cookie of the page, and whether they call too often."""
    return charged(request, _identify(request, context, bearer, cookie))


def _identify(
    request: Request, context: Context, bearer: HTTPAuthorizationCredentials | None, cookie: str | None
) -> Principal:
    if bearer is not None:
        return by_key(request, context, bearer.credentials)
    if cookie is None:
        raise UnauthenticatedError("Send a key as `Authorization: Bearer KEY`, or sign in.")
    if request.method not in SAFE_METHODS and not is_same_origin(request):
        raise ForbiddenError("A request with the page's sign-in has to come from the page itself.")
    return sign_ins.recognise(context, cookie)


def by_key(request: Request, context: Context, key: str) -> Principal:
    """Tell whose key this is, unless its sender has tried too many that are none."""
    counted, address = get_rates(request), rates.address(request)
    counted.admit(address, key)
    try:
        return access.authenticate(context, key)
    except UnauthenticatedError:
        counted.failed(address)
        raise


def charged(request: Request, principal: Principal) -> Principal:
    """Count a call, and refuse it when it is one too many."""
    standing, is_allowed = get_rates(request).charge(principal)
    setattr(request.state, rates.STANDING, standing)
    if not is_allowed:
        raise limiting.too_many(standing)
    return principal


def is_same_origin(request: Request) -> bool:
    """Tell whether a browser says that the request comes from our own page; False when it says nothing."""
    site = request.headers.get("sec-fetch-site")
    if site is not None:
        return site == "same-origin"
    origin = request.headers.get("origin")
    return origin is not None and urlsplit(origin).netloc == request.headers.get("host")


def refuse_other_sites(request: Request) -> None:
    """Refuse a request that another site makes a browser send; programs that are no browsers say nothing and may."""
    said = request.headers.get("sec-fetch-site") or request.headers.get("origin")
    if said is not None and not is_same_origin(request):
        raise ForbiddenError("Sign in on the page itself.")


Caller = Annotated[Principal, Depends(get_principal)]


class Requires:
    """Dependency: the caller has at least this role."""

    def __init__(self, role: Role) -> None:
        self.role = role

    async def __call__(self, principal: Caller) -> Principal:
        """Let the caller in or not."""
        access.require(principal, self.role)
        return principal


async def known_id(device_id: str) -> str:
    """Give the device of the path, if it can be one at all."""
    if not re.fullmatch(DEVICE_ID, device_id):
        raise NotFoundError(UNKNOWN_DEVICE)
    return device_id


async def own_device(device_id: str, principal: Caller) -> str:
    """Give the device of the path, if the caller may see it: whether it exists is looked up only then."""
    access.require_device(principal, device_id)
    return await known_id(device_id)


KnownId = Annotated[str, Depends(known_id)]


AnyDevice = Annotated[str, Depends(own_device)]
Installer = Annotated[Principal, Depends(Requires(Role.INSTALLER))]
Manager = Annotated[Principal, Depends(Requires(Role.MANAGER))]
Admin = Annotated[Principal, Depends(Requires(Role.ADMIN))]


async def read_body(request: Request, context: CurrentContext, _: AnyDevice) -> bytes:
    """Read the body up to the limit, after the caller is known."""
    limit = context.settings.max_chunk_bytes
    stated = request.headers.get("content-length", "")
    received = bytearray()
    if stated.isdigit() and int(stated) > limit:
        raise _too_large(limit)
    async for part in request.stream():
        received += part
        if len(received) > limit:
            raise _too_large(limit)
    return bytes(received)


def _too_large(limit: int) -> TooLargeError:
    return TooLargeError(f"A chunk may have at most {limit} bytes as sent.")


async def ready(request: Request) -> None:
    """Refuse work until the estimator is compiled."""
    if not request.state.ready.is_set():
        raise StartingError("The estimator is being compiled; try again in a moment.")


Body = Annotated[bytes, Depends(read_body)]
Limit = Annotated[int, Query(ge=1, le=500, description="Items on a page.")]
Cursor = Annotated[str | None, Query(max_length=2048, description="`next_cursor` of the page before.")]


async def cursor_number(cursor: Cursor = None) -> int | None:
    """Give the number inside a cursor."""
    return None if cursor is None else paging.decode_number(cursor)


async def cursor_place(cursor: Cursor = None) -> tuple[datetime, int] | None:
    """Give the moment and the number inside a cursor."""
    return None if cursor is None else paging.decode_place(cursor)


BeforeNumber = Annotated[int | None, Depends(cursor_number)]
BeforePlace = Annotated[tuple[datetime, int] | None, Depends(cursor_place)]
