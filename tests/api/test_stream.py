import asyncio
import json
import threading
import time
from collections.abc import AsyncIterator, Iterator
from contextlib import suppress
from datetime import timedelta
from pathlib import Path
from typing import Any, NamedTuple

import httpx
import pytest

from api.live import Hub
from api.services import retention, startup
from api.services.context import Context, utc_now
from api.settings import Settings
from storage import events
from storage.database import Database
from storage.events import Position
from storage.migrate import upgrade
from tests.conftest import Clock
from tests.drives import chunks, remounted
from tests.server import ServerProcess, running
from tests.service import Api, Device


class Told(NamedTuple):
    type: str
    id: str
    data: Any


class Listener:
    """Listens to the stream in a thread."""

    def __init__(self, api: Api, last_event_id: str | None = None) -> None:
        self.told: list[Told] = []
        self.last_id = last_event_id
        self.connected = threading.Event()
        self.ended = threading.Event()
        self._stop = threading.Event()
        headers = {"Authorization": f"Bearer {api.key}"}
        headers |= {"Last-Event-ID": last_event_id} if last_event_id else {}
        self._url, self._headers = f"{api.client.base_url}/api/v1/stream", headers
        self._thread = threading.Thread(target=self._listen)
        self._thread.start()
        assert self.connected.wait(10)

    def _listen(self) -> None:
        with suppress(httpx.RemoteProtocolError):  # the server was killed
            self._read()

    def _read(self) -> None:
        with httpx.stream("GET", self._url, headers=self._headers, timeout=30.0) as response:
            assert response.headers["content-type"].startswith("text/event-stream")
            fields: dict[str, str] = {}
            for line in response.iter_lines():
                if self._stop.is_set():
                    break
                name, _, value = line.partition(": ")
                if line == "":
                    self._take(fields)
                    fields = {}
                elif name:
                    fields[name] = value
        self.ended.set()

    def _take(self, fields: dict[str, str]) -> None:
        self.last_id = fields.get("id", self.last_id)
        if "data" in fields:
            self.told.append(Told(fields["event"], self.last_id or "", json.loads(fields["data"])))
        else:
            self.connected.set()

    def wait_for(self, count: int) -> list[Told]:
        deadline = time.monotonic() + 10
        while len(self.told) < count:
            assert time.monotonic() < deadline, self.told
            time.sleep(0.01)
        return self.told

    def leave(self) -> None:
        self._stop.set()


@pytest.fixture
def server(database_url: str, tmp_path: Path) -> ServerProcess:
    return ServerProcess(database_url, tmp_path)


@pytest.fixture
def live(server: ServerProcess) -> Iterator[Api]:
    with running(server) as api:
        yield api


def test_the_stream_tells_what_happens_and_resumes_where_it_broke_off(live: Api, server: ServerProcess) -> None:
    before = live.add_device("before")
    listener = Listener(live)
    device = live.add_device("box")
    answer = device.send(chunks()[0], 0, expect=200).json()
    device.send(chunks()[0], 0, expect=200)  # a duplicate tells nothing
    device.send(chunks()[2], 2, expect=202)  # nor does a chunk that waits
    live.call("PATCH", "/devices/before", 200, json={"name": "new"})
    registered, installed, edited = listener.wait_for(3)
    assert (registered.type, registered.data["change"], registered.data["device"]["id"]) == (
        "device",
        "registered",
        "box",
    )
    assert (installed.type, installed.data) == ("installation", answer["installation"])
    assert (edited.data["change"], edited.data["device"]["name"]) == ("edited", "new")
    listener.leave()

    missed = device.send(chunks()[1], 1, expect=200).json()["installation"]
    resumed = Listener(live, registered.id)
    assert resumed.wait_for(3)[:2] == [installed, edited]
    assert resumed.told[2].data == missed
    live.call("DELETE", "/devices/box", 204)
    assert resumed.wait_for(4)[3].data == {"device_id": "box", "change": "removed", "device": None}
    time.sleep(0.2)
    assert [told.id for told in resumed.told] == sorted({told.id for told in resumed.told}, key=position)
    assert len(listener.told) == 3
    assert before.installation()["revision"] == 0

    begun = time.monotonic()
    assert server.stop() < 5
    assert resumed.ended.wait(5)
    assert time.monotonic() - begun < 5
    assert server.process is not None
    assert server.process.returncode in {0, -15}
    assert "Traceback" not in server.log.read_text()


def position(text: str) -> Position:
    parsed = Position.parse(text)
    assert parsed is not None
    return parsed


def test_everyone_hears_only_what_they_may_see(live: Api) -> None:
    mine, other = live.add_device("mine"), live.add_device("other")
    everything, own = Listener(live), Listener(mine.api)
    other.send(chunks()[0], 0, expect=200)
    mine.send(chunks()[0], 0, expect=200)
    story = remounted()
    live.add_device("moved").send_all(story.chunks[: story.moved + 1])
    live.call("PATCH", "/devices/mine", 200, json={"notes": "x"})
    assert [told.data["device_id"] for told in own.wait_for(2)] == ["mine", "mine"]
    everything.wait_for(2 + 1 + story.moved + 1 + 1 + 1)
    (alert,) = [told for told in everything.told if told.type == "alert"]
    assert alert.data == live.get("/alerts")["items"][0]
    assert len(own.told) == 2


