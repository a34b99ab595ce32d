"""Sends what webhooks wait for. Any number of processes may do it at once.

Every attempt is claimed, made, and settled: two short transactions with the call between them. A process that dies in
between leaves a claim that runs out, so a message may come twice, with the same `webhook-id`, but is never lost.
"""

import logging
import random
from datetime import datetime, timedelta

import anyio
from anyio import CapacityLimiter, to_thread

from api.services.context import Context
from api.services.webhooks_queue import SCHEDULE
from api.services.webhooks_sending import GONE, Result, Sender
from storage import deliveries, webhooks
from storage.database import WriteSession
from storage.deliveries import Delivery
from storage.webhooks import Webhook

log = logging.getLogger(__name__)

INTERVAL = 1.0
"""s between two looks for deliveries that are due"""
CALLS, CALLS_PER_WEBHOOK = 16, 4
"""calls at once of this process, in all and of one webhook: a slow receiver does not hold up the others"""
CLAIM = timedelta(seconds=90)
"""How long an attempt is left to the process that claimed it: longer than a call takes, with a slow name server."""
JITTER = 0.1
"""share by which a wait is lengthened at random, so that a receiver that comes back is not met by all at once"""

OUTAGE = timedelta(minutes=5)
"""A webhook that failed for so long and then works was down: what waits for its next attempt need not wait longer. One
that fails for a message now and then is not hurried, which would use that message's attempts up."""


class Dispatcher:
    """Makes the calls of one process."""

    def __init__(self, context: Context, sender: Sender) -> None:
        self.context = context
        self.sender = sender
        self.limiter = CapacityLimiter(CALLS)
        self.busy: set[int] = set()

    async def run(self) -> None:
        """Send until cancelled."""
        async with anyio.create_task_group() as tasks:
            while True:
                try:
                    due = await to_thread.run_sync(self.waiting)
                except Exception:
                    log.exception("deliveries of webhooks cannot be read")
                    due = []
                for pk in set(due) - self.busy:
                    self.busy.add(pk)
                    tasks.start_soon(self._drain, pk)
                await anyio.sleep(INTERVAL)

    async def _drain(self, pk: int) -> None:
        """Send what is due for a webhook."""
        try:
            async with anyio.create_task_group() as tasks:
                for _ in range(CALLS_PER_WEBHOOK):
                    tasks.start_soon(self._follow, pk)
        finally:
            self.busy.discard(pk)

    async def _follow(self, pk: int) -> None:
        try:
            while await to_thread.run_sync(self.send_next, pk, limiter=self.limiter):
                pass
        except Exception:
            log.exception("a delivery of webhook %d failed; it is tried again", pk)

    def waiting(self) -> list[int]:
        """Give the webhooks for which something is due."""
        with self.context.database.read() as tx:
            return deliveries.waiting_webhooks(tx, self.context.clock())

    def send_next(self, pk: int) -> bool:
        """Make one attempt for a webhook; False when nothing is due."""
        claimed = self._claim(pk)
        if claimed is None:
            return False
        webhook, delivery = claimed
        sent_at = self.context.clock()
        result = self.sender.send(webhook, delivery.message_id, delivery.payload, sent_at)
        with self.context.database.write() as tx:
            settle(tx, delivery, result, self.context.clock())
        return True

    def _claim(self, pk: int) -> tuple[Webhook, Delivery] | None:
        now = self.context.clock()
        with self.context.database.write() as tx:
            webhook = webhooks.find(tx, pk)
            if webhook is None or not webhook.active:
                return None
            delivery = deliveries.claim(tx, pk, now, now + CLAIM)
        return None if delivery is None else (webhook, delivery)


def settle(tx: WriteSession, delivery: Delivery, result: Result, now: datetime) -> None:
    """Store how an attempt ended, on the webhook first: all who change both do it in this order."""
    pk = delivery.webhook_pk
    if result.delivered:
        succeeded(tx, pk, now)
    else:
        webhooks.failed(tx, pk, now)
    if result.status == GONE:
        webhooks.change(tx, pk, {"active": False})
        log.warning("webhook %d is gone, as its receiver says (410), and was switched off", pk)
    deliveries.settle(tx, after(delivery, result, now))


def succeeded(tx: WriteSession, pk: int, now: datetime) -> None:
    """A call went well; after an outage, everything that waits for its next attempt is due at once."""
    before = webhooks.find(tx, pk)
    webhooks.succeeded(tx, pk, now)
    if before is not None and before.failing_since is not None and now - before.failing_since >= OUTAGE:
        deliveries.hasten(tx, pk, now)


def after(delivery: Delivery, result: Result, now: datetime) -> Delivery:
    """Give a delivery as it is after an attempt."""
    attempts = delivery.attempts + 1
    retry = not result.delivered and result.status != GONE and now < delivery.give_up_at
    state = deliveries.DELIVERED if result.delivered else deliveries.PENDING if retry else deliveries.FAILED
    return delivery._replace(
        state=state,
        attempts=attempts,
        next_attempt_at=now + wait(attempts, result) if retry else None,
        last_attempt_at=now,
        last_status=result.status,
        last_error=result.error,
        duration_ms=result.duration_ms,
    )


def wait(attempts: int, result: Result) -> timedelta:
    """Give the time until the next attempt: by the schedule, or longer when the receiver asks for it."""
    seconds = SCHEDULE[min(attempts, len(SCHEDULE)) - 1] * random.uniform(1.0, 1.0 + JITTER)  # noqa: S311
    return max(timedelta(seconds=seconds), result.retry_after or timedelta(0))


async def run(context: Context) -> None:
    """Send the deliveries of webhooks until cancelled."""
    sender = await to_thread.run_sync(Sender, context.settings.webhook_allow_private)
    with sender:
        await Dispatcher(context, sender).run()
