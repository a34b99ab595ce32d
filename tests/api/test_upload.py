import gzip
import io
import itertools
import random
import threading

import pyarrow as pa
import pytest
import sqlalchemy as sa
import zstandard
from starlette.testclient import TestClient

from api.app import create_app
from api.services import ingest
from api.services.context import Context
from api.settings import Settings
from storage import installations
from storage.database import Database
from storage.models import chunks as chunk_table
from storage.models import devices
from storage.models import installations as installation_table
from tests.conftest import Clock
from tests.drives import chunks
from tests.service import Api, Device


@pytest.fixture
def device(api: Api) -> Device:
    return api.add_device()


def snapshot(database: Database, device: Device) -> bytes:
    with database.read() as tx:
        pk = tx.value(sa.select(devices.c.pk).where(devices.c.id == device.id))
        row = installations.get(tx, pk)
    assert row is not None
    assert row.snapshot is not None
    return row.snapshot


def test_a_drive_ends_with_a_confirmed_mounting(device: Device) -> None:
    answer = device.send_all(chunks())
    assert answer["installation"]["stage"] == "confirmed"
    assert answer["installation"]["mount"]["status"] == "in_force"
    assert answer["installation"]["mount"]["id"] == 1
    assert answer["installation"]["verification"]["state"] == "passed"
    assert answer["installation"]["needs"] == []
    assert answer["chunk"] == {
        "session": "a",
        "seq": len(chunks()) - 1,
        "samples": 1500,
        "fixes": 120,
        "rejected": {},
        "duplicate": False,
        "state": "applied",
        "notices": [],
    }
    assert device.installation() == answer["installation"]


def test_a_repeated_chunk_has_no_effect(device: Device, database: Database) -> None:
    first = device.send(chunks()[0], 0, expect=200).json()
    before = snapshot(database, device)
    again = device.send(chunks()[0], 0, expect=200).json()
    assert again["chunk"] == first["chunk"] | {"duplicate": True}
    assert again["installation"] == first["installation"]
    assert snapshot(database, device) == before
    device.send(chunks()[1], 1, expect=200)
    assert device.send(chunks()[0], 0, expect=200).json()["chunk"]["duplicate"]


@pytest.mark.parametrize("encoding", ["gzip", "zstd"])
def test_a_chunk_compressed_otherwise_is_the_same_chunk(device: Device, encoding: str) -> None:
    packed = gzip.compress(chunks()[0]) if encoding == "gzip" else zstandard.compress(chunks()[0])
    assert not device.send(packed, 0, expect=200, Content_Encoding=encoding).json()["chunk"]["duplicate"]
    assert device.send(chunks()[0], 0, expect=200).json()["chunk"]["duplicate"]


def test_other_content_under_the_same_number_is_refused(device: Device, database: Database) -> None:
    device.send(chunks()[0], 0, expect=200)
    before = device.installation(), snapshot(database, device)
    problem = device.send(chunks()[1], 0, expect=409)
    assert problem.headers["content-type"] == "application/problem+json"
    assert problem.json()["type"].endswith("chunk-conflict")
    assert (device.installation(), snapshot(database, device)) == before
    device.send(chunks()[2], 2, expect=202)
    assert device.send(chunks()[3], 2, expect=409).json()["type"].endswith("chunk-conflict")


def test_a_chunk_ahead_of_its_turn_waits(device: Device, database: Database) -> None:
    device.send(chunks()[0], 0, expect=200)
    before = device.installation()
    ahead = device.send(chunks()[2], 2, expect=202).json()
    assert ahead["chunk"]["state"] == "waiting"
    assert ahead["chunk"]["samples"] == 1500
    assert ahead["installation"] == before
    again = device.send(chunks()[2], 2, expect=202).json()
    assert again["chunk"] == ahead["chunk"] | {"duplicate": True}
    device.send(chunks()[1], 1, expect=200)
    done = device.send(chunks()[2], 2, expect=200).json()
    assert (done["chunk"]["state"], done["chunk"]["duplicate"]) == ("applied", True)
    with database.read() as tx:
        assert tx.value(sa.select(sa.func.count()).where(chunk_table.c.body.is_not(None))) == 0


