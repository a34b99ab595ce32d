"""How long things are kept. History ages from fine to coarse; then it goes, like everything that is kept no longer.

Each call is a transaction or a few, small and complete in themselves: one that is broken off has done nothing, and one
that is done twice finds nothing left to do.
"""

from collections.abc import Callable
from datetime import UTC, datetime, time, timedelta
from itertools import groupby

import numpy as np

from api.services.context import Context
from api.services.history import SKETCH
from api.services.history_rows import Rows, spaced, unpack
from core.motion.events import SECONDS_AFTER, SECONDS_BEFORE
from storage import coarse_estimates, estimates, events, raw_chunks, retention
from storage.coarse_estimates import Day, day_of
from storage.database import WriteSession
from storage.estimates import OldBlock
from storage.models import MICROSECOND, microseconds

BLOCKS = 300
"""blocks of fine history made coarse in one transaction"""
ROWS = 1000
"""rows removed in one transaction"""
RAW_ROWS = 50
"""the same of samples, which are some 100 kB each"""
COARSE = 60.0
"""s between two rows of coarse history"""
DAY_US = timedelta(days=1) // MICROSECOND


def coarsen(context: Context) -> bool:
    """Turn the oldest fine history of a device into coarse history, by whole days; True when more may be left."""
    before = datetime.combine(_ago(context, context.settings.history_days).date(), time(), UTC)
    with context.database.read() as tx:
        device_pk = estimates.device_of_oldest(tx, before)
    if device_pk is None:
        return False
    with context.database.write() as tx:
        blocks = estimates.old_blocks(tx, device_pk, before, BLOCKS)
        for (day, session_pk), rows in _by_day(blocks):
            _add(tx, device_pk, day, session_pk, rows)
        estimates.remove(tx, [block.pk for block in blocks])
    return True


def _by_day(blocks: list[OldBlock]) -> list[tuple[tuple[int, int], Rows]]:
    """Give the rows of blocks by day and session, in the order of time."""
    found = []
    ordered = sorted(blocks, key=lambda block: (block.session_pk, block.pk))
    for session_pk, of_session in groupby(ordered, lambda block: block.session_pk):
        group = list(of_session)
        rows = unpack([block.rows for block in group])
        day = (microseconds(group[0].started_at) + np.rint(rows["t"] * 1e6).astype(np.int64)) // DAY_US
        found += [((int(number), session_pk), rows[day == number]) for number in np.unique(day)]
    return found


def _add(tx: WriteSession, device_pk: int, day: int, session_pk: int, rows: Rows) -> None:
    """Append to what is known of a day."""
    rows = unpack([coarse_estimates.rows(tx, device_pk, day, session_pk), rows.tobytes()])
    rows = rows[spaced(rows, COARSE)]
    sketch = rows[spaced(rows, SKETCH)].tobytes()
    span = (float(rows["t"][0]), float(rows["t"][-1]))
    coarse_estimates.put(tx, Day(device_pk, day, session_pk, *span, sketch, rows.tobytes()))


def tidy(context: Context) -> bool:
    """Remove some of what is kept no longer; True when more may be left."""
    settings = context.settings
    last_day = day_of(_ago(context, settings.coarse_history_days))
    left = [
        _remove(context, lambda tx: events.forget(tx, _ago(context, settings.stream_minutes / 1440), ROWS)),
        _remove(context, lambda tx: retention.receipts(tx, _ago(context, settings.receipt_days), ROWS)),
        _remove(context, lambda tx: retention.deliveries(tx, _ago(context, settings.delivery_days), ROWS)),
        _remove(context, lambda tx: retention.audit_trail(tx, _ago(context, settings.audit_days), ROWS)),
        _remove(context, lambda tx: retention.ended_sign_ins(tx, context.clock(), ROWS)),
        _remove(context, lambda tx: retention.coarse_history(tx, last_day, ROWS)),
    ]
    return any(left)


def forget_samples(context: Context) -> bool:
    """Remove some of the samples kept no longer, but for those around an impact; True when more may be left."""
    before = _ago(context, context.settings.raw_retention_days)
    with context.database.write() as tx:
        return raw_chunks.remove(tx, before, (SECONDS_BEFORE, SECONDS_AFTER), RAW_ROWS) >= RAW_ROWS


def _remove(context: Context, work: Callable[[WriteSession], int]) -> bool:
    with context.database.write() as tx:
        return work(tx) >= ROWS


def _ago(context: Context, days: float) -> datetime:
    return context.clock() - timedelta(days=days)
