"""Several chunks taken in at once are to each other as if each had come alone."""

from collections.abc import Callable, Iterator
from contextvars import ContextVar

import numpy as np
import pytest
import sqlalchemy as sa
from sqlalchemy import event

from api import schemas
from api.formats import FormatError, ParsedLog
from api.services import access, fleet, foresight, ingest, intake, startup
from api.services.context import Context
from api.services.errors import ConflictError, NotFoundError
from api.settings import Settings
from storage.chunks import Body
from storage.database import ReadSession
from storage.file_lock import FileLock
from storage.models import chunks as chunk_table
from tests.conftest import Clock
from tests.crashes import crashed
from tests.drives import remounted

WHERE: ContextVar[str] = ContextVar("where", default="nowhere")


@pytest.fixture
def context(settings: Settings, clock: Clock) -> Iterator[Context]:
    made = Context.make(settings, clock)
    startup.prepare(made)
    for name in ("a", "b", "c"):
        fleet.register(made, schemas.DeviceDraft(id=name, name=name))
    yield made
    made.database.close()


def arrival(device_id: str, seq: int, body: bytes | None = None) -> intake.Arrival:
    content = remounted().chunks[seq] if body is None else body
    return intake.arrival(device_id, ingest.Chunk("s", seq, Body(content, "text/csv", None, "auto")))


def told(outcome: intake.Outcome) -> str:
    return type(outcome).__name__ if isinstance(outcome, Exception) else outcome.chunk.state


def receipts(context: Context) -> int:
    with context.database.read() as tx:
        return int(tx.value(sa.select(sa.func.count()).select_from(chunk_table)))


def shown(context: Context, device_id: str) -> schemas.Installation:
    _, found = fleet.read_installation(context, device_id)
    assert found is not None
    return found


def count_commits(context: Context, before: Callable[[], None] = lambda: None) -> list[int]:
    seen: list[int] = []

    def count(_: sa.Connection) -> None:
        before()
        seen.append(1)

    event.listen(context.database.engine, "commit", count)
    return seen


def test_each_gets_its_own_answer(context: Context) -> None:
    batch = [
        arrival("a", 0),
        arrival("nobody", 0),
        arrival("b", 0, b"t,ax\n1,x\n"),
        arrival("c", 1),
        arrival("a", 1),
        arrival("a", 0),
        arrival("a", 1, remounted().chunks[3]),
    ]
    outcomes = intake.receive_together(context, batch)
    assert [told(outcome) for outcome in outcomes] == [
        "applied", NotFoundError.__name__, FormatError.__name__, "waiting", "applied", "applied", "ChunkConflictError",
    ]  # fmt: skip
    duplicate = outcomes[5]
    assert isinstance(duplicate, schemas.Upload)
    assert duplicate.chunk.duplicate
    assert isinstance(outcomes[6], ConflictError)
    assert receipts(context) == 3


def test_together_ends_where_one_after_the_other_ends(context: Context) -> None:
    intake.receive_together(context, [arrival(name, seq) for seq in range(6) for name in ("a", "b")])
    for seq in range(6):
        intake.receive(context, "c", arrival("c", seq).chunk)
    one = shown(context, "c").model_dump(exclude={"device_id", "since"})
    assert shown(context, "a").model_dump(exclude={"device_id", "since"}) == one
    assert shown(context, "b").model_dump(exclude={"device_id", "since"}) == one


class Writing:
    """Another process that writes until the last of some chunks has been asked for."""

    def __init__(self, context: Context, coming: list[intake.Arrival]) -> None:
        self._lock = FileLock(context.database.url.database)
        self._coming = coming

    def __enter__(self) -> "Writing":
        assert self._lock.acquire(20)
        return self

    def __exit__(self, *_: object) -> None:
        self._lock.close()

    def another(self) -> intake.Arrival | None:
        if self._coming:
            return self._coming.pop(0)
        self._lock.release()
        return None


@pytest.mark.parametrize("backend", ["sqlite"], indirect=True)
def test_what_comes_in_while_another_process_writes_is_taken_in_too(context: Context) -> None:
    seen = count_commits(context)
    coming = [arrival("b", 0), arrival("nobody", 0), arrival("c", 0, b"t,ax\n1,x\n"), arrival("a", 1), arrival("b", 1)]
    with Writing(context, coming) as other:
        outcomes = intake.receive_together(context, [arrival("a", 0)], other.another)
    assert [told(outcome) for outcome in outcomes] == [
        "applied", "applied", NotFoundError.__name__, FormatError.__name__, "applied", "applied",
    ]  # fmt: skip
    assert len(seen) == 1
    assert receipts(context) == 4


