"""Lists give what their filters say, each item once, in order, whatever pages it is read in."""

import random
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from itertools import cycle, product
from typing import Any, NamedTuple

import pytest

from storage import alerts, device_lists, devices, installations
from storage.alerts import Alert, Finding
from storage.database import Database, WriteSession
from storage.device_lists import Filter, Place
from storage.installations import Installation
from storage.migrate import upgrade
from tests.plans import WAYS

NOW = datetime(2024, 5, 6, 7, 8, 9, tzinfo=UTC)
STAGES = ("waiting", "confirmed")
NAMES = (
    "Box 1",
    "box 1",
    "BOX 10",
    "Äö",
    "äÖ",
    "Straße",
    "STRASSE",
    "zebra",
    "Zulu",
    "  x",
    "\n",
    "\u1fb7\u0390",
    "𝐁ox",
)
"""Also some that are the same without regard to case, longer then, or beyond 16 bits."""


class Known(NamedTuple):
    id: str
    name: str
    text: str
    stage: str
    alerts: tuple[tuple[str, str], ...]
    last_data_at: datetime | None


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
    device_id, name, stage = f"{generator.randrange(10**6):06d}", generator.choice(NAMES), generator.choice(STAGES)
    notes = "under_the%seat" if n % 5 == 0 else ""
    last_data_at = None if n % 4 == 0 else NOW + timedelta(microseconds=generator.randrange(9))
    pk = devices.add(tx, device_id, {"name": name, "notes": notes}, NOW)
    installations.add(tx, Installation(pk, None, None, stage, None, None, NOW, {}, last_data_at, revision=0))
    raised = [("gps_lost", "warning"), ("sensor_fault", "critical"), ("clock_fault", "warning")][
        : generator.randrange(4)
    ]
    for kind, severity in raised:
        alerts.raise_(tx, pk, Finding(kind, severity, "", {}), NOW)
    alerts.resolve(tx, alerts.raise_(tx, pk, Finding("device_loose", "info", "", {}), NOW), "x", None, NOW)
    return Known(device_id, name, f"{device_id}\n{name}\n{notes}".casefold(), stage, tuple(raised), last_data_at)


def listed(database: Database, limit: int, sort: str = "id", **filters: Any) -> Iterator[str]:
    after = None
    while True:
        with database.read() as tx:
            found = device_lists.page(tx, limit, after, Filter(**filters), sort)
        yield from (device.id for device in found)
        if len(found) < limit:
            return
        key = {"id": None, "name": found[-1].name_key, "last_data_at": found[-1].last_data_at}[sort.removeprefix("-")]
        after = Place(found[-1].id, key)


