"""The speeds of a drive test as they are kept: with the installation, and with the mounting that the test confirmed."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

import core

Trace = dict[str, list[float]]
DECIMALS = 2
"""of s and m/s"""


def carry_on(trace: Trace | None, tested: core.Speeds, until: float = math.inf) -> Trace | None:
    """Give the trace of the test that had begun last at a time: a new one, or `trace` carried on."""
    stop = int(np.searchsorted(tested.t, until, side="right"))
    begun = np.flatnonzero(tested.begins[:stop])
    start = int(begun[-1]) if begun.size else 0
    if start == stop:
        return trace
    rows = {
        "t": _listed(tested.t[start:stop]),
        "gps_mps": _listed(tested.gps[start:stop]),
        "sensor_mps": _listed(tested.sensor[start:stop]),
    }
    return rows if trace is None or begun.size else {name: trace[name] + column for name, column in rows.items()}


def end_session(status: dict[str, Any]) -> dict[str, Any]:
    """Give an installation's status for the next session: a running test goes on, its trace by another clock."""
    verification = status["verification"]
    if verification["state"] != "running":
        return status
    return status | {"verification": verification | {"trace": None}}


def _listed(column: NDArray[np.float64]) -> list[float]:
    listed: list[float] = column.round(DECIMALS).tolist()
    return listed
