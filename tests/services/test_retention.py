"""What is kept and for how long: nothing is lost or doubled on the way from fine to coarse history."""

import threading
from collections.abc import Iterator
from datetime import datetime, timedelta
from typing import Any

import numpy as np
import pytest
import sqlalchemy as sa

from api import schemas
from api.services import fleet, history, retention, startup
from api.services.context import Context
from api.services.history_rows import ROW, Rows, spaced, unpack
from api.settings import Settings
from storage import devices
from storage.database import Database
from storage.models import audit, chunks, estimates, estimates_coarse, webhook_deliveries, webhooks
from tests import aged
from tests.conftest import Clock
from tests.drives import chunks as drive
from tests.faults.test_crash import crash_at, everything
from tests.service import Api

DAY = 86400.0


@pytest.fixture
def context(settings: Settings, clock: Clock) -> Iterator[Context]:
    made = Context.make(settings, clock)
    startup.prepare(made)
    yield made
    made.database.close()


def add_device(context: Context, device_id: str = "a") -> int:
    fleet.register(context, schemas.DeviceDraft(id=device_id, name="A"))
    with context.database.read() as tx:
        return fleet.number(tx, device_id)


def read(
    context: Context, pk: int, start: datetime | None = None, end: datetime | None = None, n: int = 100_000
) -> Any:
    with context.database.read() as tx:
        return history.read(tx, pk, start, end, n)


def count(context: Context, table: sa.Table) -> int:
    with context.database.read() as tx:
        return int(tx.value(sa.select(sa.func.count()).select_from(table)))


def coarsen_all(context: Context) -> int:
    n = 0
    while retention.coarsen(context):
        n += 1
    return n


def coarse(context: Context) -> list[Any]:
    with context.database.read() as tx:
        return [tuple(row) for row in tx.connection.execute(sa.select(estimates_coarse).order_by(sa.text("1, 2, 3")))]


# ---------------------------------------------------------------- fine to coarse


def test_old_history_becomes_a_point_a_minute(context: Context, clock: Clock) -> None:
    pk = add_device(context)
    aged.add_past(context.database, pk, clock(), 3, 2, 1.0)
    fine = read(context, pk)
    clock.advance(15 * DAY)
    assert coarsen_all(context) > 0
    told = read(context, pk)
    assert count(context, estimates) == 0
    assert len(fine.time) == 3 * 2 * 720
    assert len(told.time) == 3 * 2 * 60
    assert set(zip(told.time, told.session, strict=True)) <= set(zip(fine.time, fine.session, strict=True))
    assert (told.time[0], told.stage[0]) == (fine.time[0], fine.stage[0])
    assert fine.time[-1] - told.time[-1] < timedelta(minutes=1)
    gaps = np.diff([moment.timestamp() for moment in told.time])
    assert (gaps >= 60).all()


def test_history_stays_fine_for_as_long_as_it_is_said(context: Context, clock: Clock) -> None:
    pk = add_device(context)
    aged.add_past(context.database, pk, clock(), 20, 1, 0.5)
    coarsen_all(context)
    with context.database.read() as tx:
        oldest = tx.value(sa.select(sa.func.min(estimates.c.received_at)))
    kept = clock() - oldest
    assert timedelta(days=14) <= kept + timedelta(minutes=1)
    assert kept <= timedelta(days=15)


def test_both_tiers_are_read_as_one(context: Context, clock: Clock) -> None:
    pk = add_device(context)
    aged.add_past(context.database, pk, clock(), 20, 1, 1.0)
    before = read(context, pk)
    coarsen_all(context)
    assert count(context, estimates) > 0
    assert count(context, estimates_coarse) > 0
    after = read(context, pk)
    assert set(after.time) <= set(before.time)
    assert after.time == sorted(after.time)
    assert {moment.date() for moment in after.time} == {moment.date() for moment in before.time}
    seam = [moment for moment in after.time if abs(moment - (clock() - timedelta(days=14))) < timedelta(days=2)]
    window = read(context, pk, seam[0], seam[-1])
    assert window.time == seam


