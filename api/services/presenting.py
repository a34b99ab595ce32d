"""Rows of the tables and values of the estimator as the API's documents: radians become degrees here."""

from collections.abc import Iterable
from datetime import datetime, timedelta
from typing import Any

import numpy as np

import core
from api import schemas
from api.services.speed_trace import Trace
from storage import alerts, devices, installations, mounts

HINTS = {
    "data": "Waiting for data: switch the device on and check that it can send.",
    "gps_fix": "Waiting for a GPS fix: drive, or park, under open sky.",
    "motion": "Drive off: the vehicle has to move.",
    "turn": "Take a few turns to the left and to the right.",
    "accelerate_or_brake": "Accelerate and brake firmly a few times on a straight road.",
    "time": "Keep driving as usual.",
}
"""What a driver can do about each need, in the order in which it is told."""
NOTHING_NEEDED = "The mounting is confirmed. Nothing needs to be done."


def hint(stage: str, needs: Iterable[str]) -> str:
    """Give the needs in words a driver or installer can follow."""
    wanted = set(needs)
    sentences = [HINTS[need] for need in HINTS if need in wanted]
    if sentences:
        return " ".join(sentences)
    return NOTHING_NEEDED if stage == "confirmed" else HINTS["time"]


def status(now: core.Status, trace: Trace | None = None, data: dict[str, Any] | None = None) -> dict[str, Any]:
    """Give what is stored of the estimator's status, with the speeds of its drive test and what the data were like."""
    return {
        "progress": now.progress,
        "needs": list(now.needs.words),
        "estimate": None if now.estimate is None else estimate(now.estimate),
        "verification": drive_test(now.verification, trace),
        "data": data,
    }


def estimate(now: core.Estimate) -> dict[str, Any]:
    """Give an estimate, without what follows from its quaternion."""
    return {
        "t": now.t,
        "quaternion": now.quaternion.tolist(),
        "sigma_deg": degrees(now.sigma),
        "stable": bool(now.stable),
        "reliable": bool(now.reliable),
    }


def drive_test(test: core.Verification, trace: Trace | None) -> dict[str, Any]:
    """Give what is stored of a drive test, with its speeds; one that has tested nothing yet has none."""
    return verification(test) | {"trace": trace if test.elapsed > 0 else None}


def verification(test: core.Verification) -> dict[str, Any]:
    """Give how a drive test stands."""
    error = float(test.error)
    return {
        "state": test.state,
        "elapsed_s": float(test.elapsed),
        "duration_s": float(test.duration),
        "error_mps": error if np.isfinite(error) else None,
        "limit_mps": float(test.limit),
    }


def evidence(seen: core.Evidence) -> dict[str, Any]:
    """Give what a sequential test decided on: columns of equal length, and the value that decides."""
    return {"t": seen.t.tolist(), "value": seen.value.tolist(), "threshold": float(seen.threshold)}


def degrees(radians: Any) -> list[float]:
    """Give a vector in degrees."""
    values: list[float] = np.degrees(radians).tolist()
    return values


def rotation(quaternion: list[float]) -> dict[str, Any]:
    """Give the quaternion with its matrix and its angles."""
    roll, pitch, yaw = np.degrees(core.quaternion.angles(quaternion)).tolist()
    return {
        "quaternion": quaternion,
        "matrix": core.quaternion.matrix(quaternion).tolist(),
        "angles_deg": {"roll": roll, "pitch": pitch, "yaw": yaw},
    }


def installation(
    row: installations.Installation,
    device_id: str,
    beside: installations.Beside,
    params: core.Parameters,
) -> schemas.Installation:
    """Give the installation resource."""
    shown = row.status
    now = shown["estimate"]
    started_at = beside.since_started_at
    since = row.since_at if started_at is None or row.since_t is None else utc(started_at, row.since_t)
    return schemas.Installation.model_validate(
        {
            "device_id": device_id,
            "stage": row.stage,
            "since": since,
            "progress": shown["progress"],
            "needs": shown["needs"],
            "hint": hint(row.stage, shown["needs"]),
            "estimate": None if now is None else now | rotation(now["quaternion"]),
            "verification": shown_test(shown["verification"]),
            "mount": None if beside.mount is None else mount(beside.mount),
            "limits": limits(params),
            "open_alerts": beside.open_alerts,
            "last_data_at": row.last_data_at,
            "data": shown.get("data"),
            "revision": row.revision,
        }
    )


def shown_test(stored: dict[str, Any]) -> dict[str, Any]:
    """Give a stored drive test; those from before traces were kept have none."""
    return {"trace": None} | stored


def limits(params: core.Parameters) -> dict[str, float]:
    """Give what an estimate's sigma must be below, in degrees."""
    yaw, tilt = degrees([params.settling.yaw_sigma, params.settling.tilt_sigma])
    return {"yaw_sigma_deg": round(yaw, 6), "tilt_sigma_deg": round(tilt, 6)}


def mount(row: mounts.Mount) -> schemas.Mount:
    """Give a confirmed mounting."""
    return schemas.Mount.model_validate(
        rotation(row.quaternion)
        | {
            "id": row.n,
            "sigma_deg": row.sigma_deg,
            "confirmed_at": utc(row.started_at, row.t),
            "status": row.status,
            "verification": shown_test(row.verification),
        }
    )


def device(row: devices.Device) -> schemas.Device:
    """Give a device."""
    return schemas.Device.model_validate(row, from_attributes=True)


def alert(row: alerts.Alert) -> schemas.Alert:
    """Give an alert."""
    shown = row._asdict()
    return schemas.Alert.model_validate({"id": shown.pop("pk"), "count": shown.pop("occurrences")} | shown)


def utc(started_at: datetime, t: float) -> datetime:
    """Give the moment at `t` seconds on the clock of a session that started at `started_at`."""
    return started_at + timedelta(seconds=t)
