"""The angle history: fine for some days, then a point a minute; thinned for charts."""

from datetime import datetime
from typing import Any

import numpy as np
from numpy.typing import NDArray

import core
from api import schemas
from api.services.history_rows import Rows, pack, spaced, unpack
from storage import coarse_estimates, estimates
from storage.database import ReadSession, WriteSession
from storage.estimates import Block
from storage.models import EPOCH, MICROSECOND, microseconds

OVERSAMPLING = 2
"""Rows read for each point of a chart, about; of a longer history only some blocks are read."""
SKETCH = 1800.0
"""s between two rows of the sketch that is kept of each coarse day, for charts over months"""
FINEST = 1e-3
"""s; no rows are closer"""


def append(
    tx: WriteSession, device_pk: int, session_pk: int, rows: core.Estimates, stage_before: int, now: datetime
) -> None:
    """Append the estimates of a chunk."""
    if rows.t.size == 0:
        return
    changes = int(rows.stage[0] != stage_before) + int(np.count_nonzero(rows.stage[1:] != rows.stage[:-1]))
    span = (float(rows.t[0]), float(rows.t[-1]))
    estimates.add(tx, device_pk, session_pk, span, (rows.t.size, changes), pack(rows).tobytes(), now)


def read(
    tx: ReadSession, device_pk: int, start: datetime | None, end: datetime | None, max_points: int
) -> schemas.Estimates:
    """Give at most `max_points` rows between two moments: the first, the last, changes of stage, and evenly between."""
    blocks, spacing = _blocks(tx, device_pk, start, end, max_points)
    rows = unpack([block.rows for block in blocks])
    of_block = np.repeat(np.arange(len(blocks)), [len(block.rows) // rows.itemsize for block in blocks])
    started_at = np.array([microseconds(block.started_at) for block in blocks], np.int64)
    time = started_at[of_block] + np.rint(rows["t"] * 1e6).astype(np.int64)
    inside = np.flatnonzero(_within(time, start, end))
    if inside.size > max_points:
        inside = inside[_evenly_in_time(rows[inside], spacing, started_at[of_block[inside]])]
    kept = inside[thin(rows["stage"][inside], max_points)]
    kept = kept[np.argsort(time[kept], kind="stable")]  # sessions overlap when the clock was set back
    return _columns([blocks[i].session for i in of_block[kept]], time[kept], rows[kept])


def _blocks(
    tx: ReadSession, device_pk: int, start: datetime | None, end: datetime | None, max_points: int
) -> tuple[list[Block], float]:
    """Read the blocks of a period, coarse and fine, as many as a chart needs; give the spacing of its rows too, s."""
    days, period = coarse_estimates.days(start, end), (start, end)
    fine = estimates.extent(tx, device_pk, period)
    long_ago = coarse_estimates.seconds(tx, device_pk, days)
    if start is not None and end is not None:
        long_ago = min(long_ago, max((end - start).total_seconds(), 0.0))  # less than the days in which it lies
    spacing = (long_ago + fine.seconds) / (OVERSAMPLING * max_points)
    few = long_ago == 0 and fine.rows <= OVERSAMPLING * max_points
    coarse = coarse_estimates.blocks(tx, device_pk, days, sketch=spacing >= SKETCH)
    return coarse + estimates.blocks(tx, device_pk, period, None if few else max(spacing, FINEST)), spacing


def _within(time: NDArray[np.int64], start: datetime | None, end: datetime | None) -> NDArray[np.bool_]:
    after = True if start is None else time >= microseconds(start)
    before = True if end is None else time <= microseconds(end)
    return np.full(time.shape, True) & after & before


def _evenly_in_time(rows: Rows, spacing: float, started_at: NDArray[np.int64]) -> NDArray[np.int64]:
    """Choose rows as far apart where they are fine as where they are coarse; the last one too."""
    if spacing == 0.0:
        return np.arange(rows.size)
    return np.union1d(spaced(rows, spacing, started_at), [rows.size - 1])


def thin(stage: NDArray[Any], max_points: int) -> NDArray[np.int64]:
    """Choose at most `max_points` (2 or more) rows: first, last, where the stage changes, and evenly between."""
    n = stage.size
    if n <= max_points:
        return np.arange(n)
    changes = np.flatnonzero(np.diff(stage)) + 1
    needed = np.unique(np.concatenate([[0, n - 1], changes]))
    if needed.size >= max_points:
        return needed[evenly(needed.size, max_points)]
    return np.union1d(needed, evenly(n, max_points - needed.size))


def evenly(n: int, count: int) -> NDArray[np.int64]:
    """Choose `count` of `n`, evenly, the first and the last among them."""
    return np.unique(np.linspace(0, n - 1, count).round().astype(np.int64))


def _columns(session: list[str], time: NDArray[np.int64], rows: Rows) -> schemas.Estimates:
    quaternion = core.quaternion.normalise(rows["quaternion"])
    angles = np.degrees(core.quaternion.all_angles(quaternion)).round(6).T.tolist()
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
