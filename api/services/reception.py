"""What became of the data of a device: the receipts of its chunks, found session by session, and summed up."""

from collections import Counter
from collections.abc import Iterator
from datetime import datetime
from itertools import chain, islice
from typing import Any, NamedTuple

from api import schemas
from api.services import history, last_data
from storage import chunks, sessions
from storage.chunks import APPLIED, WAITING, Receipt
from storage.database import ReadSession
from storage.sessions import Beginning

PAGE = 1024
"""Receipts read at once: as many as may wait. Where so many in a row came in before a moment, all before them did."""
MOST = 20_000
"""receipts read in all, some days without a pause"""
SESSIONS = 50
"""sessions read at once"""
AFTER_ALL_CHUNKS, AFTER_ALL_SESSIONS = 2**31 - 1, 2**62
"""numbers above any that there are"""
LOST, SHOWN_SESSIONS, ROWS = 100, 20, 500
"""most that is told"""


class Taken(NamedTuple):
    """What was taken in of a session within a period, the highest number first."""

    session: Beginning
    receipts: list[Receipt]
    lost: list[tuple[int, Receipt]]
    """first of the numbers that never came, and the receipt after them"""
    read: int
    """receipts that were looked at for it"""


def read(tx: ReadSession, device_pk: int, since: datetime, until: datetime) -> schemas.Reception:
    """Sum up what came in of a device within a period that ends now."""
    found, is_whole = _look(tx, device_pk, since)
    receipts = [receipt for taken in found for receipt in taken.receipts]
    lost = ((taken, first, after) for taken in found for first, after in taken.lost)
    return schemas.Reception.model_validate(
        {
            "since": since if is_whole else min((receipt.received_at for receipt in receipts), default=since),
            "until": until,
            **_sums(receipts),
            "rejected": _added([receipt.rejected for receipt in receipts]),
            "waiting": sum(receipt.state == WAITING for receipt in receipts),
            "lost": [_lost(*gap) for gap in islice(lost, LOST)],
            "sessions": [_session(taken) for taken in found[:SHOWN_SESSIONS]],
            "rates": _rates([receipt for receipt in receipts if receipt.state == APPLIED]),
        }
    )


def _look(tx: ReadSession, device_pk: int, since: datetime) -> tuple[list[Taken], bool]:
    """Give what was taken in, the newest session first, and whether that is all of it.

    Sessions follow each other: where one from before the period has nothing in it, those before have neither.
    """
    found: list[Taken] = []
    left = MOST
    for session in _sessions(tx, device_pk):
        taken = _taken(tx, session, since, left)
        left -= taken.read + 1
        if taken.receipts:
            found.append(taken)
        elif session.created_at < since:
            return found, True
        if left <= 0:
            return found, False
    return found, True


def _sessions(tx: ReadSession, device_pk: int) -> Iterator[Beginning]:
    before = AFTER_ALL_SESSIONS
    while page := sessions.newest(tx, device_pk, before, SESSIONS):
        yield from page
        before = page[-1].pk


def _taken(tx: ReadSession, session: Beginning, since: datetime, most: int) -> Taken:
    rows, is_whole = _rows(tx, session.pk, since, most)
    inside = [receipt for receipt in rows if receipt.received_at >= since]
    gaps = _gaps(rows, since, from_start=is_whole and session.created_at >= since)
    return Taken(session, inside, list(gaps), len(rows))


def _rows(tx: ReadSession, session_pk: int, since: datetime, most: int) -> tuple[list[Receipt], bool]:
    """Read the receipts of a session back to a page before the period, or `most` and some; tell whether it is all."""
    rows: list[Receipt] = []
    before = AFTER_ALL_CHUNKS
    while len(rows) < most:
        page = chunks.newest(tx, session_pk, before, PAGE)
        rows += page
        if len(page) < PAGE:
            return rows, True
        if all(receipt.received_at < since for receipt in page):
            break
        before = page[-1].seq
    return rows, False


def _gaps(rows: list[Receipt], since: datetime, from_start: bool) -> Iterator[tuple[int, Receipt]]:
    """Find numbers missing before the applied chunks of the period, or before the first of a session."""
    applied = [receipt for receipt in rows if receipt.state == APPLIED]
    earlier = chain((receipt.seq for receipt in applied[1:]), [-1] if from_start else [])
    for receipt, seq in zip(applied, earlier, strict=False):
        if receipt.received_at >= since and receipt.seq > seq + 1:
            yield seq + 1, receipt


def _lost(taken: Taken, first: int, after: Receipt) -> dict[str, Any]:
    return {
        "session": taken.session.name,
        "from_seq": first,
        "to_seq": after.seq - 1,
        "before": after.received_at,
    }


def _session(taken: Taken) -> dict[str, Any]:
    return {
        "session": taken.session.name,
        "started_at": taken.session.started_at,
        "first_seq": taken.receipts[-1].seq,
        "last_seq": taken.receipts[0].seq,
        **_sums(taken.receipts),
    }


def _sums(receipts: list[Receipt]) -> dict[str, int]:
    return {
        "chunks": len(receipts),
        "samples": sum(receipt.samples for receipt in receipts),
        "fixes": sum(receipt.fixes for receipt in receipts),
    }


def _added(counts: list[dict[str, int]]) -> dict[str, int]:
    total: Counter[str] = Counter()
    for rejected in counts:
        total.update(rejected)
    return dict(total)


def _rates(receipts: list[Receipt]) -> dict[str, Any]:
    receipts = sorted(receipts, key=lambda receipt: receipt.received_at)
    if len(receipts) > ROWS:
        receipts = [receipts[i] for i in history.evenly(len(receipts), ROWS)]
    rates = [last_data.rates(receipt.samples, receipt.fixes, _span(receipt)) for receipt in receipts]
    return {
        "time": [receipt.received_at for receipt in receipts],
        "sample_rate_hz": [samples for samples, _ in rates],
        "fix_rate_hz": [fixes for _, fixes in rates],
        "rejected": [sum(receipt.rejected.values()) for receipt in receipts],
    }


def _span(receipt: Receipt) -> float | None:
    return None if receipt.t_first is None or receipt.t_last is None else receipt.t_last - receipt.t_first
