"""Lists give what their filters say, each item once, in order, whatever pages it is read in."""

import random
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from itertools import product
from typing import Any, NamedTuple

import pytest

from storage import alerts, devices, installations
from storage.alerts import Alert, Filter, Finding, Place
from storage.database import Database, WriteSession
from storage.installations import Installation
from storage.migrate import upgrade

NOW = datetime(2024, 5, 6, 7, 8, 9, tzinfo=UTC)
STAGES = ("waiting", "confirmed")


class Known(NamedTuple):
    id: str
    text: str
    stage: str
    alerted: bool


@pytest.fixture
def tables(database: Database) -> Database:
    upgrade(database)
    return database


@pytest.fixture
def fleet(tables: Database) -> list[Known]:
    generator = random.Random(1)
    with tables.write() as tx:
        return sorted(_add(tx, generator, n) for n in range(80))


def _add(tx: WriteSession, generator: random.Random, n: int) -> Known:
    device_id, name, stage = f"{generator.randrange(10**6):06d}", f"Box {n % 7} ÄÖ", generator.choice(STAGES)
    pk = devices.add(tx, device_id, {"name": name, "notes": "under_the%seat" if n % 5 == 0 else None}, NOW)
    installations.add(tx, Installation(pk, None, None, stage, None, None, NOW, {}, last_data_at=None, revision=0))
    alerted = generator.random() < 0.3
    for kind in ("gps_lost", "sensor_fault", "clock_fault")[: 3 * alerted]:
        alerts.raise_(tx, pk, Finding(kind, "warning", "", {}), NOW)
    for kind in ("device_loose",):
        alerts.resolve(tx, alerts.raise_(tx, pk, Finding(kind, "warning", "", {}), NOW), "x", None, NOW)
    text = f"{device_id} {name} {'under_the%seat' if n % 5 == 0 else ''}".casefold()
    return Known(device_id, text, stage, alerted)


def listed(database: Database, limit: int, **filters: Any) -> Iterator[str]:
    after = None
    while True:
        with database.read() as tx:
            found = devices.page(tx, limit, after, **filters)
        yield from (device.id for device in found)
        if len(found) < limit:
            return
        after = found[-1].id


@pytest.mark.parametrize(("limit", "few"), [(3, 5000), (500, 5000), (3, 1), (500, 40)])
def test_every_combination_of_filters(
    tables: Database, fleet: list[Known], limit: int, few: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(devices, "FEW", few)
    wanted: Any = product((None, "box 3", "äÖ", "_the%", "nowhere"), (None, *STAGES), (None, True, False))
    for q, stage, alerted in wanted:
        expected = [
            known.id
            for known in fleet
            if (q is None or q.casefold() in known.text)
            and stage in {None, known.stage}
            and alerted in {None, known.alerted}
        ]
        assert list(listed(tables, limit, q=q, stage=stage, has_open_alert=alerted)) == expected, (q, stage, alerted)


def test_an_edited_device_is_found_by_its_new_texts(tables: Database) -> None:
    with tables.write() as tx:
        pk = devices.add(tx, "a", {"name": "Old", "vehicle": "Straße 7"}, NOW)
        installations.add(tx, Installation(pk, None, None, "waiting", None, None, NOW, {}, None, revision=0))
        devices.edit(tx, pk, {"name": "New"})
    found = {q: list(listed(tables, 10, q=q)) for q in ("old", "new", "STRASSE", "a")}
    assert found == {"old": [], "new": ["a"], "STRASSE": ["a"], "a": ["a"]}


def alert_pages(database: Database, limit: int, wanted: Filter) -> Iterator[Alert]:
    before = None
    while True:
        with database.read() as tx:
            found = alerts.page(tx, limit, before, wanted)
        yield from found
        if len(found) < limit:
            return
        before = Place(found[-1].opened_at, found[-1].pk)


@pytest.mark.parametrize("limit", [1, 7, 500])
def test_alerts_are_in_order_though_the_clock_was_set_back(tables: Database, limit: int) -> None:
    """Also when many were opened in the same moment, and with any filter."""
    moments = [NOW + timedelta(minutes=minutes) for minutes in (0, 10, 10, 10, 20, -40, -40, -30, 5, 10)]
    with tables.write() as tx:
        for n, moment in enumerate(moments):
            pk = devices.add(tx, f"d{n}", {"name": "A"}, NOW)
            kind = ("gps_lost", "sensor_fault")[n % 2]
            alerts.raise_(tx, pk, Finding(kind, "critical" if n % 3 else "warning", "", {}), moment)
    everything = list(alert_pages(tables, limit, Filter()))
    assert [alert.opened_at for alert in everything] == sorted(moments, reverse=True)
    assert len({alert.pk for alert in everything}) == len(moments)
    for wanted in (Filter(kind="gps_lost"), Filter(severity="critical", state="open"), Filter(device_id="d4")):
        expected = [alert for alert in everything if _fits(alert, wanted)]
        assert list(alert_pages(tables, limit, wanted)) == expected
    between = Filter(since=NOW, until=NOW + timedelta(minutes=10))
    assert {alert.opened_at for alert in alert_pages(tables, limit, between)} == {NOW, NOW + timedelta(minutes=5)}


def _fits(alert: Alert, wanted: Filter) -> bool:
    return all(value is None or value == getattr(alert, name) for name, value in wanted._asdict().items())


def test_times_of_an_alert_never_run_backwards(tables: Database) -> None:
    with tables.write() as tx:
        device_pk = devices.add(tx, "a", {"name": "A"}, NOW)
        pk = alerts.raise_(tx, device_pk, Finding("gps_lost", "warning", "", {}), NOW)
        earlier = NOW - timedelta(hours=1)
        alerts.raise_(tx, device_pk, Finding("gps_lost", "warning", "", {}), earlier)
        alerts.acknowledge(tx, pk, "x", None, earlier)
        alerts.resolve(tx, pk, "x", None, earlier + timedelta(minutes=1))
        alert = alerts.find(tx, pk)
    assert alert is not None
    assert alert.occurrences == 2
    assert (alert.opened_at, alert.updated_at, alert.acknowledged_at, alert.resolved_at) == (NOW,) * 4
