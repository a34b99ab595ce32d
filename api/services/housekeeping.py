"""What is done now and then: gaps declared lost, silent devices found, old rows removed.

Any number of processes may do it at once.
"""

import logging
from collections.abc import Callable
from datetime import timedelta

import anyio
from anyio import to_thread

from api.services import ingest, watching
from api.services.context import Context
from storage import chunks, estimates, events

log = logging.getLogger(__name__)

GAP_INTERVAL = 5.0
"""s between two looks for gaps that have been open too long"""
SILENT_INTERVAL = 60.0
"""s between two looks for devices that send nothing"""
TIDY_INTERVAL = 300.0
"""s between two removals of old rows"""


def tidy(context: Context) -> None:
    """Remove what is kept no longer."""
    now, settings = context.clock(), context.settings
    oldest = now - timedelta(days=settings.history_days)
    with context.database.write() as tx:
        events.forget(tx, now - timedelta(minutes=settings.stream_minutes))
        estimates.forget(tx, oldest)
        chunks.forget(tx, oldest)


async def run(context: Context) -> None:
    """Keep house until cancelled."""
    async with anyio.create_task_group() as tasks:
        tasks.start_soon(_every, GAP_INTERVAL, ingest.close_gaps, context)
        tasks.start_soon(_every, SILENT_INTERVAL, watching.find_silent, context)
        tasks.start_soon(_every, TIDY_INTERVAL, tidy, context)


async def _every(seconds: float, work: Callable[[Context], None], context: Context) -> None:
    while True:
        try:
            await to_thread.run_sync(work, context)
        except Exception:
            log.exception("housekeeping failed; it is tried again in %.0f s", seconds)
        await anyio.sleep(seconds)
