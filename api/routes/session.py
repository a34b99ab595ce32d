"""Sign-in of the page: a key becomes a cookie that no script can read and no other site can use."""

from fastapi import APIRouter, Depends, Request, Response

from api import schemas
from api.dependencies import COOKIE, Caller, CurrentContext, by_key, charged, refuse_other_sites
from api.rates import address
from api.services import sign_ins
from api.services.access import Principal
from api.services.context import Context
from api.services.errors import UnauthenticatedError

router = APIRouter(prefix="/session", tags=["session"])


@router.post("", dependencies=[Depends(refuse_other_sites)])
def sign_in(given: schemas.SignIn, request: Request, response: Response, context: CurrentContext) -> schemas.SignedIn:
    """Sign in with a key."""
    principal = charged(request, _authenticate(request, context, given.key))
    response.set_cookie(
        COOKIE,
        sign_ins.sign_in(context, principal, address(request)),
        max_age=int(context.settings.session_hours * 3600),
        path="/api",
        secure=request.url.scheme == "https",
        httponly=True,
        samesite="strict",
    )
    return _present(principal)


@router.get("")
def read_session(principal: Caller) -> schemas.SignedIn:
    """Tell who is signed in."""
    return _present(principal)


@router.delete("", status_code=204, dependencies=[Depends(refuse_other_sites)])
def sign_out(request: Request, response: Response, context: CurrentContext) -> None:
    """Sign out: the cookie opens nothing any more, wherever it may have got to."""
    cookie = request.cookies.get(COOKIE)
    if cookie is not None:
        sign_ins.sign_out(context, cookie, address(request))
    response.delete_cookie(COOKIE, path="/api", httponly=True, samesite="strict")


def _authenticate(request: Request, context: Context, key: str) -> Principal:
    try:
        return by_key(request, context, key)
    except UnauthenticatedError:
        sign_ins.refused(context, address(request))
        raise


def _present(principal: Principal) -> schemas.SignedIn:
    return schemas.SignedIn.model_validate(
        {"role": principal.role.word, "name": principal.name, "device_id": principal.device_id}
    )