def test_a_chart_gives_both_tiers_their_share(context: Context, clock: Clock) -> None:
    """A day counts as a day, however many rows are stored of it."""
    pk = add_device(context)
    aged.add_past(context.database, pk, clock(), 28, 1, 2.0)
    coarsen_all(context)
    told = read(context, pk, n=500)
    assert 400 <= len(told.time) <= 500
    per_day = np.unique([moment.date().toordinal() for moment in told.time], return_counts=True)[1]
    assert per_day.size == 28
    assert per_day.min() > 0.6 * per_day.max()


def test_any_batches_give_the_same(context: Context, clock: Clock, monkeypatch: pytest.MonkeyPatch) -> None:
    pks = [add_device(context, name) for name in ("a", "b")]
    tables = []
    for pk, batch in zip(pks, (7, 10_000), strict=True):
        with context.database.write() as tx:
            aged.add_session(tx, pk, clock() - timedelta(hours=3), 3.0)
        clock.advance(15 * DAY)
        monkeypatch.setattr(retention, "BLOCKS", batch)
        assert coarsen_all(context) == -(-180 // batch)
        clock.advance(-15 * DAY)
        tables.append([(row[1], *row[3:]) for row in coarse(context) if row[0] == pk])
    assert tables[0] == tables[1]
    assert len(tables[0]) == 1


@pytest.mark.parametrize("seed", range(5))
def test_choosing_in_pieces_is_choosing_from_the_whole(seed: int) -> None:
    generator = np.random.default_rng(seed)
    rows = np.zeros(300, ROW)
    rows["t"] = np.cumsum(generator.exponential(20.0, rows.size))
    rows["stage"] = generator.integers(0, 8, rows.size) // 6 + 3
    whole = rows[spaced(rows, 60.0)]
    pieces: Rows = rows[:0]
    for piece in np.array_split(rows, np.sort(generator.integers(0, rows.size, 9))):
        joined = unpack([pieces.tobytes(), piece.tobytes()])
        pieces = joined[spaced(joined, 60.0)]
    assert pieces.tobytes() == whole.tobytes()
    changes = np.flatnonzero(np.diff(rows["stage"])) + 1
    assert set(rows["t"][changes]) <= set(whole["t"])


def test_a_crash_loses_and_doubles_nothing(context: Context, clock: Clock) -> None:
    """At any statement of it, and then it goes on where it was."""
    pk = add_device(context)
    with context.database.write() as tx:
        aged.add_session(tx, pk, clock() - timedelta(minutes=20), 1 / 3)
    clock.advance(15 * DAY)
    before = everything(context.database)
    n = 0
    while True:
        try:
            with crash_at(n) as statements:
                retention.coarsen(context)
            break
        except RuntimeError:
            assert everything(context.database) == before, statements[-1]
            n += 1
    assert n > 3
    (only,) = coarse(context)
    assert len(unpack([only[-1]])) == 20
    assert count(context, estimates) == 0
    assert retention.coarsen(context) is False


def test_two_leaders_at_once_double_nothing(context: Context, settings: Settings, clock: Clock) -> None:
    pk = add_device(context)
    with context.database.write() as tx:
        aged.add_session(tx, pk, clock() - timedelta(hours=6), 6.0)
    clock.advance(15 * DAY)
    other = Context.make(settings, clock)
    threads = [threading.Thread(target=coarsen_all, args=(each,)) for each in (context, other)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    other.database.close()
    assert count(context, estimates) == 0
    told = read(context, pk)
    assert len(told.time) == len(set(told.time)) == 360


def test_real_chunks_age_too(api: Api, settings: Settings, clock: Clock) -> None:
    device = api.add_device()
    for seq, body in enumerate(drive()):
        clock.advance(30)
        device.send(body, seq, expect=200)
    fine = device.get("estimates")
    clock.advance(15 * DAY)
    other = Context.make(settings, clock)
    assert coarsen_all(other) == 1
    other.database.close()
    told = device.get("estimates")
    assert 0 < len(told["time"]) < len(fine["time"]) / 3
    assert set(told["time"]) <= set(fine["time"])
    stages = {stage for n, stage in enumerate(fine["stage"])}
    assert set(told["stage"]) == stages


# ---------------------------------------------------------------- what goes


def test_coarse_history_goes_after_a_year(context: Context, clock: Clock) -> None:
    pk = add_device(context)
    aged.add_past(context.database, pk, clock(), 1, 1, 0.1)
    clock.advance(100 * DAY)
    coarsen_all(context)
    retention.tidy(context)
    assert count(context, estimates_coarse) == 1
    clock.advance(266 * DAY)
    retention.tidy(context)
    assert count(context, estimates_coarse) == 0


def test_the_rest_goes_by_its_setting_a_few_rows_at_a_time(
    context: Context, clock: Clock, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(retention, "ROWS", 10)
    pk = add_device(context)
    told = count(context, audit)
    now = clock()
    with context.database.write() as tx:
        session_pk = aged.add_session(tx, pk, now, 0.0)
        _add_rows(tx.connection, session_pk, now)
    clock.advance(15 * DAY)
    assert _tidied(context) == 3
    assert (count(context, chunks), count(context, webhook_deliveries), count(context, audit)) == (1, 25, told + 25)
    clock.advance(16 * DAY)
    assert _tidied(context) == 3
    assert (count(context, webhook_deliveries), count(context, audit)) == (0, told + 25)
    clock.advance(700 * DAY)
    assert _tidied(context) == 3
    assert count(context, audit) == 0
    with context.database.read() as tx:
        assert tx.value(sa.select(chunks.c.state)) == "waiting"


def _tidied(context: Context) -> int:
    n = 1
    while retention.tidy(context):
        n += 1
    return n


def _add_rows(connection: sa.Connection, session_pk: int, now: datetime) -> None:
    receipt = {"digest": "d", "samples": 1, "fixes": 0, "rejected": {}, "received_at": now, "session_pk": session_pk}
    receipts = [receipt | {"seq": seq, "state": "applied" if seq else "waiting"} for seq in range(26)]
    hook = {"url": "https://x", "name": "x", "secret": "x", "active": True, "created_at": now}
    connection.execute(sa.insert(chunks), receipts)
    webhook_pk = connection.execute(sa.insert(webhooks).returning(webhooks.c.pk), hook).scalar_one()
    delivery = {"webhook_pk": webhook_pk, "type": "t", "payload": "", "attempts": 1, "created_at": now, "claims": 0}
    delivery |= {"state": "delivered", "give_up_at": now}
    connection.execute(sa.insert(webhook_deliveries), [delivery | {"message_id": str(n)} for n in range(25)])
    entry = {"at": now, "actor": "x", "role": "admin", "action": "x"}
    connection.execute(sa.insert(audit), [entry] * 25)


def test_a_duplicate_after_its_receipt_went_is_refused_and_changes_nothing(
    api: Api, settings: Settings, clock: Clock, database: Database
) -> None:
    device = api.add_device()
    device.send_all(drive()[:2])
    assert device.send(drive()[0], 0, expect=200).json()["chunk"]["duplicate"]
    clock.advance(15 * DAY)
    other = Context.make(settings, clock)
    retention.tidy(other)
    other.database.close()
    before = device.installation()
    problem = device.send(drive()[0], 0, expect=409).json()
    assert problem["type"].endswith("sequence-passed")
    assert "came in long ago" in problem["detail"]
    assert device.installation() == before
    assert device.send(drive()[2], 2, expect=200).json()["chunk"]["state"] == "applied"


def test_nothing_else_goes(api: Api, settings: Settings, clock: Clock, database: Database) -> None:
    """Devices, sessions, mountings and alerts stay for ever."""
    device = api.add_device()
    device.send_all(drive())
    kept = device.get("mounts")["items"]
    assert kept
    clock.advance(4000 * DAY)
    other = Context.make(settings, clock)
    coarsen_all(other)
    assert _tidied(other) == 1
    other.database.close()
    assert device.get("mounts")["items"] == kept
    assert device.get("estimates")["time"] == []
    with database.read() as tx:
        assert devices.exists(tx, device.id) is not None
    device.send(drive()[0], 0, expect=409)
