"""Samples that were kept, read again: what there is in a period, chunk by chunk."""

from collections.abc import Iterator
from datetime import datetime
from io import BytesIO
from typing import NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.csv

from api import schemas
from api.formats import raw
from api.services.context import Context
from api.services.errors import NotFoundError, SeveralSessionsError
from core import Samples
from storage import raw_chunks
from storage.database import ReadSession
from storage.models import MICROSECOND
from storage.raw_chunks import Stretch

NONE = "No samples of that time are there: they were never sent, or are kept no longer."
NAMED = 10
"""sessions that are named where one has to be chosen"""


class Span(NamedTuple):
    """A part of a session, s on its clock."""

    stretch: Stretch
    start: float
    end: float


def find(tx: ReadSession, device_pk: int, start: datetime | None, end: datetime | None, session: str | None) -> Span:
    """Find what is kept of one session in a period.

    Raises
    ------
    NotFoundError
        nothing is.
    SeveralSessionsError
        there is something of several, and none was named.
    """
    found = raw_chunks.stretches(tx, device_pk, start, end)
    spans = [span for span in (within(stretch, start, end) for stretch in found) if span.stretch.pieces]
    chosen = [span for span in spans if session in (None, span.stretch.session)]
    if not chosen:
        raise NotFoundError(NONE)
    if len(chosen) > 1:
        names = [span.stretch.session for span in chosen]
        told = ", ".join(names[:NAMED]) + (" and more" if len(names) > NAMED else "")
        raise SeveralSessionsError(f"There are samples of {len(names)} sessions; choose one by `session`: {told}.")
    return chosen[0]


def within(stretch: Stretch, start: datetime | None, end: datetime | None) -> Span:
    """Cut a stretch to a period."""
    first = -np.inf if start is None else (start - stretch.started_at) / MICROSECOND * 1e-6
    last = np.inf if end is None else (end - stretch.started_at) / MICROSECOND * 1e-6
    pieces = tuple(piece for piece in stretch.pieces if piece.t_last >= first and piece.t_first <= last)
    return Span(stretch._replace(pieces=pieces), first, last)


def read(context: Context, span: Span) -> Iterator[Samples]:
    """Give the samples, chunk by chunk; each is looked up when it is asked for, what has gone meanwhile is left out."""
    stretch, last = span.stretch, -np.inf
    for piece in stretch.pieces:
        with context.database.look() as tx:
            content = raw_chunks.content(tx, stretch.session_pk, piece.seq)
        if content is not None:
            samples = _between(raw.unpack(content), max(span.start, np.nextafter(last, np.inf)), span.end)
            if len(samples):
                last = float(samples.t[-1])
                yield samples


def _between(samples: Samples, start: float, end: float) -> Samples:
    t = samples.t
    return samples.slice(int(np.searchsorted(t, start)), int(np.searchsorted(t, end, side="right")))


def stream(context: Context, span: Span, form: schemas.RawFormat) -> Iterator[bytes]:
    """Give the samples as a log in a native format, a part for each chunk."""
    columns = span.stretch.columns
    batches = (raw.batch(samples, columns) for samples in read(context, span))
    return _arrow(raw.schema(columns), batches) if form == "arrow" else _csv(raw.schema(columns), batches)


def _arrow(schema: pa.Schema, batches: Iterator[pa.RecordBatch]) -> Iterator[bytes]:
    out = BytesIO()
    with pa.ipc.new_stream(out, schema) as writer:
        for batch in batches:
            writer.write_batch(batch)
            yield _taken(out)
    yield _taken(out)


def _taken(out: BytesIO) -> bytes:
    content = out.getvalue()
    out.seek(0)
    out.truncate()
    return content


def _csv(schema: pa.Schema, batches: Iterator[pa.RecordBatch]) -> Iterator[bytes]:
    yield (",".join(schema.names) + "\n").encode()
    options = pa.csv.WriteOptions(include_header=False, quoting_style="none")
    for batch in batches:
        out = BytesIO()
        columns = [_empty_where_nan(column) for column in batch.columns]
        pa.csv.write_csv(pa.record_batch(columns, schema=schema), out, options)
        yield out.getvalue()


def _empty_where_nan(column: pa.Array) -> pa.Array:
    if pa.types.is_integer(column.type):
        return column
    return pa.array(column.to_numpy(zero_copy_only=False), from_pandas=True)
