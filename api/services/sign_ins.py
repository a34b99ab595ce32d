"""The page's sign-in: a key becomes 256 other random bits that a browser keeps as a cookie.

Only their SHA-256 is stored, in a row that signing out removes and that goes with its key: so a sign-in ends in every
process at once, copies of the cookie open nothing, and nobody makes a cookie from what is stored.
"""

import secrets
from datetime import timedelta

from api.services import access, auditing
from api.services.access import Principal
from api.services.context import Context
from api.services.errors import UnauthenticatedError
from storage import keys, sign_ins
from storage.database import ReadSession


def sign_in(context: Context, principal: Principal, address: str) -> str:
    """Give the value of the cookie that stands for this key."""
    now, cookie = context.clock(), secrets.token_urlsafe(32)
    until = now + timedelta(hours=context.settings.session_hours)
    with context.database.write() as tx:
        sign_ins.add(tx, access.digest(cookie), principal.key_pk, now, until)
        auditing.record(tx, principal, "session.sign_in", None, {"address": address}, now)
    return cookie


def refused(context: Context, address: str) -> None:
    """Record that somebody tried to sign in with a key that is none."""
    now = context.clock()
    with context.database.write() as tx:
        auditing.record(tx, auditing.NOBODY, "session.refused", None, {"address": address}, now)


def recognise(context: Context, cookie: str) -> Principal:
    """Tell who signed in with this cookie: the key is looked up every time, so that its end ends the sign-in."""
    with context.database.read() as tx:
        found = _find(tx, context, cookie)
        key = None if found is None else keys.by_pk(tx, found.key_pk)
    if found is None or key is None:
        raise UnauthenticatedError(access.UNKNOWN)
    return access.let_in(context, key, found.pk)


def sign_out(context: Context, cookie: str, address: str) -> None:
    """End a sign-in, if it has not ended; what else is signed in with the key stays so."""
    try:
        principal = recognise(context, cookie)
    except UnauthenticatedError:
        return
    now = context.clock()
    with context.database.write() as tx:
        if principal.sign_in_pk is not None:
            sign_ins.remove(tx, principal.sign_in_pk)
        auditing.record(tx, principal, "session.sign_out", None, {"address": address}, now)


def is_valid(context: Context, principal: Principal) -> bool:
    """Tell whether somebody recognised earlier may still go on: key and sign-in hold."""
    now = context.clock()
    with context.database.read() as tx:
        if not access.holds(keys.by_pk(tx, principal.key_pk), now):
            return False
        if principal.sign_in_pk is None:
            return True
        found = sign_ins.by_pk(tx, principal.sign_in_pk)
    return found is not None and now < found.expires_at


def _find(tx: ReadSession, context: Context, cookie: str) -> sign_ins.SignIn | None:
    found = sign_ins.by_digest(tx, access.digest(cookie))
    return found if found is not None and context.clock() < found.expires_at else None
