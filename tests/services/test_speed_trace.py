"""Which rows a trace keeps."""

import numpy as np

import core
from api.services.speed_trace import Trace, carry_on, end_session

BEFORE: Trace = {"t": [1.0, 2.0], "gps_mps": [10.0, 11.0], "sensor_mps": [10.5, 11.5]}


def speeds(*rows: tuple[float, bool]) -> core.Speeds:
    t = np.array([t for t, _ in rows])
    return core.Speeds(t, 10 + t, 10.123 + t, np.array([begins for _, begins in rows], bool))


def times(trace: Trace | None) -> list[float]:
    assert trace is not None
    assert len(trace["t"]) == len(trace["gps_mps"]) == len(trace["sensor_mps"])
    return trace["t"]


def test_a_test_that_goes_on_carries_its_trace_on() -> None:
    trace = carry_on(BEFORE, speeds((3.0, False), (4.0, False)))
    assert trace == {
        "t": [1.0, 2.0, 3.0, 4.0],
        "gps_mps": [10.0, 11.0, 13.0, 14.0],
        "sensor_mps": [10.5, 11.5, 13.12, 14.12],
    }
    assert times(BEFORE) == [1.0, 2.0], "what is stored is not changed"


def test_a_new_test_begins_a_new_trace() -> None:
    assert times(carry_on(BEFORE, speeds((3.0, False), (5.0, True), (6.0, False)))) == [5.0, 6.0]
    assert times(carry_on(BEFORE, speeds((5.0, True)))) == [5.0]
    assert times(carry_on(None, speeds((5.0, False), (6.0, False)))) == [5.0, 6.0], "its beginning is in no trace"


def test_at_a_time_the_trace_is_that_of_the_test_then() -> None:
    rows = speeds((3.0, False), (4.0, False), (7.0, True), (8.0, False), (9.0, True))
    assert times(carry_on(BEFORE, rows, 4.0)) == [1.0, 2.0, 3.0, 4.0]
    assert times(carry_on(BEFORE, rows, 8.0)) == [7.0, 8.0]
    assert times(carry_on(BEFORE, rows)) == [9.0]


def test_without_new_rows_it_stays() -> None:
    assert carry_on(BEFORE, speeds()) is BEFORE
    assert carry_on(None, speeds()) is None


def test_the_trace_of_a_running_test_ends_with_its_session() -> None:
    for state, kept in (("running", None), ("passed", BEFORE), ("failed", BEFORE)):
        status = {"progress": 0.5, "verification": {"state": state, "trace": BEFORE}}
        assert end_session(status) == {"progress": 0.5, "verification": {"state": state, "trace": kept}}
    assert end_session({"verification": {"state": "idle"}}) == {"verification": {"state": "idle"}}
