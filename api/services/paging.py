"""Keyset pages: a cursor names the last item given, so that items which come or go do not shift the next page."""

import binascii
from base64 import b64decode, urlsafe_b64encode
from collections.abc import Callable
from typing import TypeVar

from api import schemas
from api.services.errors import CursorError

INVALID = "Give the cursor exactly as `next_cursor` of the page before."

R = TypeVar("R")
S = TypeVar("S")


def encode(key: str | int) -> str:
    """Make a cursor; its content is not for callers."""
    return urlsafe_b64encode(str(key).encode()).decode().rstrip("=")


def decode(cursor: str) -> str:
    """Give what `encode` was given."""
    try:
        text = b64decode(cursor + "=" * (-len(cursor) % 4), altchars="-_", validate=True).decode()
    except (binascii.Error, ValueError) as error:
        raise CursorError(INVALID) from error
    if not text.isprintable():
        raise CursorError(INVALID)
    return text


def decode_number(cursor: str) -> int:
    """Give the number that `encode` was given."""
    text = decode(cursor)
    if not (text.isascii() and text.isdigit() and len(text) < 19):
        raise CursorError(INVALID)
    return int(text)


def page(rows: list[R], limit: int, key: Callable[[R], str | int], present: Callable[[R], S]) -> schemas.Page[S]:
    """Make a page of `limit` items from up to `limit` + 1 rows."""
    more = len(rows) > limit
    kept = rows[:limit]
    return schemas.Page(items=[present(row) for row in kept], next_cursor=encode(key(kept[-1])) if more else None)
