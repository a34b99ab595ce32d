"""Queries find what they look for by an index, in the order in which it is wanted, however much there is."""

from collections.abc import Callable
from datetime import UTC, datetime, timedelta
from functools import partial
from itertools import pairwise, product

import pytest

from storage import (
    alerts,
    chunks,
    coarse_estimates,
    device_lists,
    devices,
    estimates,
    events,
    installations,
    leases,
    motion_events,
    mounts,
    raw_chunks,
    retention,
    sessions,
    standing,
)
from storage.database import Database, ReadSession, WriteSession
from storage.device_lists import Filter, Place
from storage.leases import Lease
from storage.migrate import upgrade
from tests.plans import WAYS, explain, reads_whole_tables, statements

NOW = datetime(2024, 5, 6, 7, 8, 9, tzinfo=UTC)
PERIOD = (NOW - timedelta(days=30), NOW)

INSTALLATION: installations.Installation = installations.Installation(
    1, None, None, "waiting", 1, 0.0, NOW, {}, last_data_at=None, revision=0
)
LISTS: dict[str, Callable[[ReadSession], object]] = {
    "alerts": lambda tx: alerts.page(tx, 101, None, alerts.Filter()),
    "alerts from a place": lambda tx: alerts.page(tx, 101, alerts.Place(NOW, 7), alerts.Filter()),
    "alerts in a state": lambda tx: alerts.page(tx, 101, alerts.Place(NOW, 7), alerts.Filter(state="open")),
    "alerts of a kind": lambda tx: alerts.page(tx, 101, alerts.Place(NOW, 7), alerts.Filter(kind="gps_lost")),
    "alerts of a severity": lambda tx: alerts.page(tx, 101, None, alerts.Filter(severity="critical")),
    "alerts of a device": lambda tx: alerts.page(tx, 101, None, alerts.Filter(device_id="a")),
    "alerts since": lambda tx: alerts.page(tx, 101, None, alerts.Filter(since=NOW)),
    "events of a device": lambda tx: motion_events.page(tx, 1, 101, None, motion_events.Filter()),
    "events from a place": lambda tx: motion_events.page(
        tx, 1, 101, motion_events.Place(NOW, 7), motion_events.Filter()
    ),
    "events of a kind": lambda tx: motion_events.page(tx, 1, 101, None, motion_events.Filter(kind="impact")),
    "events of a period": lambda tx: motion_events.page(tx, 1, 101, None, motion_events.Filter(*PERIOD)),
    "alerts until": lambda tx: alerts.page(tx, 101, None, alerts.Filter(until=NOW)),
}
ORDERS = {
    "id": Place("m"),
    "name": Place("m", "m"),
    "-name": Place("m", "m"),
    "last_data_at": Place("m", NOW),
    "-last_data_at": Place("m"),
}
"""of devices, and a place in each"""
FILTERS = (
    Filter(),
    Filter(stage="waiting"),
    Filter(has_open_alert=True),
    Filter(has_open_alert=False),
    Filter(alert_kind="gps_lost"),
    Filter(alert_severity="critical"),
    Filter(stage="waiting", alert_kind="gps_lost", alert_severity="critical"),
    Filter(stage="waiting", has_open_alert=False),
    Filter(q="x"),
    Filter(q="x", stage="waiting", alert_severity="critical"),
)
"""of devices"""
KEYS = ("device_id=?", "device_pk=?", "SEARCH devices_1 USING INTEGER PRIMARY KEY (rowid=?)")
"""by which something of a single device is looked up, the last one its text"""
LOOKS: dict[str, Callable[[WriteSession], object]] = {
    "counts of alerts": alerts.counts,
    "devices by severity": alerts.devices_by_severity,
    "a device by severity": lambda tx: alerts.devices_by_severity(tx, 1),
    "suspect mountings": mounts.suspects,
    "a suspect mounting": lambda tx: mounts.suspects(tx, 1),
    "counts of a device's alerts": lambda tx: alerts.counts(tx, 1),
    "beside an installation": lambda tx: installations.beside(tx, INSTALLATION),
    "what an upload has to know": lambda tx: standing.find(tx, 1, "a"),
    "extent of history": lambda tx: estimates.extent(tx, 1, PERIOD),
    "all history": lambda tx: estimates.blocks(tx, 1, PERIOD, None),
    "some history": lambda tx: estimates.blocks(tx, 1, PERIOD, 60.0),
    "oldest history": lambda tx: estimates.device_of_oldest(tx, NOW),
    "old history of a device": lambda tx: estimates.old_blocks(tx, 1, NOW, 100),
    "removed history": lambda tx: estimates.remove(tx, [1, 2]),
    "extent of coarse history": lambda tx: coarse_estimates.seconds(tx, 1, (1, 30)),
    "coarse history": lambda tx: coarse_estimates.blocks(tx, 1, (1, 30), sketch=False),
    "sketch of history": lambda tx: coarse_estimates.blocks(tx, 1, (1, 30), sketch=True),
    "receipts that go": lambda tx: retention.receipts(tx, NOW, 100),
    "deliveries that go": lambda tx: retention.deliveries(tx, NOW, 100),
    "audit that goes": lambda tx: retention.audit_trail(tx, NOW, 100),
    "coarse history that goes": lambda tx: retention.coarse_history(tx, 5, 100),
    "events that go": lambda tx: events.forget(tx, NOW, 100),
    "newest receipts of a session": lambda tx: chunks.newest(tx, 1, 5, 100),
    "newest sessions of a device": lambda tx: sessions.newest(tx, 1, 5, 100),
    "sessions that wait": lambda tx: chunks.sessions_waiting(tx, 1, 5),
    "devices that wait": lambda tx: chunks.devices_waiting_since(tx, NOW, NOW),
    "events whose session began earlier": lambda tx: motion_events.move(tx, 1, timedelta(seconds=1)),
    "an event": lambda tx: motion_events.find(tx, 1, 1),
    "samples of a period": lambda tx: raw_chunks.stretches(tx, 1, *PERIOD),
    "all samples": lambda tx: raw_chunks.stretches(tx, 1, None, None),
    "newest samples": lambda tx: raw_chunks.newest(tx, 1),
    "samples of a chunk": lambda tx: raw_chunks.content(tx, 1, 1),
    "samples that go": lambda tx: raw_chunks.remove(tx, NOW, (10.0, 10.0), 100),
    "the mounting of a time": lambda tx: mounts.before(tx, 1, NOW),
    "a lease": lambda tx: leases.take(tx, "x", Lease("me", NOW), NOW, NOW),
}


