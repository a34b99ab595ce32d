"""State <-> versioned bytes.

Layout: magic, format version, a fingerprint of the record layout, then the bytes of each part in order, little-endian
doubles as they are in memory. A state that was saved and loaded goes on bit for bit like one that never was.
"""

import hashlib
import struct
import sys

import numpy as np

from core.state import LAYOUT, State

MAGIC = b"LVLA"
VERSION = 1
_HEADER = struct.Struct("<4sH8s")
_FINGERPRINT = hashlib.sha256("|".join(str(part.descr) for part in LAYOUT).encode()).digest()[:8]  # type: ignore[attr-defined]
SIZE = _HEADER.size + sum(part.itemsize for part in LAYOUT)


class SnapshotError(ValueError):
    """Bytes that are no snapshot of this version."""


def encode(state: State) -> bytes:
    """Give the state as `SIZE` bytes (less than 16 kB)."""
    return _HEADER.pack(MAGIC, VERSION, _FINGERPRINT) + b"".join(part.tobytes() for part in state)


def decode(data: bytes) -> State:
    """Give the state of a snapshot.

    Raises
    ------
    SnapshotError
        not a snapshot, or made by another version
    """
    if sys.byteorder != "little":
        raise SnapshotError("snapshots are little-endian")
    if len(data) < _HEADER.size or data[:4] != MAGIC:
        raise SnapshotError("not an estimator snapshot")
    _, version, fingerprint = _HEADER.unpack_from(data)
    if version != VERSION or fingerprint != _FINGERPRINT:
        raise SnapshotError(f"snapshot of format version {version} cannot be read by version {VERSION}")
    if len(data) != SIZE:
        raise SnapshotError(f"snapshot has {len(data)} bytes, expected {SIZE}")
    offset, parts = _HEADER.size, []
    for dtype in LAYOUT:
        parts.append(np.frombuffer(data, dtype, count=1, offset=offset).copy())
        offset += dtype.itemsize
    return State(*parts)
