"""The path of an upload.

Chunks of a session take effect in the order of their numbers, exactly once. One that is ahead of its turn waits,
durably; the gap before it is declared lost when the oldest waiting chunk has waited `gap_timeout`, when
`max_waiting_chunks` wait in all of the device's sessions, or when a newer session begins. Then time goes on: a chunk
for a gap declared lost, like one of a session that has ended, is refused, because applying it would run time backwards.
"""

import logging
from datetime import timedelta
from typing import NamedTuple

import numpy as np

from api import schemas
from api.formats import FormatError, Limits, ParsedLog, Reading, parse, raw
from api.services import last_data
from api.services.calibration import Calibration, last_time
from api.services.context import Context
from api.services.errors import (
    ChunkConflictError,
    NotFoundError,
    SequencePassedError,
    SessionEndedError,
    UnusableError,
)
from api.services.foresight import Foresight, pack
from storage import chunks, raw_chunks, sessions
from storage.chunks import APPLIED, WAITING, Body, Receipt, Waiting
from storage.database import WriteSession
from storage.raw_chunks import RawChunk
from storage.sessions import Session

log = logging.getLogger(__name__)


class Chunk(NamedTuple):
    """A chunk as it came in."""

    session: str
    seq: int
    body: Body


def apply(
    tx: WriteSession, context: Context, device_id: str, chunk: Chunk, parsed: ParsedLog, foresight: Foresight | None
) -> schemas.Upload:
    """Take in a chunk that was read: applied exactly once if it was its turn, kept if it is ahead.

    Raises
    ------
    UnusableError
        the chunk cannot be used.
    ConflictError
        another chunk has its number, or it comes too late.
    NotFoundError
        no such device.
    """
    calibration = Calibration.open(tx, context, device_id)
    calibration.foresight = foresight
    session = calibration.find_session(chunk.session)
    # one whose turn it is cannot have come in before: it would have been applied
    known = None if chunk.seq == session.next_seq else chunks.find(tx, session.pk, chunk.seq)
    if known is None:
        receipt = take(calibration, session, chunk, parsed)
        calibration.save()
    else:
        receipt = same(known, parsed)
    return schemas.Upload(
        chunk=_present(chunk.session, receipt, known is not None, parsed), installation=calibration.shown()
    )


def read(context: Context, body: Body) -> ParsedLog:
    """Read the bytes of a chunk; pure."""
    settings = context.settings
    limits = Limits(settings.max_chunk_bytes, settings.max_decoded_bytes)
    return parse(body.body, body.content_type, body.content_encoding, limits, body.course)


def same(known: Receipt, parsed: ParsedLog) -> Receipt:
    """Give the receipt of a chunk that comes once more, if it is the same one."""
    if not parsed.fingerprint.matches(known.digest):
        raise ChunkConflictError(f"Chunk {known.seq} of this session came in before, with other content.")
    return known


def take(calibration: Calibration, session: Session, chunk: Chunk, parsed: ParsedLog) -> Receipt:
    """Take in a new chunk: apply it, and what waited for it, if it is its turn; else let it wait."""
    _refuse_late(calibration, session, chunk.seq)
    reading = _read(calibration, session, parsed)
    receipt = _receipt(calibration, session, chunk, parsed.fingerprint.digest, reading)
    if chunk.seq == session.next_seq:
        _enter(calibration, session)
        receipt = _apply(calibration, session, receipt, reading)
        chunks.add(calibration.tx, receipt)
        catch_up(calibration)
        return receipt
    chunks.add(calibration.tx, receipt, chunk.body)
    calibration.look_anew()
    catch_up(calibration)  # it may be the one too many that declares the gap
    return chunks.find(calibration.tx, session.pk, chunk.seq) or receipt


def _read(calibration: Calibration, session: Session, parsed: ParsedLog) -> Reading:
    foresight = calibration.foresight
    if foresight is not None and foresight.session_context == session.context:
        return foresight.reading
    return parsed.samples(session.context)


def catch_up(calibration: Calibration) -> None:
    """Apply the waiting chunks whose turn has come, declaring the gaps that have been open long enough."""
    waiting = _sessions_waiting(calibration)
    for session_pk in waiting[:-1]:
        _drain(calibration, session_pk, declare_gaps=_too_many(calibration, waiting))
    for session_pk in waiting[-1:]:
        _drain(calibration, session_pk, declare_gaps=False)


def _sessions_waiting(calibration: Calibration) -> list[int]:
    if calibration.nothing_waits:
        return []
    return chunks.sessions_waiting(calibration.tx, calibration.row.device_pk, calibration.row.session_pk)


def _too_many(calibration: Calibration, sessions_waiting: list[int]) -> bool:
    """Tell whether too many chunks wait in all: a device that begins session after session has its bound too."""
    number = sum(chunks.waiting(calibration.tx, session_pk).number for session_pk in sessions_waiting)
    return number >= calibration.context.settings.max_waiting_chunks


def close_gaps(context: Context) -> None:
    """Declare the gaps that have been open too long, on every device; called now and then."""
    now = context.clock()
    with context.database.read() as tx:
        overdue = chunks.devices_waiting_since(tx, now - _gap_timeout(context), now)
    for device_id in overdue:
        try:
            _close_gaps_of(context, device_id)
        except NotFoundError:
            continue  # removed meanwhile
        except Exception:
            log.exception("device %s: its gap cannot be closed", device_id)
            continue
        context.wake()


