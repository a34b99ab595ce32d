"""Keyset pages: a cursor names the last item given, so that items which come or go do not shift the next page."""

import binascii
from base64 import b64decode, urlsafe_b64encode
from collections.abc import Callable
from datetime import datetime
from typing import TypeVar

from api import schemas
from api.services.errors import CursorError
from storage.models import EPOCH, MICROSECOND, microseconds

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


def place(moment: datetime, number: int) -> str:
    """Give the key of an item in a list ordered by time and number."""
    return f"{microseconds(moment)}.{number}"


def decode_place(cursor: str) -> tuple[datetime, int]:
    """Give the moment and the number of the key that `encode` was given."""
    parts = decode(cursor).split(".")
    if len(parts) != 2 or not all(part.isascii() and part.isdigit() and len(part) < 17 for part in parts):
        raise CursorError(INVALID)
    return EPOCH + int(parts[0]) * MICROSECOND, int(parts[1])


def page(rows: list[R], limit: int, key: Callable[[R], str | int], present: Callable[[R], S]) -> schemas.Page[S]:
    """Make a page of `limit` items from up to `limit` + 1 rows."""
    more = len(rows) > limit
    kept = rows[:limit]
    return schemas.Page(items=[present(row) for row in kept], next_cursor=encode(key(kept[-1])) if more else None)
