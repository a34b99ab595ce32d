"""State <-> versioned bytes.

Layout: magic, format version, a fingerprint of the record layout, then the bytes of each part in order, little-endian
doubles as they are in memory; of the filters' covariances, which the kernel keeps exactly symmetric, one triangle.
A state that was saved and loaded goes on bit for bit like one that never was.
"""

import hashlib
import struct
import sys

import numpy as np
from numpy.typing import NDArray

from core._kernel import STATES
from core.state import FILTER, LAYOUT, State, empty_state, independent

MAGIC = b"LVLA"
VERSION = 2
_HEADER = struct.Struct("<4sH8s")
_ROWS, _COLUMNS = np.tril_indices(STATES)
_KEPT = _ROWS * STATES + _COLUMNS
"""Which elements of a covariance are stored"""
_PLACES = np.zeros((STATES, STATES), np.int64)
"""and where each element is among them."""
_PLACES[_ROWS, _COLUMNS] = _PLACES[_COLUMNS, _ROWS] = np.arange(_ROWS.size)


def _packed(dtype: np.dtype[np.void]) -> np.dtype[np.void]:
    """Layout of a part as it is stored."""
    if dtype != FILTER:
        return dtype
    descr = [
        (name, "<f8", (_ROWS.size,)) if name == "covariance" else (name, dtype[name]) for name in dtype.names or ()
    ]
    return np.dtype(descr)


_STORED = tuple(_packed(np.dtype(part)) for part in LAYOUT)
_COUNTS = tuple(part.shape[0] for part in empty_state())
_FINGERPRINT = hashlib.sha256("|".join(str(dtype.descr) for dtype in _STORED).encode()).digest()[:8]
SIZE = _HEADER.size + sum(dtype.itemsize * count for dtype, count in zip(_STORED, _COUNTS, strict=True))


class SnapshotError(ValueError):
    """Bytes that are no snapshot of this version."""


def encode(state: State) -> bytes:
    """Give the state as `SIZE` bytes (less than 16 kB)."""
    parts = zip(state, _STORED, strict=True)
    return _HEADER.pack(MAGIC, VERSION, _FINGERPRINT) + b"".join(_pack(part, dtype).tobytes() for part, dtype in parts)


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
    for layout, dtype, count in zip(LAYOUT, _STORED, _COUNTS, strict=True):
        parts.append(_unpack(np.frombuffer(data, dtype, count, offset), np.dtype(layout)))
        offset += dtype.itemsize * count
    return State(*parts)


def _pack(part: NDArray[np.void], dtype: np.dtype[np.void]) -> NDArray[np.void]:
    if part.dtype == dtype:
        return part
    packed = np.empty(part.shape, dtype)
    _before_covariance(packed)[:] = _before_covariance(part)
    packed["covariance"] = part["covariance"].reshape(part.size, -1)[:, _KEPT]
    return packed


def _unpack(packed: NDArray[np.void], dtype: np.dtype[np.void]) -> NDArray[np.void]:
    if packed.dtype == dtype:
        return independent(packed.tobytes(), dtype)
    part = np.empty(packed.shape, dtype)
    _before_covariance(part)[:] = _before_covariance(packed)
    part["covariance"] = packed["covariance"][:, _PLACES]
    return part


def _before_covariance(part: NDArray[np.void]) -> NDArray[np.uint8]:
    """Give the bytes of the fields before the covariance, which is the last one, whichever way it is stored."""
    size = part.dtype.itemsize - part.dtype["covariance"].itemsize
    return part.view(np.uint8).reshape(part.size, -1)[:, :size]
