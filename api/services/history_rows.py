"""Rows of the angle history as they are stored."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

import core

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


def pack(rows: core.Estimates) -> Rows:
    """Give estimates as stored rows."""
    packed = np.empty(rows.t.size, ROW)
    for name in ROW.names or ():
        packed[name] = getattr(rows, name)
    return packed


def unpack(blocks: list[bytes]) -> Rows:
    """Give the rows of blocks, one after the other."""
    return np.frombuffer(b"".join(blocks), ROW)


def spaced(rows: Rows, seconds: float, session: NDArray[Any] | None = None) -> NDArray[np.int64]:
    """Choose the first row in each slot of so many seconds, and each whose stage differs from that of the row before.

    Rows chosen so from the first part, followed by the second part and chosen anew, are those chosen from the whole.
    """
    slot = np.floor(rows["t"] / seconds)
    new = np.full(rows.size, True)
    new[1:] = (np.diff(slot) != 0) | (np.diff(rows["stage"]) != 0)
    if session is not None:
        new[1:] |= np.diff(session) != 0
    return np.flatnonzero(new)
