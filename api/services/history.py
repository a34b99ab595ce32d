"""The angle history: packed for storage, thinned for charts."""

from collections.abc import Sequence
from datetime import datetime
from typing import Any

import numpy as np
from numpy.typing import NDArray

import core
from api import schemas
from storage import estimates
from storage.database import ReadSession, WriteSession
from storage.models import EPOCH, MICROSECOND, microseconds

ROW = np.dtype(
    [
        ("t", "<f8"),  # s, session clock
        ("quaternion", "<f4", 4),
        ("sigma", "<f4", 3),  # rad
        ("progress", "<f4"),
        ("stage", "u1"),
        ("stable", "u1"),
        ("reliable", "u1"),
    ]
)
"""A row of history as it is stored, 43 bytes."""

Rows = NDArray[np.void]
OVERSAMPLING = 4
"""Rows read for each point of a chart, at most; of a longer history only some blocks are read."""


def pack(rows: core.Estimates) -> Rows:
    """Give estimates as stored rows."""
    packed = np.empty(rows.t.size, ROW)
    for name in ROW.names or ():
        packed[name] = getattr(rows, name)
    return packed


def append(tx: WriteSession, session_pk: int, rows: core.Estimates, stage_before: int, now: datetime) -> None:
    """Append the estimates of a chunk."""
    if rows.t.size == 0:
        return
    changes = int(np.count_nonzero(np.diff(rows.stage, prepend=stage_before)))
    span = (float(rows.t[0]), float(rows.t[-1]))
    estimates.add(tx, session_pk, span, (rows.t.size, changes), pack(rows).tobytes(), now)


def read(
    tx: ReadSession, device_pk: int, start: datetime | None, end: datetime | None, max_points: int
) -> schemas.Estimates:
    """Give at most `max_points` rows between two moments: the first, the last, changes of stage, and evenly between."""
    marks = estimates.marks(tx, device_pk, start, end)
    blocks = estimates.blocks(tx, choose_blocks(marks, max_points))
    parts = [np.frombuffer(block.rows, ROW) for block in blocks]
    rows = np.concatenate([np.empty(0, ROW), *parts])
    of_block = np.repeat(np.arange(len(parts)), [part.size for part in parts])
    started_at = np.array([microseconds(block.started_at) for block in blocks], np.int64)
    time = started_at[of_block] + np.rint(rows["t"] * 1e6).astype(np.int64)
    inside = np.flatnonzero(_within(time, start, end))
    kept = inside[thin(rows["stage"][inside], max_points)]
    return _columns([blocks[i].session for i in of_block[kept]], time[kept], rows[kept])


def _within(time: NDArray[np.int64], start: datetime | None, end: datetime | None) -> NDArray[np.bool_]:
    after = True if start is None else time >= microseconds(start)
    before = True if end is None else time <= microseconds(end)
    return np.full(time.shape, True) & after & before


def choose_blocks(marks: Sequence[estimates.Mark], max_points: int) -> list[int]:
    """Choose which blocks to read: all of a short history; of a long one evenly, and those where the stage changes."""
    step = max(1, sum(mark.size for mark in marks) // (OVERSAMPLING * max_points))
    last = len(marks) - 1
    return [mark.pk for i, mark in enumerate(marks) if i % step == 0 or i == last or mark.changes]


def thin(stage: NDArray[Any], max_points: int) -> NDArray[np.int64]:
    """Choose at most `max_points` (2 or more) rows: first, last, where the stage changes, and evenly between."""
    n = stage.size
    if n <= max_points:
        return np.arange(n)
    changes = np.flatnonzero(np.diff(stage)) + 1
    needed = np.unique(np.concatenate([[0, n - 1], changes]))
    if needed.size >= max_points:
        return needed[_evenly(needed.size, max_points)]
    return np.union1d(needed, _evenly(n, max_points - needed.size))


def _evenly(n: int, count: int) -> NDArray[np.int64]:
    return np.unique(np.linspace(0, n - 1, count).round().astype(np.int64))


def _columns(session: list[str], time: NDArray[np.int64], rows: Rows) -> schemas.Estimates:
    quaternion = core.quaternion.normalise(rows["quaternion"])
    angles = np.degrees([core.quaternion.angles(q) for q in quaternion]).reshape(-1, 3).round(6).T.tolist()
    stages = {stage.value: stage.word for stage in core.Stage}
    return schemas.Estimates.model_validate(
        {
            "session": session,
            "t": rows["t"].tolist(),
            "time": [EPOCH + us * MICROSECOND for us in time.tolist()],
            "quaternion": quaternion.round(8).tolist(),
            "angles_deg": dict(zip(("roll", "pitch", "yaw"), angles, strict=True)),
            "sigma_deg": np.degrees(rows["sigma"].astype(np.float64)).round(6).tolist(),
            "stage": [stages[value] for value in rows["stage"].tolist()],
            "stable": rows["stable"].astype(bool).tolist(),
            "reliable": rows["reliable"].astype(bool).tolist(),
            "progress": rows["progress"].astype(np.float64).round(6).tolist(),
        }
    )