@pytest.fixture
def tables(database: Database) -> Database:
    upgrade(database)
    return database


def look(tables: Database, query: Callable[[WriteSession], object]) -> list[str]:
    with tables.write() as tx:
        if tx.is_postgresql:
            tx.connection.exec_driver_sql("SET LOCAL enable_seqscan = off")  # tables are empty: it is what can be done
        with statements(tx.connection) as ran:
            query(tx)
            tx.run_all()
        steps = [step for statement in ran if not statement[0].startswith("INSERT") for step in explain(tx, statement)]
    assert steps
    return steps


@pytest.mark.parametrize("name", LISTS)
def test_lists_come_in_the_order_of_an_index(tables: Database, name: str) -> None:
    steps = look(tables, LISTS[name])
    assert not [step for step in steps if "TEMP B-TREE" in step], steps
    assert not reads_whole_tables(steps), steps


@pytest.mark.parametrize("name", LOOKS)
def test_nothing_reads_whole_tables(tables: Database, name: str) -> None:
    steps = look(tables, LOOKS[name])
    assert not reads_whole_tables(steps), steps


@pytest.mark.parametrize("backend", ["sqlite"], indirect=True)
def test_samples_that_go_are_found_without_those_that_stay(tables: Database) -> None:
    """However many are kept for ever; whether one is near an impact is looked up among the impacts."""
    with tables.write() as tx:
        raw_chunks.add(tx, _chunk(tx))
    steps = look(tables, LOOKS["samples that go"])
    assert any("raw_chunks USING INDEX ix_raw_chunks_may_go" in step for step in steps), steps
    assert any("motion_events USING INDEX ix_motion_events_session_pk_kind_t" in step for step in steps), steps


def _chunk(tx: WriteSession) -> raw_chunks.RawChunk:
    device_pk = devices.add(tx, "a", {"name": "A"}, NOW)
    return raw_chunks.RawChunk(1, 0, device_pk, 0.0, 1.0, NOW - timedelta(days=9), "t", b"")


@pytest.mark.parametrize("backend", ["sqlite"], indirect=True)
def test_open_alerts_of_a_device_are_found_among_open_alerts(tables: Database) -> None:
    """Not among all its alerts, which are kept for ever."""
    steps = look(tables, LOOKS["beside an installation"])
    assert any("ix_alerts_unresolved_device_id" in step for step in steps), steps


@pytest.mark.parametrize("backend", ["sqlite"], indirect=True)
def test_what_waits_is_looked_for_among_what_waits(tables: Database) -> None:
    """Not among all receipts of the device, or of that age; on every upload, and every few seconds."""
    for name in ("sessions that wait", "devices that wait"):
        steps = look(tables, LOOKS[name])
        assert any("chunks USING INDEX ix_chunks_waiting" in step for step in steps), steps


@pytest.mark.parametrize("way", WAYS)
def test_devices_come_in_the_order_of_an_index(
    tables: Database, way: dict[str, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whether a filter's devices begin the search, are made a set of, or are looked up one by one.

    Only what begins the search is sorted, and always the devices of the page; nothing but a text is looked at in the
    tables' rows on the way, which are long and anywhere, nor among the alerts that are over.
    """
    for name, number in way.items():
        monkeypatch.setattr(device_lists, name, number)
    for sort, wanted, place in product(ORDERS, FILTERS, (True, False)):
        after = ORDERS[sort] if place else None
        steps = look(tables, partial(device_lists.page, limit=101, after=after, wanted=wanted, sort=sort))
        told = (sort, wanted, place, steps)
        assert not reads_whole_tables(steps), told
        if tables.is_sqlite:
            pages = sum(" mounts " in step for step in steps)
            assert not way or sum("TEMP B-TREE" in step for step in steps) <= pages, told
            assert all("COVERING" in step for step in steps if step.startswith("SCAN ") and step != "SCAN some"), told
            assert all("ix_alerts_unresolved" in step for step in steps if " alerts " in step), told
            looked_up = [step for before, step in pairwise(steps) if before.startswith("CORRELATED")]
            assert all(any(key in step for key in KEYS) for step in looked_up), told
