"""Sign-in of the page: a key becomes a cookie that no script can read and no other site can use."""

from fastapi import APIRouter, Depends, Request, Response

from api import schemas
from api.dependencies import COOKIE, Caller, CurrentContext, refuse_other_sites
from api.services import access
from api.services.access import Principal

router = APIRouter(prefix="/session", tags=["session"])


@router.post("", dependencies=[Depends(refuse_other_sites)])
def sign_in(given: schemas.SignIn, request: Request, response: Response, context: CurrentContext) -> schemas.SignedIn:
    """Sign in with a key."""
    principal = access.authenticate(context, given.key)
    response.set_cookie(
        COOKIE,
        access.sign_in(context, principal),
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
def sign_out(response: Response) -> None:
    """Sign out."""
    response.delete_cookie(COOKIE, path="/api", httponly=True, samesite="strict")


def _present(principal: Principal) -> schemas.SignedIn:
    return schemas.SignedIn.model_validate(
        {"role": principal.role.word, "name": principal.name, "device_id": principal.device_id}
    )
