"""Keyset pages: a cursor names the last item given, so that items which come or go do not shift the next page."""

import binascii
from base64 import b64decode, urlsafe_b64encode
from collections.abc import Callable
from datetime import datetime
from typing import TypeVar, get_args

from api import schemas
from api.services.errors import CursorError
from storage.device_lists import Place
from storage.devices import Device
from storage.models import EPOCH, MICROSECOND, microseconds

INVALID = "Give the cursor exactly as `next_cursor` of the page before."
OTHER_ORDER = "The cursor belongs to a list in another order: begin anew, or give the `sort` of the page before."

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
    if "\x00" in text:
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
    if len(parts) != 2 or not all(map(_is_number, parts)):
        raise CursorError(INVALID)
    return EPOCH + int(parts[0]) * MICROSECOND, int(parts[1])


def _is_number(told: str) -> bool:
    return told.isascii() and told.isdigit() and len(told) < 17


def place_in(sort: str, row: Device) -> str:
    """Give the key of a device in a list in this order."""
    moment = "" if row.last_data_at is None else str(microseconds(row.last_data_at))
    key = {"id": "", "name": row.name_key, "last_data_at": moment}[sort.removeprefix("-")]
    return f"{sort} {row.id} {key}"


def decode_place_in(sort: str, cursor: str) -> Place:
    """Give the place whose key `encode` was given; it has to be one in this order."""
    of_order, *place = decode(cursor).split(" ", 2)
    if len(place) != 2 or of_order not in get_args(schemas.DeviceOrder):
        raise CursorError(INVALID)
    if of_order != sort:
        raise CursorError(OTHER_ORDER)
    device_id, told = place
    if not (told and sort.endswith("last_data_at")):
        return Place(device_id, told or None)
    if not _is_number(told):
        raise CursorError(INVALID)
    return Place(device_id, EPOCH + int(told) * MICROSECOND)


def page(rows: list[R], limit: int, key: Callable[[R], str | int], present: Callable[[R], S]) -> schemas.Page[S]:
    """Make a page of `limit` items from up to `limit` + 1 rows."""
    more = len(rows) > limit
    kept = rows[:limit]
    return schemas.Page(items=[present(row) for row in kept], next_cursor=encode(key(kept[-1])) if more else None)
