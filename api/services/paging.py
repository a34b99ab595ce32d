"""Keyset pages: a cursor names the last item given, so that items which come or go do not shift the next page."""

import binascii
from base64 import urlsafe_b64decode, urlsafe_b64encode
from collections.abc import Callable
from typing import TypeVar

from api import schemas
from api.services.errors import CursorError

R = TypeVar("R")
S = TypeVar("S")


def encode(key: str | int) -> str:
    """Make a cursor; its content is not for callers."""
    return urlsafe_b64encode(str(key).encode()).decode().rstrip("=")


def decode(cursor: str) -> str:
    """Give what `encode` was given."""
    try:
        return urlsafe_b64decode(cursor.encode() + b"=" * (-len(cursor) % 4)).decode()
    except (binascii.Error, UnicodeError) as error:
        raise CursorError("Give the cursor exactly as `next_cursor` of the page before.") from error


def decode_number(cursor: str) -> int:
    """Give the number that `encode` was given."""
    text = decode(cursor)
    if not (text.isascii() and text.isdigit() and len(text) < 19):
        raise CursorError("Give the cursor exactly as `next_cursor` of the page before.")
    return int(text)


def page(rows: list[R], limit: int, key: Callable[[R], str | int], present: Callable[[R], S]) -> schemas.Page[S]:
    """Make a page of `limit` items from up to `limit` + 1 rows."""
    more = len(rows) > limit
    kept = rows[:limit]
    return schemas.Page(items=[present(row) for row in kept], next_cursor=encode(key(kept[-1])) if more else None)
