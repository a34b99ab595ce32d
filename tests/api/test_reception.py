"""What became of the data of a device: `GET /devices/{id}/health`."""

from datetime import timedelta
from typing import Any

import numpy as np
import pytest

from api.formats.writer import write_native_csv
from api.services import reception
from core import Samples
from storage import chunks, devices, sessions
from storage.chunks import APPLIED, Receipt
from storage.database import Database
from tests.conftest import Clock
from tests.plans import statements
from tests.service import Api, Device, Json
from tests.watched import parked

GAP_TIMEOUT = 600.0
"""s, the service's own"""


@pytest.fixture
def device(api: Api) -> Device:
    return api.add_device()


def send(device: Device, seq: int, session: str = "a", samples: Samples | None = None) -> None:
    """Send the minute of that number."""
    body = write_native_csv(samples or parked(60.0 * seq))
    assert device.send(body, seq, session).status_code in {200, 202}


def health(device: Device, hours: int = 24) -> Json:
    told: Json = device.get("health", params={"hours": hours})
    return told


def test_a_device_that_has_sent_nothing(device: Device) -> None:
    assert health(device) == {
        "since": "2024-05-05T07:08:09Z",
        "until": "2024-05-06T07:08:09Z",
        "chunks": 0,
        "samples": 0,
        "fixes": 0,
        "rejected": {},
        "waiting": 0,
        "lost": [],
        "sessions": [],
        "rates": {"time": [], "sample_rate_hz": [], "fix_rate_hz": [], "rejected": []},
    }


def test_what_came_in_is_summed_up(device: Device, clock: Clock) -> None:
    for seq in range(2):
        send(device, seq)
        clock.advance(60)
    send(device, 2, samples=parked(60.0, 90.0))  # its first minute once more
    clock.advance(60)
    send(device, 0, "b", parked(5.0, 60.0, fix=False))
    told = health(device)
    assert (told["chunks"], told["waiting"], told["lost"]) == (4, 0, [])
    assert (told["samples"], told["fixes"]) == (120 + 120 + 60 + 120, 60 + 60 + 90)
    assert told["rejected"] == {"before_previous_sample": 119, "duplicate_time": 1}
    session = {"session": "a", "first_seq": 0, "last_seq": 2, "chunks": 3, "samples": 300, "fixes": 210}
    assert told["sessions"] == [
        {
            "session": "b",
            "started_at": "2024-05-06T07:10:04.500000Z",
            **{"first_seq": 0, "last_seq": 0, "chunks": 1, "samples": 120, "fixes": 0},
        },
        session | {"started_at": told["sessions"][1]["started_at"]},
    ]
    assert told["rates"] == {
        "time": [f"2024-05-06T07:{minute:02}:09Z" for minute in range(8, 12)],
        "sample_rate_hz": [2.0, 2.0, pytest.approx(59 / 89.5, abs=0.001), 2.0],
        "fix_rate_hz": [1.0, 1.0, pytest.approx(59 / 89.5 * 90 / 60, abs=0.001), 0.0],
        "rejected": [0, 0, 120, 0],
    }


def test_a_missing_chunk_is_waited_for_before_it_is_lost(device: Device, clock: Clock) -> None:
    for seq in (0, 1, 4):
        send(device, seq)
    told = health(device)
    assert (told["chunks"], told["waiting"], told["lost"]) == (3, 1, [])
    assert len(told["rates"]["time"]) == 2
    clock.advance(GAP_TIMEOUT + 1)
    send(device, 5)
    told = health(device)
    assert (told["chunks"], told["waiting"]) == (4, 0)
    assert told["lost"] == [{"session": "a", "from_seq": 2, "to_seq": 3, "before": "2024-05-06T07:08:09Z"}]


def test_losses_come_newest_first_and_the_first_chunks_may_be_lost_too(device: Device, clock: Clock) -> None:
    for session in ("a", "b"):
        for seq in (2, 5):
            send(device, seq, session)
        clock.advance(GAP_TIMEOUT + 1)
        send(device, 6, session)
    lost = [(gap["session"], gap["from_seq"], gap["to_seq"]) for gap in health(device)["lost"]]
    assert lost == [("b", 3, 4), ("b", 0, 1), ("a", 3, 4), ("a", 0, 1)]


