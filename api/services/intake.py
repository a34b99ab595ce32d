"""Chunks on their way in, several at a time.

What each needs is computed first, one after the other; then all of them are stored, on SQLite with one lock and one
commit. While another process has that lock, more are taken in and computed rather than waited. Whether one of them
succeeds is nothing to the others.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from contextvars import copy_context
from functools import partial
from typing import NamedTuple

from api import metrics, schemas
from api.formats import ParsedLog
from api.services import foresight, ingest
from api.services.context import Context
from storage.database import ReadSession, WriteSession


class Arrival(NamedTuple):
    """A chunk that came in."""

    device_id: str
    chunk: ingest.Chunk
    within: Callable[[Callable[[], None]], None]
    """calls a function within the request's own context variables, which the log tells its id from"""


Outcome = schemas.Upload | Exception


def arrival(device_id: str, chunk: ingest.Chunk) -> Arrival:
    """Note a chunk that has come in with the request in work."""
    return Arrival(device_id, chunk, copy_context().run)


def receive(context: Context, device_id: str, chunk: ingest.Chunk) -> schemas.Upload:
    """Take in a chunk: when this returns it is durable, and applied exactly once if it was its turn.

    Raises
    ------
    FormatError, UnusableError
        the chunk cannot be read or used.
    ConflictError
        another chunk has its number, or it comes too late.
    NotFoundError
        no such device.
    """
    (outcome,) = receive_together(context, [arrival(device_id, chunk)])
    if isinstance(outcome, Exception):
        raise outcome
    return outcome


def receive_together(
    context: Context, arrivals: Sequence[Arrival], another: Callable[[], Arrival | None] = lambda: None
) -> list[Outcome]:
    """Take in chunks, and while another process writes those that `another` gives, until it gives None.

    Gives for each, in that order, what is answered, or the error that `receive` raises.
    """
    uploads = [_Upload(context, arrival) for arrival in arrivals]
    _prepare(context, uploads)

    def prepare_another() -> bool:
        if (arrival := another()) is None:
            return False
        uploads.append(_Upload(context, arrival))
        _prepare(context, uploads[-1:])
        return True

    _store(context, uploads, prepare_another)
    context.wake()
    return [upload.told() for upload in uploads]


def _prepare(context: Context, uploads: "Sequence[_Upload]") -> None:
    for upload in uploads:
        upload.attempt(upload.parse)
    if context.database.is_sqlite:  # PostgreSQL locks a single device, and has no time to win
        _foresee(context, [upload for upload in uploads if upload.is_open])


def _foresee(context: Context, uploads: "Sequence[_Upload]") -> None:
    if not uploads:
        return
    with _failing_together(uploads), context.database.look() as tx:
        for upload in uploads:
            upload.attempt(partial(upload.look_up, tx))
    for upload in uploads:
        if upload.is_open:
            upload.attempt(upload.foresee)


def _store(context: Context, uploads: "Sequence[_Upload]", meanwhile: Callable[[], bool]) -> None:
    """Let those take effect that are not refused yet; `meanwhile` may add to them."""
    if not any(upload.is_open for upload in uploads):
        return
    with _failing_together(uploads), context.database.together(meanwhile) as transaction:
        for upload in uploads:
            if upload.is_open:
                upload.attempt(partial(upload.store, transaction))


@contextmanager
def _failing_together(uploads: "Sequence[_Upload]") -> Iterator[None]:
    """Let an error of what they share be the error of each of them, and of no other."""
    try:
        yield
    except Exception as error:
        for upload in uploads:
            upload.fail(error)


class _Upload:
    """A chunk, and how far it has come."""

    _parsed: ParsedLog
    """once it is read"""

    def __init__(self, context: Context, arrival: Arrival) -> None:
        self.context = context
        self.device_id, self.chunk, self._within = arrival
        self._watch = metrics.Upload(arrival.chunk.body.content_type)
        self._stand: foresight.Stand | None = None
        self._foresight: foresight.Foresight | None = None
        self._answer: schemas.Upload | None = None
        self._error: Exception | None = None

    @property
    def is_open(self) -> bool:
        """True until there is an answer or an error."""
        return self._answer is None and self._error is None

    def attempt(self, step: Callable[[], None]) -> None:
        """Take a step; an error ends the way of this chunk only."""
        with self._watch:
            try:
                self._within(step)
            except Exception as error:
                self._error = error

    def fail(self, error: Exception) -> None:
        """What was done did not become durable."""
        self._error = self._error or error

    def parse(self) -> None:
        """Read the bytes."""
        self._watch.start()
        self._parsed = ingest.read(self.context, self.chunk.body)
        self._watch.lap("parse")

    def look_up(self, tx: ReadSession) -> None:
        """Find where the device stands."""
        self._stand = foresight.look_up(tx, self.device_id, self.chunk.session, self.chunk.seq)

    def foresee(self) -> None:
        """Advance the estimator beforehand."""
        if self._stand is not None:
            self._watch.start()
            self._foresight = foresight.foresee(self.context, self._stand, self._parsed)
            self._watch.lap("foresee")

    def store(self, transaction: Callable[[], AbstractContextManager[WriteSession]]) -> None:
        """Take effect."""
        with transaction() as tx:
            self._watch.lap("wait")
            self._answer = ingest.apply(tx, self.context, self.device_id, self.chunk, self._parsed, self._foresight)
            self._watch.lap("store")

    def told(self) -> Outcome:
        """Give what there is to answer, and count it."""
        if self._error is not None or self._answer is None:
            error = self._error or RuntimeError("a chunk was neither taken in nor refused")
            metrics.refused(error)
            return error
        self._watch.lap("commit")
        chunk = self._answer.chunk
        self._watch.answered("duplicate" if chunk.duplicate else chunk.state, chunk.rejected)
        return self._answer
