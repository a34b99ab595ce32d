"""The detector of events of one device, chunk by chunk, while a mounting is in force; another mounting begins anew."""

import logging
from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

import core
from core.motion import events
from core.motion.events import MotionEvent

log = logging.getLogger(__name__)


class Detection(NamedTuple):
    """What a chunk shows."""

    state: bytes | None
    """of the detector; None: no mounting is in force"""
    found: tuple[tuple[int, MotionEvent], ...]
    """each with the number of mountings that the chunk had confirmed before"""


class _Part(NamedTuple):
    """Samples of a chunk under one mounting."""

    samples: core.Samples
    q_vs: ArrayLike | None
    """None: no mounting is in force"""
    confirmed: int
    """mountings that the chunk had confirmed before"""


def begin_session(state: bytes | None) -> bytes | None:
    """The device was switched on: a new clock."""
    return None if state is None else events.encode(events.begin_session(_load(state)))


def detect(
    state: bytes | None, q_vs: ArrayLike | None, changes: Iterable[core.Event], samples: core.Samples
) -> Detection:
    """Look for events in the samples of a chunk.

    Parameters
    ----------
    state
        of the detector before
    q_vs
        (4,) the mounting in force before, None: none was
    changes
        what the estimator reports of this chunk
    samples
        less the accelerometer's errors
    """
    found: list[tuple[int, MotionEvent]] = []
    now = None if state is None or q_vs is None else _load(state)
    for part in _parts(q_vs, changes, samples):
        if part.q_vs is None or part.confirmed:
            now = None
        if part.q_vs is not None and len(part.samples):
            now, happened = events.advance(
                events.DEFAULT, events.initial_state() if now is None else now, part.q_vs, part.samples
            )
            found += [(part.confirmed, event) for event in happened]
    return Detection(None if now is None else events.encode(now), tuple(found))


def _parts(q_vs: ArrayLike | None, changes: Iterable[core.Event], samples: core.Samples) -> Iterator[_Part]:
    """Cut a chunk where a mounting comes into force, or is in doubt."""
    start, confirmed = 0, 0
    for change in changes:
        is_confirmed = change.kind is core.EventKind.CONFIRMED
        if is_confirmed or change.kind is core.EventKind.ORIENTATION_CHANGED:
            stop = max(start, int(np.searchsorted(samples.t, change.t)))
            yield _Part(samples.slice(start, stop), q_vs, confirmed)
            start, confirmed = stop, confirmed + is_confirmed
            q_vs = change.quaternion if is_confirmed else None
    yield _Part(samples.slice(start, len(samples)), q_vs, confirmed)


def _load(state: bytes) -> events.State:
    """Give the state; one that cannot be read begins anew, as after a change of its layout."""
    try:
        return events.decode(state)
    except core.SnapshotError as error:
        log.warning("the detector of events starts anew, its state cannot be read: %s", error)
        return events.initial_state()