@pytest.mark.parametrize("backend", ["sqlite"], indirect=True)
def test_what_came_in_meanwhile_fails_too_when_the_other_process_goes_on(
    context: Context, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("storage.database.BUSY_TIMEOUT", 0.2)
    coming = [arrival("b", 0)]
    with Writing(context, []):
        outcomes = intake.receive_together(context, [arrival("a", 0)], lambda: coming.pop() if coming else None)
    assert [told(outcome) for outcome in outcomes] == [sa.exc.TimeoutError.__name__] * 2
    assert receipts(context) == 0


@pytest.mark.parametrize("backend", ["sqlite"], indirect=True)
def test_on_sqlite_they_share_one_commit(context: Context) -> None:
    seen = count_commits(context)
    intake.receive_together(context, [arrival(name, 0) for name in ("a", "b", "c", "nobody")])
    assert len(seen) == 1


@pytest.mark.parametrize("backend", ["sqlite"], indirect=True)
def test_when_the_commit_fails_none_is_acknowledged_and_all_can_come_again(context: Context) -> None:
    failing = [True]

    def fail() -> None:
        if failing:
            failing.pop()
            raise sa.exc.OperationalError("COMMIT", None, Exception("database or disk is full"))

    count_commits(context, fail)
    batch = [arrival("a", 0), arrival("b", 0), arrival("nobody", 0)]
    outcomes = intake.receive_together(context, batch)
    assert [told(outcome) for outcome in outcomes] == ["OperationalError", "OperationalError", "NotFoundError"]
    assert receipts(context) == 0
    assert [told(outcome) for outcome in intake.receive_together(context, batch)][:2] == ["applied", "applied"]


@pytest.mark.parametrize("backend", ["sqlite"], indirect=True)
def test_a_device_that_cannot_be_looked_up_spoils_nothing_for_the_others(
    context: Context, monkeypatch: pytest.MonkeyPatch
) -> None:
    straight = foresight.look_up

    def look_up(tx: ReadSession, device_id: str, session: str, seq: int) -> foresight.Stand | None:
        if device_id == "a":
            raise ValueError("what is stored of it is damaged")
        return straight(tx, device_id, session, seq)

    monkeypatch.setattr(foresight, "look_up", look_up)
    outcomes = intake.receive_together(context, [arrival("a", 0), arrival("b", 0), arrival("c", 0)])
    assert [told(outcome) for outcome in outcomes] == ["ValueError", "applied", "applied"]


@pytest.mark.parametrize("backend", ["sqlite"], indirect=True)
def test_a_chunk_that_was_refused_is_told_its_own_error_when_the_database_fails(
    context: Context, monkeypatch: pytest.MonkeyPatch
) -> None:
    def look() -> None:
        raise sa.exc.OperationalError("SELECT", None, Exception("disk I/O error"))

    monkeypatch.setattr(context.database, "look", look)
    outcomes = intake.receive_together(context, [arrival("a", 0), arrival("b", 0, b"t,ax\n1,x\n")])
    assert [told(outcome) for outcome in outcomes] == ["OperationalError", "FormatError"]
    assert receipts(context) == 0


def test_each_is_worked_on_within_its_request(context: Context, monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[str] = []
    straight = ingest.read

    def read(context: Context, body: Body) -> ParsedLog:
        seen.append(WHERE.get())
        return straight(context, body)

    monkeypatch.setattr(ingest, "read", read)
    batch = []
    for name in ("a", "b"):
        token = WHERE.set(f"request of {name}")
        batch.append(arrival(name, 0))
        WHERE.reset(token)
    intake.receive_together(context, batch)
    assert seen == ["request of a", "request of b"]


def test_keys_are_looked_up_without_a_transaction(context: Context) -> None:
    key = fleet.register(context, schemas.DeviceDraft(id="d", name="d")).key
    ran: list[sa.Connection] = []

    def note(connection: sa.Connection) -> None:
        ran.append(connection)

    event.listen(sa.Engine, "begin", note)
    try:
        assert access.authenticate(context, key).device_id == "d"
    finally:
        event.remove(sa.Engine, "begin", note)
    assert ran == []


def test_every_answer_shows_what_is_stored(context: Context, clock: Clock) -> None:
    """An upload reads what it shows at its beginning: nothing may change meanwhile without being seen."""
    waits = np.random.default_rng(1).uniform(
        20.0, 40.0, 200
    )  # of chunks of 30 s: sessions begin earlier, as it turns out
    for seq, body in enumerate(remounted().chunks):
        outcome = intake.receive(context, "a", ingest.Chunk("s", seq, Body(body, "text/csv", None, "auto")))
        assert outcome.installation == shown(context, "a"), seq
        clock.advance(float(waits[seq]))
    for session, seq in [("t", 1), ("t", 0), ("t", 3), ("u", 0), ("u", 2), ("u", 1), ("v", 1), ("w", 0)]:
        chunk = ingest.Chunk(session, seq, Body(remounted().chunks[seq], "text/csv", None, "auto"))
        assert intake.receive(context, "a", chunk).installation == shown(context, "a"), (session, seq)
        clock.advance(35.0)
    for seq, body in enumerate(crashed().chunks):
        outcome = intake.receive(context, "b", ingest.Chunk("s", seq, Body(body, "text/csv", None, "auto")))
        assert outcome.installation == shown(context, "b"), seq
        clock.advance(float(waits[seq]))
