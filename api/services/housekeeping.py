"""What is done now and then: a table of jobs.

Most are done by the leader alone. All of them may be broken off anywhere and done twice: each call is one small
transaction, or several, so that no upload waits long for them.
"""

import logging
from collections.abc import Callable
from typing import NamedTuple

import anyio
from anyio import CancelScope, to_thread

from api.services import ingest, retention, watching, webhooks_dispatch
from api.services.context import Context
from api.services.leading import Leadership

log = logging.getLogger(__name__)


class Job(NamedTuple):
    """Something done now and then; `work` returns True when there is more to do at once."""

    name: str
    interval: float
    """s between two calls"""
    work: Callable[[Context], bool | None]
    leader_only: bool = True


def write_uses(context: Context) -> bool:
    """Write when some keys were last used; True when more are left."""
    return context.uses.write(context.database)


JOBS = (
    Job("gaps open too long", 5.0, ingest.close_gaps),
    Job("devices that send nothing", 60.0, watching.find_silent),
    Job("last uses of keys", 60.0, write_uses, leader_only=False),
    Job("fine history to coarse", 60.0, retention.coarsen),
    Job("rows kept no longer", 60.0, retention.tidy),
    Job("samples kept no longer", 60.0, retention.forget_samples),
)
PAUSE = 0.05
"""s between two calls of a job that has more to do, in which others may write"""


async def run(context: Context) -> None:
    """Keep house until cancelled."""
    leadership = Leadership(context)
    try:
        async with anyio.create_task_group() as tasks:
            for job in JOBS:
                tasks.start_soon(_repeat, job, context, leadership)
            tasks.start_soon(webhooks_dispatch.run, context)
    finally:
        with CancelScope(shield=True):
            await to_thread.run_sync(_resign, leadership)


def finish(context: Context) -> None:
    """Do at the end what should not be lost."""
    try:
        while write_uses(context):
            continue
    except Exception:
        log.exception("when keys were last used cannot be written")


def do(job: Job, context: Context, leadership: Leadership) -> bool:
    """Call a job once, if it is for this process to do; True when there is more to do."""
    if job.leader_only and not leadership.held():
        return False
    return job.work(context) is True


async def _repeat(job: Job, context: Context, leadership: Leadership) -> None:
    while True:
        more = False
        try:
            more = await to_thread.run_sync(do, job, context, leadership)
        except Exception:
            log.exception("housekeeping failed (%s); it is tried again in %.0f s", job.name, job.interval)
        await anyio.sleep(PAUSE if more else job.interval)


def _resign(leadership: Leadership) -> None:
    try:
        leadership.give_up()
    except Exception as error:
        log.warning("the lease runs out by itself, it could not be given up: %s", type(error).__name__)
