"""Who may do what: keys and roles.

A key is 256 random bits, so its plain SHA-256 is stored: a slow, salted hash guards secrets that can be guessed from a
dictionary, and nobody can try 2^256 values however fast the hash is. One exception is on the operator: an admin
key of one's own choosing, which has to be as random; guesses at such a key are limited, see `limiting`.
"""

import hashlib
import hmac
import re
import secrets
from datetime import datetime
from enum import IntEnum
from typing import NamedTuple

from api.services.context import Context
from api.services.errors import ForbiddenError, UnauthenticatedError
from storage import keys

KEY_PREFIX = "livella_"
"""Marks a key as one of ours, for people and for scanners of leaked secrets."""
SHOWN = 12
"""characters of a key that are stored to tell it from others: 24 of its 256 bits"""

UNKNOWN = "The key is not known, was revoked or has expired, or the sign-in has ended."

_ours = re.compile(KEY_PREFIX + r"[A-Za-z0-9_-]{43}").fullmatch


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
    device_pk: int | None = None
    device_id: str | None = None
    sign_in_pk: int | None = None
    """the sign-in to the page this was recognised by; None when the key itself came"""


def new_key() -> str:
    """Make a key."""
    return KEY_PREFIX + secrets.token_urlsafe(32)


def is_ours(key: str) -> bool:
    """Tell whether a key looks like one made here, which cannot be guessed."""
    return _ours(key) is not None


def digest(key: str) -> bytes:
    """Give what is stored of a key."""
    return hashlib.sha256(key.encode()).digest()


def authenticate(context: Context, key: str) -> Principal:
    """Tell whose key this is, or raise `UnauthenticatedError`."""
    wanted = digest(key)
    with context.database.look() as tx:
        found = keys.by_digest(tx, wanted)
    if found is None or not hmac.compare_digest(found.digest, wanted):
        raise UnauthenticatedError(UNKNOWN)
    return let_in(context, found)


def let_in(context: Context, key: keys.Key, sign_in_pk: int | None = None) -> Principal:
    """Give the caller a stored key stands for, unless it has expired."""
    now = context.clock()
    if not holds(key, now):
        raise UnauthenticatedError(UNKNOWN)
    context.uses.mark(key.pk, now)
    return Principal(key.pk, Role[key.role.upper()], key.name, key.device_pk, key.device_id, sign_in_pk)


def holds(key: keys.Key | None, now: datetime) -> bool:
    """Tell whether a key is there and has not expired."""
    return key is not None and (key.expires_at is None or now < key.expires_at)


def require(principal: Principal, role: Role) -> None:
    """Refuse whoever ranks below `role`."""
    if principal.role < role:
        raise ForbiddenError(f"This needs a key of role {role.word}.")


def require_device(principal: Principal, device_id: str) -> None:
    """Refuse a device every device but itself, in the same words whether the other one exists or not."""
    if principal.role == Role.DEVICE and principal.device_id != device_id:
        raise ForbiddenError("A device key sees only its own device.")
