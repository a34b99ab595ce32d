"""What is done now and then: gaps declared lost, silent devices found, old rows removed.

Any number of processes may do it at once.
"""

import logging
from collections.abc import Callable
from datetime import timedelta

import anyio
from anyio import to_thread

from api.services import ingest, watching, webhooks_dispatch
from api.services.context import Context
from storage import audit, chunks, deliveries, estimates, events, sign_ins

log = logging.getLogger(__name__)

GAP_INTERVAL = 5.0
"""s between two looks for gaps that have been open too long"""
SILENT_INTERVAL = 60.0
"""s between two looks for devices that send nothing"""
TIDY_INTERVAL = 300.0
"""s between two removals of old rows"""
USES_INTERVAL = 60.0
"""s between two times at which the last use of the keys is written"""


def write_uses(context: Context) -> None:
    """Write when keys were last used."""
    context.uses.write(context.database)


def tidy(context: Context) -> None:
    """Remove what is kept no longer."""
    now, settings = context.clock(), context.settings
    oldest = now - timedelta(days=settings.history_days)
    with context.database.write() as tx:
        events.forget(tx, now - timedelta(minutes=settings.stream_minutes))
        estimates.forget(tx, oldest)
        chunks.forget(tx, oldest)
        deliveries.forget(tx, oldest)
        audit.forget(tx, now - timedelta(days=settings.audit_days))
        sign_ins.forget(tx, now)


def finish(context: Context) -> None:
    """Do at the end what should not be lost."""
    try:
        write_uses(context)
    except Exception:
        log.exception("when keys were last used cannot be written")


async def run(context: Context) -> None:
    """Keep house until cancelled."""
    async with anyio.create_task_group() as tasks:
        tasks.start_soon(_every, GAP_INTERVAL, ingest.close_gaps, context)
        tasks.start_soon(_every, SILENT_INTERVAL, watching.find_silent, context)
        tasks.start_soon(_every, TIDY_INTERVAL, tidy, context)
        tasks.start_soon(_every, USES_INTERVAL, write_uses, context)
        tasks.start_soon(webhooks_dispatch.run, context)


async def _every(seconds: float, work: Callable[[Context], None], context: Context) -> None:
    while True:
        try:
            await to_thread.run_sync(work, context)
        except Exception:
            log.exception("housekeeping failed; it is tried again in %.0f s", seconds)
        await anyio.sleep(seconds)
