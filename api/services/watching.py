"""Watching the devices: every chunk goes past the rules, and now and then a job looks for devices that send nothing."""

import logging
from datetime import datetime

from api.services import alerting, publishing, rules
from api.services.context import Context
from api.services.rules import Limits, Seen, Watch, device_silent
from storage import installations
from storage.alerts import find_open
from storage.database import WriteSession
from storage.installations import Installation

log = logging.getLogger(__name__)

BATCH = 100
"""devices looked up at once; each is then a transaction of its own"""


def observe(tx: WriteSession, context: Context, row: Installation, seen: Seen, now: datetime) -> Watch:
    """Let the rules see a chunk that has just been applied, raise and end alerts; give what they remember."""
    watch = _first(tx, row.device_pk) if row.watch is None else row.watch
    watch, said = rules.step(watch, seen, Limits.of(context.settings))
    for kind, verdict in said:
        if isinstance(verdict, rules.Finding):
            alerting.raise_(tx, context, row.device_pk, verdict, now)
        elif verdict is not None:
            alerting.end(tx, row.device_pk, [kind], verdict.note, now)
    return watch


def _first(tx: WriteSession, device_pk: int) -> Watch:
    """Begin to watch: alerts may be open already, from before there were rules."""
    kinds = [rule.kind for rule in rules.RULES]
    return rules.opened({}, [alert.kind for alert in find_open(tx, device_pk, kinds)])


def find_silent(context: Context) -> None:
    """Raise an alert for every device that has sent before and sends nothing for long; called now and then."""
    after = 0
    while batch := _silent(context, after, BATCH):
        for _, device_id in batch:
            try:
                _tell_silent(context, device_id)
            except Exception:
                log.exception("device %s: that it is silent cannot be told", device_id)
        after = batch[-1][0]


def _silent(context: Context, after: int, limit: int) -> list[tuple[int, str]]:
    before = context.clock() - Limits.of(context.settings).silent
    with context.database.read() as tx:
        return installations.silent(tx, device_silent.KIND, before, after, limit)


def _tell_silent(context: Context, device_id: str) -> None:
    """Raise the alert, if it is still called for once the device is locked."""
    now, silent = context.clock(), Limits.of(context.settings).silent
    with context.database.write() as tx:
        row = installations.lock(tx, device_id)
        if row is None or row.last_data_at is None:
            return
        found = installations.silent(tx, device_silent.KIND, now - silent, row.device_pk - 1, 1)
        if [pk for pk, _ in found] != [row.device_pk]:
            return
        alerting.raise_(tx, context, row.device_pk, device_silent.finding(row.last_data_at, now, silent), now)
        installations.remember(tx, row.device_pk, rules.opened(row.watch or {}, [device_silent.KIND]))
        publishing.installation_touched(tx, row, device_id, context.params, now)
    context.wake()