@pytest.mark.parametrize("way", WAYS)
def test_every_combination_of_filters(
    tables: Database, fleet: list[Known], way: dict[str, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    _use(way, monkeypatch)
    wanted: Any = product(
        (None, "box 1", "äÖ", "_the%", "nowhere"),
        (None, *STAGES),
        (None, True, False),
        (None, "gps_lost", "device_loose"),
        (None, "warning", "critical"),
    )
    for values, limit, sort in zip(wanted, cycle((5, 500)), cycle(("id", "name", "-last_data_at"))):
        filters = Filter(*values)
        expected = {known.id for known in fleet if _matches(known, filters)}
        found = list(listed(tables, limit, sort, **filters._asdict()))
        assert (len(found), set(found)) == (len(expected), expected), filters


def _use(way: dict[str, int], monkeypatch: pytest.MonkeyPatch) -> None:
    for name, number in way.items():
        monkeypatch.setattr(device_lists, name, number)


def _matches(known: Known, wanted: Filter) -> bool:
    kind, severity = wanted.alert_kind, wanted.alert_severity
    named = [(k, s) for k, s in known.alerts if kind in {None, k} and severity in {None, s}]
    return (
        (wanted.q is None or wanted.q.casefold() in known.text)
        and wanted.stage in {None, known.stage}
        and wanted.has_open_alert in {None, bool(known.alerts)}
        and (kind is severity is None or bool(named))
    )


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("limit", [7, 500])
def test_every_order_of_every_page(
    tables: Database, fleet: list[Known], limit: int, way: dict[str, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The same on every database, and the same turned round, but those that never sent are last."""
    _use(way, monkeypatch)
    by_name = [known.id for known in sorted(fleet, key=lambda known: (known.name.casefold(), known.id))]
    sent = [(known.last_data_at, known.id) for known in fleet if known.last_data_at is not None]
    never = [known.id for known in fleet if known.last_data_at is None]
    by_data = [device_id for _, device_id in sorted(sent)]
    orders = {
        "id": [known.id for known in fleet],
        "-id": [known.id for known in reversed(fleet)],
        "name": by_name,
        "-name": by_name[::-1],
        "last_data_at": by_data + never,
        "-last_data_at": by_data[::-1] + never[::-1],
    }
    confirmed = {known.id for known in fleet if known.stage == "confirmed"}
    for sort, expected in orders.items():
        assert list(listed(tables, limit, sort)) == expected, sort
        kept = [device_id for device_id in expected if device_id in confirmed]
        assert list(listed(tables, limit, sort, stage="confirmed")) == kept, sort


def test_a_page_goes_on_after_a_device_that_is_gone(tables: Database, fleet: list[Known]) -> None:
    """And whatever has been renamed, registered or has sent since comes where it belongs."""
    before, gone, *rest = sorted((known.name.casefold(), known.id) for known in fleet)
    with tables.write() as tx:
        pk = devices.exists(tx, gone[1])
        assert pk is not None
        devices.remove(tx, pk)
        moved = devices.exists(tx, before[1])
        assert moved is not None
        devices.edit(tx, moved, {"name": "ZZZ"})
    with tables.read() as tx:
        found = device_lists.page(tx, 500, Place(gone[1], gone[0]), Filter(), "name")
    assert [(device.name_key, device.id) for device in found] == sorted([*rest, ("zzz", before[1])])


def test_an_edited_device_is_found_by_its_new_texts(tables: Database) -> None:
    with tables.write() as tx:
        pk = devices.add(tx, "a", {"name": "Old", "vehicle": "Straße 7"}, NOW)
        installations.add(tx, Installation(pk, None, None, "waiting", None, None, NOW, {}, None, revision=0))
        devices.edit(tx, pk, {"name": "New"})
    found = {q: list(listed(tables, 10, q=q)) for q in ("old", "new", "STRASSE", "a")}
    assert found == {"old": [], "new": ["a"], "STRASSE": ["a"], "a": ["a"]}


def alert_pages(database: Database, limit: int, wanted: alerts.Filter) -> Iterator[Alert]:
    before = None
    while True:
        with database.read() as tx:
            found = alerts.page(tx, limit, before, wanted)
        yield from found
        if len(found) < limit:
            return
        before = alerts.Place(found[-1].opened_at, found[-1].pk)


@pytest.mark.parametrize("limit", [1, 7, 500])
def test_alerts_are_in_order_though_the_clock_was_set_back(tables: Database, limit: int) -> None:
    """Also when many were opened in the same moment, and with any filter."""
    moments = [NOW + timedelta(minutes=minutes) for minutes in (0, 10, 10, 10, 20, -40, -40, -30, 5, 10)]
    with tables.write() as tx:
        for n, moment in enumerate(moments):
            pk = devices.add(tx, f"d{n}", {"name": "A"}, NOW)
            kind = ("gps_lost", "sensor_fault")[n % 2]
            alerts.raise_(tx, pk, Finding(kind, "critical" if n % 3 else "warning", "", {}), moment)
    everything = list(alert_pages(tables, limit, alerts.Filter()))
    assert [alert.opened_at for alert in everything] == sorted(moments, reverse=True)
    assert len({alert.pk for alert in everything}) == len(moments)
    for wanted in (
        alerts.Filter(kind="gps_lost"),
        alerts.Filter(severity="critical", state="open"),
        alerts.Filter(device_id="d4"),
    ):
        expected = [alert for alert in everything if _fits(alert, wanted)]
        assert list(alert_pages(tables, limit, wanted)) == expected
    between = alerts.Filter(since=NOW, until=NOW + timedelta(minutes=10))
    assert {alert.opened_at for alert in alert_pages(tables, limit, between)} == {NOW, NOW + timedelta(minutes=5)}


def _fits(alert: Alert, wanted: alerts.Filter) -> bool:
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