def test_only_the_period_counts_but_a_loss_may_begin_before_it(device: Device, clock: Clock) -> None:
    send(device, 0)
    clock.advance(3601)
    assert health(device, 1)["chunks"] == 0
    send(device, 3)
    clock.advance(GAP_TIMEOUT + 1)
    send(device, 4)
    told = health(device, 1)
    assert [gap["from_seq"] for gap in told["lost"]] == [1]
    assert (told["chunks"], told["sessions"][0]["first_seq"]) == (2, 3)
    assert health(device, 2)["chunks"] == 3
    clock.advance(3600)
    assert health(device, 1)["lost"] == []


@pytest.mark.parametrize("hours", [0, 721, "x"])
def test_hours_out_of_range(device: Device, hours: Any) -> None:
    problem = device.get("health", 422, params={"hours": hours})
    assert problem["errors"][0]["pointer"] == "/query/hours"


def test_a_device_that_is_not_there(api: Api) -> None:
    api.get("/devices/nobody/health", 404)


def test_it_goes_back_no_further_than_receipts_are_kept(device: Device) -> None:
    assert health(device, 720)["since"] == "2024-04-22T07:08:09Z"


class Past:
    """Receipts of a device, as if they had come in long ago."""

    def __init__(self, database: Database, device: Device, clock: Clock) -> None:
        self.database = database
        self.clock = clock
        with database.read() as tx:
            found = devices.find(tx, device.id)
        assert found is not None
        self.device_pk = found.pk

    def add(self, session: str, first: float, count: int, step: float = 60.0) -> None:
        """Add a session whose chunks came in from so many seconds ago on, one each `step` s."""
        began = self.clock() - timedelta(seconds=first)
        with self.database.write() as tx:
            pk = sessions.find_or_add(tx, self.device_pk, session, began).pk
            for seq in range(count):
                at = began + timedelta(seconds=step * seq)
                chunks.add(tx, Receipt(pk, seq, "", APPLIED, 120, 60, {}, at, 60.0 * seq, 60.0 * seq + 59.5))


@pytest.fixture
def past(database: Database, device: Device, clock: Clock) -> Past:
    return Past(database, device, clock)


def test_charts_have_rows_evenly_chosen(past: Past, device: Device, monkeypatch: pytest.MonkeyPatch) -> None:
    past.add("a", 6000.0, 101)
    monkeypatch.setattr(reception, "ROWS", 11)
    rates = health(device)["rates"]
    assert rates["time"][0] == "2024-05-06T05:28:09Z"
    assert rates["time"][1] == "2024-05-06T05:38:09Z"
    assert rates["time"][-1] == "2024-05-06T07:08:09Z"
    assert {len(column) for column in rates.values()} == {11}


def test_the_newest_of_many_losses_and_sessions_are_told(
    past: Past, device: Device, monkeypatch: pytest.MonkeyPatch
) -> None:
    for n in range(5):
        past.add(f"s{n}", 3000.0 - n, 1)
    monkeypatch.setattr(reception, "SHOWN_SESSIONS", 2)
    told = health(device)
    assert [session["session"] for session in told["sessions"]] == ["s4", "s3"]
    assert told["chunks"] == 5


def test_more_than_is_looked_through_moves_the_beginning(
    past: Past, device: Device, monkeypatch: pytest.MonkeyPatch
) -> None:
    past.add("a", 60000.0, 500)
    past.add("b", 6000.0, 100)
    monkeypatch.setattr(reception, "MOST", 200)
    monkeypatch.setattr(reception, "PAGE", 50)
    told = health(device)
    assert told["chunks"] == 200
    assert told["since"] == told["rates"]["time"][0] == "2024-05-05T21:08:09Z"
    assert told["lost"] == []


@pytest.mark.parametrize("backend", ["sqlite"], indirect=True)
def test_however_much_there_is_little_is_read_for_a_day(past: Past, database: Database, clock: Clock) -> None:
    for n in range(60):
        past.add(f"old-{n}", 86400.0 * (90 - n), 40)
    past.add("always-on", 86400.0 * 20, 20 * 144 + 1, 600.0)
    with database.read() as tx, statements(tx.connection) as ran:
        told = reception.read(tx, past.device_pk, clock() - timedelta(hours=24), clock())
    assert told.chunks == 145
    assert np.diff([at.timestamp() for at in told.rates.time]).tolist() == [600.0] * 144
    assert len(ran) <= 4