def _close_gaps_of(context: Context, device_id: str) -> None:
    with context.database.write() as tx:
        calibration = Calibration.open(tx, context, device_id)
        chunks.bring_back(tx, _sessions_waiting(calibration), calibration.now)
        catch_up(calibration)
        calibration.save()


def _refuse_late(calibration: Calibration, session: Session, seq: int) -> None:
    current = calibration.row.session_pk
    if current is not None and session.pk < current:
        raise SessionEndedError("A newer session of this device has begun; do not send this chunk again.")
    if seq < session.next_seq:
        raise SequencePassedError(
            f"Chunk {seq} came in long ago, or was declared lost, and later ones were applied; do not send it again."
        )


def _receipt(calibration: Calibration, session: Session, chunk: Chunk, digest: str, reading: Reading) -> Receipt:
    """Make the receipt of a chunk that waits; what cannot be used is refused now rather than when its turn comes."""
    samples, rejected, _ = reading
    span = (float(samples.t[0]), last_time(samples)) if len(samples) else (None, None)
    fixes = int(np.count_nonzero(samples.fix_valid))
    return Receipt(session.pk, chunk.seq, digest, WAITING, len(samples), fixes, rejected, calibration.now, *span)


def _enter(calibration: Calibration, session: Session) -> None:
    """Make this the current session; what waits in the ones before it is applied first, their gaps are lost."""
    if calibration.row.session_pk == session.pk:
        return
    for session_pk in _sessions_waiting(calibration):
        if session_pk < session.pk:
            _drain(calibration, session_pk, declare_gaps=True)
    calibration.begin(session)


def _drain(calibration: Calibration, session_pk: int, declare_gaps: bool) -> None:
    """Apply what waits in a session, in order, up to a gap that stays open."""
    while (waiting := chunks.waiting(calibration.tx, session_pk)).first_seq is not None:
        session = sessions.get(calibration.tx, session_pk)
        if not (declare_gaps or waiting.first_seq == session.next_seq or _overdue(calibration, waiting)):
            return
        _enter(calibration, session)
        _apply_waiting(calibration, session, waiting.first_seq)


def _overdue(calibration: Calibration, waiting: Waiting) -> bool:
    context = calibration.context
    too_many = waiting.number >= context.settings.max_waiting_chunks
    return too_many or (waiting.since is not None and waiting.since <= calibration.now - _gap_timeout(context))


def _gap_timeout(context: Context) -> timedelta:
    return timedelta(seconds=context.settings.gap_timeout)


def _apply_waiting(calibration: Calibration, session: Session, seq: int) -> None:
    """Apply a chunk that waited; one that turns out unusable is passed over and counted."""
    receipt, body = chunks.find_waiting(calibration.tx, session.pk, seq)
    try:
        reading = read(calibration.context, body).samples(session.context)
        receipt = _apply(calibration, session, receipt, reading)
    except (FormatError, UnusableError) as error:
        log.warning("device %s: chunk %d of %s is unusable: %s", calibration.device_id, seq, session.name, error)
        receipt = receipt._replace(state=APPLIED, samples=0, fixes=0, rejected={"unusable": receipt.samples})
        sessions.save(calibration.tx, session._replace(next_seq=seq + 1))
    chunks.settle(calibration.tx, receipt)


def _apply(calibration: Calibration, session: Session, receipt: Receipt, reading: Reading) -> Receipt:
    """Advance the estimator by one chunk and the session by one number."""
    session, outcome = calibration.apply(session, receipt.seq, reading, receipt.received_at)
    sessions.save(calibration.tx, session._replace(next_seq=receipt.seq + 1))
    if outcome is None:
        return receipt._replace(state=APPLIED)
    _keep(calibration, receipt, reading)
    rejected = last_data.rejected(reading, outcome)
    return receipt._replace(state=APPLIED, samples=outcome.samples, fixes=outcome.fixes, rejected=rejected)


def _keep(calibration: Calibration, receipt: Receipt, reading: Reading) -> None:
    """Keep the samples as they came."""
    foresight = calibration.foresight
    if foresight is not None and foresight.reading is reading:
        content = foresight.raw
    else:
        content = pack(calibration.context, reading)
    if content is None:
        return
    device_pk, columns = calibration.row.device_pk, " ".join(raw.names(content))
    span = float(reading.samples.t[0]), float(reading.samples.t[-1])
    chunk = RawChunk(receipt.session_pk, receipt.seq, device_pk, *span, receipt.received_at, columns, content)
    raw_chunks.add(calibration.tx, chunk)


def _present(session: str, receipt: Receipt, duplicate: bool, parsed: ParsedLog) -> schemas.Chunk:
    return schemas.Chunk.model_validate(
        {
            "session": session,
            "seq": receipt.seq,
            "samples": receipt.samples,
            "fixes": receipt.fixes,
            "rejected": receipt.rejected,
            "duplicate": duplicate,
            "state": receipt.state,
            "notices": parsed.notices,
        }
    )
