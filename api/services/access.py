"""Who may do what: keys, roles, and the signed cookie of the page.

A key is 256 random bits, so its plain SHA-256 is stored: a slow, salted hash guards secrets that can be guessed from a
dictionary, and nobody can try 2^256 values however fast the hash is. One exception is on the operator: an admin
key of one's own choosing, which has to be as random.
"""

import hashlib
import hmac
import secrets
from enum import IntEnum
from typing import NamedTuple

from itsdangerous import BadSignature, URLSafeTimedSerializer

from api.services.context import Context
from api.services.errors import ForbiddenError, UnauthenticatedError
from storage import keys, meta
from storage.database import ReadSession, WriteSession

KEY_PREFIX = "livella_"
"""Marks a key as one of ours, for people and for scanners of leaked secrets."""

COOKIE_SECRET = "cookie_secret"  # noqa: S105 - the name under which it is stored
UNKNOWN = "The key is not known, was revoked, or the sign-in has ended."


class Role(IntEnum):
    """Roles; each may do what the ones below it may, except that a device sees only itself."""

    DEVICE = 0
    INSTALLER = 1
    MANAGER = 2
    ADMIN = 3

    @property
    def word(self) -> str:
        """Name used in the API."""
        return self.name.lower()


class Principal(NamedTuple):
    """Whoever makes a request."""

    key_pk: int
    role: Role
    name: str
    device_pk: int | None
    device_id: str | None


def new_key() -> str:
    """Make a key."""
    return KEY_PREFIX + secrets.token_urlsafe(32)


def digest(key: str) -> bytes:
    """Give what is stored of a key."""
    return hashlib.sha256(key.encode()).digest()


def authenticate(context: Context, key: str) -> Principal:
    """Tell whose key this is, or raise `UnauthenticatedError`."""
    wanted = digest(key)
    with context.database.read() as tx:
        found = keys.by_digest(tx, wanted)
    if found is None or not hmac.compare_digest(found.digest, wanted):
        raise UnauthenticatedError(UNKNOWN)
    return _principal(found)


def sign_in(context: Context, principal: Principal) -> str:
    """Give the value of the cookie that stands for this key."""
    with context.database.read() as tx:
        return _serializer(tx).dumps(principal.key_pk)


def recognise(context: Context, cookie: str) -> Principal:
    """Tell who signed in with this cookie: its key is looked up every time, so that revoking it ends the sign-in."""
    with context.database.read() as tx:
        try:
            key_pk = _serializer(tx).loads(cookie, max_age=int(context.settings.session_hours * 3600))
        except BadSignature as error:
            raise UnauthenticatedError(UNKNOWN) from error
        found = keys.by_pk(tx, int(key_pk))
    if found is None:
        raise UnauthenticatedError(UNKNOWN)
    return _principal(found)


def is_valid(context: Context, principal: Principal) -> bool:
    """Tell whether the key of somebody recognised earlier still holds."""
    with context.database.read() as tx:
        return keys.by_pk(tx, principal.key_pk) is not None


def require(principal: Principal, role: Role) -> None:
    """Refuse whoever ranks below `role`."""
    if principal.role < role:
        raise ForbiddenError(f"This needs a key of role {role.word}.")


def require_device(principal: Principal, device_id: str) -> None:
    """Refuse a device every device but itself, in the same words whether the other one exists or not."""
    if principal.role == Role.DEVICE and principal.device_id != device_id:
        raise ForbiddenError("A device key sees only its own device.")


def first_admin_key(tx: WriteSession, context: Context) -> str | None:
    """Make sure there is an admin key; give the key when one was made, so that it can be shown once."""
    chosen = context.settings.admin_key
    if chosen is not None:
        _use_chosen_key(tx, context, chosen.get_secret_value())
        return None
    if keys.any_of_role(tx, Role.ADMIN.word):
        return None
    key = new_key()
    keys.add(tx, digest(key), Role.ADMIN.word, "first admin", context.clock())
    return key


def _use_chosen_key(tx: WriteSession, context: Context, key: str) -> None:
    """Make the key from the environment the only one of that origin."""
    if keys.by_digest(tx, digest(key)) is None:
        keys.remove_source(tx, "environment")
        keys.add(tx, digest(key), Role.ADMIN.word, "admin", context.clock(), source="environment")


def ensure_cookie_secret(tx: WriteSession) -> None:
    """Make the secret that signs cookies, once in the life of the database."""
    if meta.get(tx, COOKIE_SECRET) is None:
        meta.put(tx, COOKIE_SECRET, secrets.token_urlsafe(32))


def _serializer(tx: ReadSession) -> URLSafeTimedSerializer:
    secret = meta.get(tx, COOKIE_SECRET)
    if secret is None:
        raise LookupError("the database has no cookie secret: the service was not started on it")
    return URLSafeTimedSerializer(secret, salt="page", signer_kwargs={"digest_method": hashlib.sha256})


def _principal(key: keys.Key) -> Principal:
    return Principal(key.pk, Role[key.role.upper()], key.name, key.device_pk, key.device_id)