def test_any_order_of_arrival_ends_the_same(api: Api, database: Database) -> None:
    in_order = api.add_device("in-order")
    in_order.send_all(chunks())
    expected = snapshot(database, in_order)
    stages = in_order.get("estimates")["stage"]
    generator = random.Random(4)
    for n in range(6):
        device = api.add_device(f"shuffled-{n}")
        order = list(enumerate(chunks()))
        generator.shuffle(order)
        for seq, body in order:
            assert device.send(body, seq).status_code in {200, 202}
            if generator.random() < 0.3:
                assert device.send(body, seq).json()["chunk"]["duplicate"]
        assert snapshot(database, device) == expected
        assert device.get("estimates")["stage"] == stages
        assert len(device.get("mounts")["items"]) == 1


def test_concurrent_uploads_take_effect_once_and_in_order(api: Api, database: Database) -> None:
    in_order = api.add_device("in-order")
    in_order.send_all(chunks())
    device = api.add_device("hasty")
    work = [(seq, body) for seq, body in enumerate(chunks()) for _ in range(3)]
    random.Random(5).shuffle(work)
    answers: list[tuple[int, int, bool]] = []

    def send(mine: list[tuple[int, bytes]]) -> None:
        for seq, body in mine:
            response = device.send(body, seq)
            answers.append((response.status_code, seq, response.json()["chunk"]["duplicate"]))

    threads = [threading.Thread(target=send, args=(work[n::6],)) for n in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(answers) == len(work)
    assert {status for status, _, _ in answers} <= {200, 202}
    first_ones = sorted(seq for _, seq, duplicate in answers if not duplicate)
    assert first_ones == list(range(len(chunks())))
    assert snapshot(database, device) == snapshot(database, in_order)
    assert device.installation()["revision"] == in_order.installation()["revision"]


def test_a_gap_is_declared_after_the_timeout(device: Device, clock: Clock, settings: Settings) -> None:
    device.send(chunks()[0], 0, expect=200)
    device.send(chunks()[2], 2, expect=202)
    clock.advance(settings.gap_timeout - 1)
    device.send(chunks()[4], 4, expect=202)
    clock.advance(1)
    device.send(chunks()[6], 6, expect=202)
    assert device.send(chunks()[2], 2, expect=200).json()["chunk"]["state"] == "applied"
    assert device.send(chunks()[4], 4, expect=202).json()["chunk"]["state"] == "waiting"
    late = device.send(chunks()[1], 1, expect=409).json()
    assert late["type"].endswith("sequence-passed")
    device.send(chunks()[3], 3, expect=200)
    assert device.send(chunks()[4], 4, expect=200).json()["chunk"]["state"] == "applied"


def test_a_gap_is_declared_when_too_many_wait(device: Device, settings: Settings) -> None:
    body = chunks()[0]
    header, *rows = body.splitlines(keepends=True)
    pieces = [header + b"".join(rows[i : i + 10]) for i in range(0, 10 * (settings.max_waiting_chunks + 2), 10)]
    device.send(pieces[0], 0, expect=200)
    for seq in range(2, settings.max_waiting_chunks + 1):
        device.send(pieces[seq], seq, expect=202)
    last = settings.max_waiting_chunks + 1
    assert device.send(pieces[last], last, expect=200).json()["chunk"]["state"] == "applied"
    assert device.send(pieces[2], 2, expect=200).json()["chunk"] == {
        "session": "a",
        "seq": 2,
        "samples": 10,
        "fixes": sum(line.split(b",")[-1] != b"\n" and b",1," in line for line in pieces[2].splitlines()[1:]),
        "rejected": {},
        "duplicate": True,
        "state": "applied",
        "notices": [],
    }


def test_the_first_chunk_of_a_session_may_be_lost(device: Device, clock: Clock, settings: Settings) -> None:
    device.send(chunks()[1], 1, expect=202)
    assert device.installation()["stage"] == "waiting"
    clock.advance(settings.gap_timeout)
    device.send(chunks()[2], 2, expect=200)
    assert device.send(chunks()[1], 1, expect=200).json()["chunk"]["state"] == "applied"


def test_a_new_session_ends_the_former(device: Device, api: Api, database: Database) -> None:
    bodies = chunks()
    device.send(bodies[0], 0, "a", expect=200)
    device.send(bodies[2], 2, "a", expect=202)
    device.send(bodies[0], 0, "b", expect=200)
    assert device.send(bodies[2], 2, "a", expect=200).json()["chunk"]["state"] == "applied"
    before = snapshot(database, device), device.installation()
    assert device.send(bodies[1], 1, "a", expect=409).json()["type"].endswith("session-ended")
    assert device.send(bodies[3], 3, "a", expect=409).json()["type"].endswith("session-ended")
    assert (snapshot(database, device), device.installation()) == before
    assert device.send(bodies[0], 0, "a", expect=200).json()["chunk"]["duplicate"]
    device.send(bodies[1], 1, "b", expect=200)

    twin = api.add_device("twin")
    for seq, session in ((0, "a"), (2, "a"), (0, "b"), (1, "b")):
        twin.send(bodies[seq], seq, session)
    assert snapshot(database, twin) == snapshot(database, device)


def test_the_former_session_goes_on_until_the_new_one_begins(device: Device) -> None:
    bodies = chunks()
    device.send(bodies[0], 0, "a", expect=200)
    device.send(bodies[1], 1, "b", expect=202)
    device.send(bodies[1], 1, "a", expect=200)
    device.send(bodies[0], 0, "b", expect=200)
    assert device.send(bodies[1], 1, "b", expect=200).json()["chunk"]["state"] == "applied"
    device.send(bodies[2], 2, "a", expect=409)


def announcing(rows: int) -> bytes:
    """Arrow stream whose only batch says that it has so many rows, in a few hundred bytes."""
    batch = pa.record_batch({name: pa.nulls(rows) for name in ("t", "ax", "ay", "az", "fix", "speed", "course")})
    sink = io.BytesIO()
    with pa.ipc.new_stream(sink, batch.schema) as writer:
        writer.write_batch(batch)
    return sink.getvalue()


BAD = {
    "wrong column": (b"t,ax,ay,ac,fix,speed,course\n1,0,0,9.8,,,\n", "text/csv", 422),
    "text in a number": (b"t,ax,ay,az,fix,speed,course\n1,0,0,down,,,\n", "text/csv", 422),
    "not finite": (b"t,ax,ay,az,fix,speed,course\n1,0,nan,9.8,,,\n", "text/csv", 422),
    "an image": (b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\1\0", "text/csv", 422),
    "a billion rows": (announcing(10**9), "application/vnd.apache.arrow.stream", 422),
    "no header": (b"1,2,3\n", "text/csv", 422),
    "empty": (b"", "text/csv", 422),
    "unknown type": (b"t,ax\n", "application/json", 415),
    "not gzip": (b"t,ax", "text/csv", 400),
    "time backwards": (b"t,ax,ay,az,fix,speed,course\n2,0,0,9.8,,,\n1,0,0,9.8,,,\n", "text/csv", 422),
    "absurd time": (b"t,ax,ay,az,fix,speed,course\n1e300,0,0,9.8,,,\n", "text/csv", 422),
}


@pytest.mark.parametrize("name", BAD)
def test_a_chunk_that_cannot_be_read_has_no_effect(device: Device, database: Database, name: str) -> None:
    device.send(chunks()[0], 0, expect=200)
    before = snapshot(database, device), device.installation()
    body, kind, status = BAD[name]
    encoding = {"Content_Encoding": "gzip"} if name == "not gzip" else {}
    for seq in (1, 5):  # at its turn, and ahead of it
        problem = device.send(body, seq, expect=status, Content_Type=kind, **encoding)
        assert problem.headers["content-type"] == "application/problem+json"
        assert problem.json()["status"] == status
    assert (snapshot(database, device), device.installation()) == before
    device.send(chunks()[1], 1, expect=200)


def test_a_problem_of_a_log_names_line_column_and_expectation(device: Device) -> None:
    body = b"t,ax,ay,az,fix,speed,course\n1,0,0,9.8,,,\n2,0,x,9.8,,,\n"
    error = device.send(body, 0, expect=422).json()["errors"][0]
    assert (error["line"], error["column"]) == (3, "ay")
    assert "number" in error["expected"]


def test_too_large_is_refused_before_it_is_read(api: Api, device: Device, settings: Settings) -> None:
    limit = settings.max_chunk_bytes
    assert device.send(b"x" * (limit + 1), 0, expect=413).json()["title"] == "The chunk is too large"
    parts = itertools.repeat(b"x" * 65536, limit // 65536 + 1)
    path = f"/api/v1/devices/{device.id}/chunks"
    streamed = device.api.call("POST", path, params={"session": "a", "seq": 0}, content=parts)
    assert streamed.status_code == 413
    bomb = gzip.compress(b"0" * (settings.max_decoded_bytes + 1))
    assert device.send(bomb, 0, expect=413, Content_Encoding="gzip").json()["status"] == 413
    assert api.get(f"/devices/{device.id}/installation")["revision"] == 0


@pytest.mark.parametrize(
    "query",
    [
        {"seq": 0},
        {"session": "a"},
        {"session": "a", "seq": -1},
        {"session": "", "seq": 0},
        {"session": "a b", "seq": 0},
    ],
)
def test_session_and_number_are_checked(device: Device, query: dict[str, object]) -> None:
    path = f"/devices/{device.id}/chunks"
    problem = device.api.call(
        "POST", path, 422, params=query, content=chunks()[0], headers={"Content-Type": "text/csv"}
    )
    assert problem.json()["errors"][0]["pointer"].startswith("/query/")


def test_an_unknown_device_is_not_made(api: Api) -> None:
    stranger = Device(api, "nobody", api.key or "")
    stranger.send(chunks()[0], 0, expect=404)


def test_the_sweep_declares_gaps_without_an_upload(device: Device, api: Api, clock: Clock, settings: Settings) -> None:
    """Also when another device's gap cannot be closed."""
    context = Context.make(settings, clock)
    broken = api.add_device("a-broken-one")
    for each in (broken, device):
        each.send(chunks()[1], 1, expect=202)
    with context.database.write() as tx:
        pk = tx.value(sa.select(devices.c.pk).where(devices.c.id == broken.id))
        tx.execute(sa.update(installation_table).values(stage="nonsense").where(installation_table.c.device_pk == pk))
    ingest.close_gaps(context)
    device.send(chunks()[1], 1, expect=202)
    clock.advance(settings.gap_timeout)
    ingest.close_gaps(context)
    assert device.send(chunks()[1], 1, expect=200).json()["chunk"]["state"] == "applied"
    assert device.get("estimates")["t"]
    context.database.close()


def test_a_waiting_chunk_that_cannot_be_read_any_more_is_passed_over(
    settings: Settings, clock: Clock, database: Database
) -> None:
    """The limits were lowered while it waited."""
    header, *rows = chunks()[0].splitlines(keepends=True)
    small = [header + b"".join(rows[i : i + 5]) for i in (0, 5)]
    with TestClient(create_app(settings, clock)) as client:
        device = Api(client).add_device()
        device.admin.wait_until_ready()
        device.send(chunks()[1], 1, expect=202)
    lower = settings.model_copy(update={"max_decoded_bytes": 2000})
    with TestClient(create_app(lower, clock)) as client:
        device = Device(Api(client), device.id, device.key)
        device.admin.wait_until_ready()
        device.send(small[0], 0, expect=200)
        device.send(small[1], 2, expect=200)
        device.send(chunks()[1], 1, expect=413)
    with database.read() as tx:
        receipts = tx.connection.execute(sa.select(chunk_table.c.state, chunk_table.c.rejected)).all()
    assert sorted(map(str, receipts)) == ["('applied', {'unusable': 1500})", "('applied', {})", "('applied', {})"]


def test_chunks_waiting_in_many_sessions_are_bounded_together(
    settings: Settings, clock: Clock, database: Database
) -> None:
    """A device that is switched on again and again, with the first chunk of each session lost."""
    few = settings.model_copy(update={"max_waiting_chunks": 4})
    with TestClient(create_app(few, clock)) as client:
        api = Api(client)
        api.wait_until_ready()
        device = api.add_device()
        for n in range(10):
            device.send(chunks()[1], 1, session=f"s{n}", expect=202)
            with database.read() as tx:
                waiting = tx.value(sa.select(sa.func.count()).where(chunk_table.c.state == "waiting"))
            assert waiting < 4
        device.send(chunks()[1], 1, session="s0", expect=200)
        device.send(chunks()[0], 0, session="s0", expect=409)
