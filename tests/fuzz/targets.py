"""Every parser of bytes that strangers send, each with what must hold whatever the bytes are.

A target takes bytes and returns, or raises: any exception is a finding.
"""

import json
from collections.abc import Callable
from contextlib import suppress
from typing import get_args

import numpy as np

import core
from api.formats import FormatError, Limits, ParsedLog, decode, parse
from api.schemas import DeviceOrder
from api.services import paging
from api.services.calibration import last_time
from api.services.errors import CursorError, UnusableError
from core import snapshot
from storage.events import Position

LIMITS = Limits(max_encoded_bytes=2**20, max_decoded_bytes=2**20, max_rows=20_000)
SENSES = ("auto", "clockwise", "anticlockwise")
ENCODINGS = ("gzip", "zstd", "identity", "br")
FORMAT_STATUSES = {400, 413, 415, 422}


def native_csv(data: bytes) -> None:
    _log(data, "text/csv")


def thesis_log(data: bytes) -> None:
    """Read a thesis log; the first byte chooses the sense of the course."""
    _log(data[1:], "text/vnd.livella.tmd2", SENSES[data[0] % len(SENSES)] if data else "auto")


def arrow_stream(data: bytes) -> None:
    _log(data, "application/vnd.apache.arrow.stream")


def compression(data: bytes) -> None:
    """Decompress; the first byte chooses the encoding."""
    try:
        content = decode(data[1:], ENCODINGS[data[0] % len(ENCODINGS)] if data else None, LIMITS)
    except FormatError as error:
        _check_error(error)
        return
    assert len(content) <= LIMITS.max_decoded_bytes


def estimator(data: bytes) -> None:
    """Read a native log and let the estimator have it: whatever was read can be used, saved and loaded."""
    with suppress(FormatError, UnusableError):
        samples = parse(data, "text/csv", None, LIMITS).samples().samples
        last_time(samples)
        _estimate(samples)


def cursor(data: bytes) -> None:
    text = data.decode(errors="replace")
    with suppress(CursorError):
        inside = paging.decode(text)
        assert "\0" not in inside
        assert paging.decode(paging.encode(inside)) == inside
    for order in get_args(DeviceOrder):
        with suppress(CursorError):
            assert paging.decode_place_in(order, text).id in paging.decode(text)
    with suppress(CursorError):
        assert 0 <= paging.decode_number(text) < 2**63


def estimator_snapshot(data: bytes) -> None:
    with suppress(snapshot.SnapshotError):
        assert snapshot.encode(snapshot.decode(data)) == data


def event_position(data: bytes) -> None:
    position = Position.parse(data.decode(errors="replace"))
    if position is not None:
        assert Position.parse(str(position)) == position
        assert all(0 <= number < 2**63 for number in position)


TARGETS: dict[str, Callable[[bytes], None]] = {
    target.__name__: target
    for target in (
        native_csv,
        thesis_log,
        arrow_stream,
        compression,
        estimator,
        cursor,
        estimator_snapshot,
        event_position,
    )
}


def _estimate(samples: core.Samples) -> None:
    state = core.begin_session(core.DEFAULT, core.initial_state(core.DEFAULT))
    with suppress(core.SampleError):
        state, outcome = core.advance(core.DEFAULT, state, samples)
        assert all(np.isfinite(column).all() for column in outcome.estimates)
    assert snapshot.encode(snapshot.decode(snapshot.encode(state))) == snapshot.encode(state)


def _log(content: bytes, media_type: str, course: str = "auto") -> None:
    try:
        log = parse(content, media_type, None, LIMITS, course)
    except FormatError as error:
        _check_error(error)
        return
    _check_log(log)


def _check_error(error: FormatError) -> None:
    """A refusal says why, in words that fit into an answer."""
    assert error.status in FORMAT_STATUSES
    assert error.title
    assert error.detail
    assert error.problems or error.status != 422
    for problem in error.problems:
        assert problem.line is None or 1 <= problem.line <= LIMITS.max_decoded_bytes + 1
        assert problem.expected
        assert problem.message
        assert len(problem.message) < 2000
        assert str(problem).isprintable(), problem


def _check_log(log: ParsedLog) -> None:
    """What was read is sound, twice the same, and its context is JSON."""
    samples, rejected, context = log.samples()
    assert 0 < log.rows <= LIMITS.max_rows
    assert len(samples) == log.rows
    assert np.isfinite(samples.t).all()
    assert (samples.t[1:] >= samples.t[:-1]).all()
    assert np.isfinite(samples.f_s).all()
    assert (np.diff(samples.fix_row) > 0).all()
    assert samples.fix.shape == (samples.fix_row.size, len(core.FIX_COLUMNS))
    assert not np.isinf(samples.fix).any()
    assert all(count > 0 for count in rejected.values())
    assert json.loads(json.dumps(context, allow_nan=False)) == context
    assert all(notice.isprintable() for notice in log.notices)
    log.samples(json.loads(json.dumps(context)))
