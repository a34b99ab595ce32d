import json
from datetime import UTC, datetime
from typing import Any, get_args

import numpy as np
import pytest

from api import schemas
from api.services.findings import ALERTS, FAULTS, Where, finding
from core import Event, EventKind, Evidence, Fault
from storage.alerts import SEVERITIES

WHERE = Where("a", datetime(2024, 5, 6, 7, 0, 0, tzinfo=UTC), 3)
EVIDENCE = Evidence(np.array([500.0, 505.0, 510.0]), np.array([0.0, 25.0, 61.5]), 60.0)


def event(kind: EventKind, **known: Any) -> Event:
    nothing = dict.fromkeys(("quaternion", "sigma", "verification", "angle", "reason"))
    return Event(t=510.0, kind=kind, **(nothing | known))


MOVED = event(
    EventKind.ORIENTATION_CHANGED,
    quaternion=np.array([1.0, 0.0, 0.0, 0.0]),
    sigma=np.radians([1.0, 2.0, 3.0]),
    angle=np.radians(14.004),
    axis=np.array([0.0, 0.0, 1.0]),
    since=492.25,
    evidence=EVIDENCE,
)


def test_a_moved_device() -> None:
    found = finding(MOVED, WHERE)
    assert found is not None
    assert found.kind == "orientation_changed"
    assert found.severity == "warning"
    assert found.message == (
        "The device turned 14 degrees to the left around 2024-05-06 07:08 UTC: the confirmed mounting no longer holds."
    )
    assert found.data.pop("sigma_deg") == pytest.approx([1, 2, 3])
    assert found.data == {
        "session": "a",
        "t": 510.0,
        "at": "2024-05-06T07:08:30.000Z",
        "since_t": 492.25,
        "since": "2024-05-06T07:08:12.250Z",
        "mount": 3,
        "quaternion": [1, 0, 0, 0],
        "angle_deg": 14.0,
        "axis": [0, 0, 1],
        "evidence": {"t": [500, 505, 510], "value": [0, 25, 61.5], "threshold": 60.0},
        "fault": None,
        "reason": None,
        **dict.fromkeys(("seen", "threshold", "unit")),
    }


def test_a_moved_device_of_which_nothing_more_is_known() -> None:
    found = finding(event(EventKind.ORIENTATION_CHANGED), Where("a", None, None))
    assert found is not None
    assert found.message == "The device moved: the confirmed mounting no longer holds."
    known = {name: value for name, value in found.data.items() if value is not None}
    assert known == {"session": "a", "t": 510.0}


def test_a_time_on_a_clock_whose_zero_is_unknown_is_still_told() -> None:
    found = finding(MOVED, WHERE._replace(started_at=None))
    assert found is not None
    assert (found.data["since_t"], found.data["since"], found.data["at"]) == (492.25, None, None)
    assert "UTC" not in found.message


@pytest.mark.parametrize(
    ("fault", "kind", "severity", "words"),
    [
        (Fault.LEFT_HANDED, "sensor_fault", "critical", ("mirror image (left-handed)", "one axis must be negated")),
        (Fault.STUCK_AXIS, "sensor_fault", "critical", ("repeats one value", "replace it")),
        (Fault.SATURATED, "sensor_fault", "warning", ("end of their range", "larger range")),
        (Fault.DEVICE_LOOSE, "device_loose", "critical", ("is loose", "fasten it")),
    ],
)
def test_a_fault_says_what_is_wrong_and_the_remedy(
    fault: Fault, kind: str, severity: str, words: tuple[str, ...]
) -> None:
    seen = event(EventKind.FAULT, fault=fault, reason="in the estimator's words", since=30.0, evidence=EVIDENCE)
    found = finding(seen, WHERE)
    assert found is not None
    assert (found.kind, found.severity) == (kind, severity)
    assert all(word in found.message for word in words)
    assert found.message.endswith(" Seen since 2024-05-06 07:00 UTC.")
    assert (found.data["fault"], found.data["reason"]) == (fault.value, "in the estimator's words")
    assert found.data["evidence"]["threshold"] == 60.0


def test_a_fault_that_is_not_named_tells_its_reason() -> None:
    found = [finding(event(EventKind.FAULT, reason=reason), WHERE) for reason in ("It smokes.", None)]
    assert [f and f.message for f in found] == ["It smokes.", "The sensor's readings cannot be right."]
    assert {f and (f.kind, f.severity) for f in found} == {("sensor_fault", "warning")}


@pytest.mark.parametrize("kind", [EventKind.VERIFICATION_FAILED, EventKind.CONFIRMED])
def test_the_course_of_a_calibration_is_no_alert(kind: EventKind) -> None:
    assert finding(event(kind), WHERE) is None


def test_every_fault_has_an_alert_and_a_sentence_and_the_api_knows_them() -> None:
    assert set(FAULTS) == set(Fault)
    assert set(ALERTS) >= set(Fault)
    assert {kind for kind, _ in ALERTS.values()} <= set(get_args(schemas.AlertKind))
    assert {severity for _, severity in ALERTS.values()} <= set(SEVERITIES)
    assert set(get_args(schemas.Severity)) == set(SEVERITIES)


def test_the_data_is_strict_json() -> None:
    found = finding(MOVED._replace(fault=Fault.DEVICE_LOOSE), WHERE)
    assert found is not None
    json.dumps(found.data, allow_nan=False)
