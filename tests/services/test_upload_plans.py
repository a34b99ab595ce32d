"""No statement of an upload reads more the longer the service has been running."""

import re
from collections.abc import Iterator

import pytest
import sqlalchemy as sa

from api import schemas
from api.services import access, fleet, ingest, intake, startup
from api.services.context import Context
from api.settings import Settings
from storage import devices, webhooks
from storage.chunks import Body
from tests.conftest import Clock
from tests.crashes import crashed
from tests.drives import remounted
from tests.plans import explain, reads_whole_tables, statements

WRITTEN = {
    *("sessions", "chunks", "raw_chunks", "estimates", "mounts"),
    *("motion_events", "alerts", "events", "webhook_deliveries"),
}
FEW_ROWS = ("SCAN webhooks",)
"""tables of which a service has few rows, whatever its age"""
GAIN = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]


@pytest.fixture
def context(settings: Settings, clock: Clock) -> Iterator[Context]:
    made = Context.make(settings, clock)
    startup.prepare(made)
    yield made
    made.database.close()


def send(context: Context, key: str, body: bytes, seq: int, session: str = "a") -> str:
    device = access.authenticate(context, key).device_id
    assert device is not None
    sent = ingest.Chunk(session, seq, Body(body, "text/csv", None, "auto"))
    return intake.receive(context, device, sent).chunk.state


def send_everything(context: Context, clock: Clock, key: str) -> None:
    """Confirm, move, confirm anew; repeat; leave gaps that close in each of the ways; begin sessions."""
    bodies = remounted().chunks
    for seq, body in enumerate(bodies):
        assert send(context, key, body, seq) == "applied"
        clock.advance(30.0)
    assert send(context, key, bodies[0], 0) == "applied"
    assert send(context, key, bodies[1], 1, "b") == "waiting"
    assert send(context, key, bodies[0], 0, "b") == "applied"
    assert send(context, key, bodies[3], 3, "b") == "waiting"
    clock.advance(context.settings.gap_timeout + 1.0)
    ingest.close_gaps(context)
    assert send(context, key, bodies[5], 5, "b") == "waiting"
    assert send(context, key, bodies[0], 0, "c") == "applied"


@pytest.fixture
def plans(context: Context, clock: Clock) -> dict[str, list[str]]:
    """Give the steps of every statement of uploads."""
    key, other = (fleet.register(context, schemas.DeviceDraft(id=name, name=name)).key for name in "ab")
    with context.database.write() as tx:
        devices.edit(tx, fleet.number(tx, "a"), {"accelerometer_calibration": {"gain": GAIN, "offset": [0.0] * 3}})
        webhooks.add(tx, {"name": "w", "url": "https://example.com/", "active": True}, "secret", "x", clock())
    with statements(sa.Engine) as ran:
        send_everything(context, clock, key)
        for seq, body in enumerate(crashed().chunks):
            assert send(context, other, body, seq) == "applied"
    with context.database.write() as tx:
        if tx.is_postgresql:
            tx.connection.exec_driver_sql("SET LOCAL enable_seqscan = off")  # the tables are small
        return {text: explain(tx, (text, values)) for text, values in dict[str, object](ran).items()}


def steps_on(plans: dict[str, list[str]], table: str) -> list[str]:
    """Give the steps of statements that read or change a table."""
    texts = [text for text in plans if f"FROM {table} " in text or text.startswith(f"UPDATE {table} ")]
    return [step for text in texts for step in plans[text]]


def test_uploads_find_everything_by_an_index(plans: dict[str, list[str]]) -> None:
    written = {table for text in plans for table in re.findall(r"INSERT INTO (\w+)", text)}
    assert written == WRITTEN
    whole = {text: reads_whole_tables(steps) for text, steps in plans.items()}
    assert {step for steps in whole.values() for step in steps} <= set(FEW_ROWS)


def test_former_mountings_and_alerts_are_not_read(plans: dict[str, list[str]]) -> None:
    """However many a device has had: the current mounting and the open alerts have indexes of their own."""
    unread = ("ix_alerts_device_pk_opened_at_pk", "pk_mounts", "sqlite_autoindex_mounts_1")
    read = [step for table in ("mounts", "alerts") for step in steps_on(plans, table)]
    assert any("uq_mounts_current" in step for step in read)
    assert any("alerts_unresolved" in step for step in read)
    newest = {text for text in plans if text.startswith("SELECT max(mounts.n)")}
    others = {text: steps for text, steps in plans.items() if text.startswith(("SELECT", "UPDATE"))}
    found = [(step, text) for text, steps in others.items() if text not in newest for step in steps]
    assert not [pair for pair in found if any(name in pair[0] for name in unread)]