def test_another_process_is_heard(database_url: str, tmp_path: Path) -> None:
    first, second = (ServerProcess(database_url, tmp_path / name) for name in ("a", "b"))
    for server in (first, second):
        server.log.parent.mkdir()
    with running(first) as api, running(second) as other:
        listener = Listener(other)
        for n in range(20):
            (api if n % 2 else other).add_device(f"box-{n}")
        told = listener.wait_for(20)
        assert sorted(t.data["device_id"] for t in told) == sorted(f"box-{n}" for n in range(20))
        assert len({t.id for t in told}) == 20


@pytest.mark.parametrize("backend", ["sqlite"], indirect=True)
def test_several_workers_share_one_port_and_end_together(database_url: str, tmp_path: Path) -> None:
    server = ServerProcess(database_url, tmp_path, workers=2)
    with running(server) as api:
        listeners = [Listener(api) for _ in range(4)]
        device = api.add_device()
        for seq, body in enumerate(chunks()[:4]):
            with httpx.Client(base_url=server.url, timeout=30.0) as client:  # a connection each: any worker
                Device(Api(client), device.id, device.key).send(body, seq, expect=200)
        for listener in listeners:
            assert [told.type for told in listener.wait_for(5)] == ["device", *["installation"] * 4]
        assert server.stop(30) < 15
        assert all(listener.ended.wait(5) for listener in listeners)


def test_a_stream_that_cannot_be_resumed_says_so(database_url: str, tmp_path: Path, database: Database) -> None:
    with running(ServerProcess(database_url, tmp_path)) as api:
        listener = Listener(api)
        api.add_device("a")
        last = listener.wait_for(1)[0].id
        with database.write() as tx:
            assert len(events.after(tx, Position(0, 0))) == 1
        api.add_device("b")
        listener.wait_for(2)
        with database.write() as tx:
            events.forget(tx, utc_now() + timedelta(minutes=1), 100)
        for lost in (last[:-1] + "0", "nonsense", "1.2.3"):
            resumed = Listener(api, lost)
            assert [told.type for told in resumed.wait_for(1)] == ["reset"]
            resumed.leave()
        still_there = Listener(api, listener.last_id)
        api.add_device("c")
        assert [told.type for told in still_there.wait_for(1)] == ["device"]


def test_old_events_are_removed_by_housekeeping(settings: Settings, clock: Clock) -> None:
    context = Context.make(settings, clock)
    startup.prepare(context)
    with context.database.write() as tx:
        events.add(tx, "a", "device", "{}", clock())
    clock.advance(settings.stream_minutes * 60 - 1)
    with context.database.write() as tx:
        events.add(tx, "b", "device", "{}", clock())
    clock.advance(2)
    retention.tidy(context)
    with context.database.read() as tx:
        (left,) = events.after(tx, Position(0, 0))
        assert left.device_id == "b"
        assert Position(0, 0) < events.pruned(tx) < left.position
    context.database.close()


def test_whoever_comes_after_a_quiet_time_hears_what_follows_only(live: Api) -> None:
    first = Listener(live)
    live.add_device("a")
    (told,) = first.wait_for(1)
    first.leave()
    live.add_device("b")  # wakes the first, which then leaves
    assert first.ended.wait(10)
    live.add_device("c")
    second, resumed = Listener(live), Listener(live, told.id)
    live.add_device("d")
    assert [one.data["device_id"] for one in second.wait_for(1)] == ["d"]
    assert [one.data["device_id"] for one in resumed.wait_for(3)] == ["b", "c", "d"]


async def first(batches: AsyncIterator[list[events.Event]]) -> AsyncIterator[list[events.Event]]:
    """Give the first batch with anything in it."""
    async for batch in batches:
        if batch:
            yield batch
            return


def test_nothing_is_read_while_nobody_listens(database: Database, monkeypatch: pytest.MonkeyPatch) -> None:
    upgrade(database)
    monkeypatch.setattr("api.live.POLL_INTERVAL", 0.05)
    hub, reads = Hub(database), list[Position]()
    straight = hub._read

    def read(position: Position) -> list[events.Event]:
        reads.append(position)
        return straight(position)

    monkeypatch.setattr(hub, "_read", read)

    async def live() -> None:
        running_hub = asyncio.create_task(hub.run())
        await asyncio.sleep(0.3)
        assert reads == []
        async with hub.listening() as now:
            await asyncio.to_thread(tell, "heard")
            hub.wake()
            heard = [batch async for batch in first(hub.follow(now))]
            assert [event.device_id for event in heard[0]] == ["heard"]
        await asyncio.sleep(0.2)
        count = len(reads)
        await asyncio.sleep(0.3)
        assert len(reads) == count
        hub.close()
        await running_hub

    def tell(device_id: str) -> None:
        with database.write() as tx:
            events.add(tx, device_id, "device", "{}", utc_now())

    asyncio.run(live())
