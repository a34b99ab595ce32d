"""What happened to a vehicle: events of its motion, stored, shown, and told as alerts where they are impacts."""

import math
from datetime import datetime
from typing import Any

import numpy as np

from api import schemas
from api.services import alerting, findings, presenting, words
from api.services.context import Context
from core.motion.events import EventKind, MotionEvent
from storage import motion_events
from storage.alerts import Finding
from storage.database import WriteSession
from storage.sessions import Session

G = 9.80665
KMH = 3.6
IMPACT = "impact"
"""kind of alert; nothing but a person ends it"""


def record(
    tx: WriteSession,
    context: Context,
    device_pk: int,
    chunk: tuple[Session, int],
    event: MotionEvent,
    mount: int,
    now: datetime,
) -> None:
    """Store an event found in a chunk of a session under mounting number `mount`; an impact is an alert."""
    session, seq = chunk
    at = now if session.started_at is None else presenting.utc(session.started_at, event.t)
    data = _stored(event, mount)
    number = motion_events.add(tx, device_pk, (session.pk, seq), str(event.kind), event.t, at, data)
    if event.kind is EventKind.IMPACT:
        alerting.raise_(tx, context, device_pk, impact(number, session.name, at, event, mount), now)


def _stored(event: MotionEvent, mount: int) -> dict[str, Any]:
    """Give what is stored of an event beside its kind and time, SI units and radians."""
    return {
        "start": event.start,
        "duration": event.duration,
        "peak": event.peak,
        "direction": _known(event.direction),
        "velocity_change": list(event.velocity_change),
        "speed": _known(event.speed),
        "mount": mount,
    }


def _known(value: float) -> float | None:
    return value if math.isfinite(value) else None


def present(row: motion_events.MotionEvent) -> schemas.MotionEvent:
    """Give an event."""
    shown = _shown(row.pk, row.at, row.t, row.data)
    return schemas.MotionEvent.model_validate(shown | {"kind": row.kind, "session": row.session, "kept": row.kept})


def _shown(number: int, at: datetime, t: float, data: dict[str, Any]) -> dict[str, Any]:
    direction = data["direction"]
    return {
        "id": number,
        "at": at,
        "start_at": presenting.utc(at, data["start"] - t),
        "duration_s": round(data["duration"], 4),
        "peak_mps2": round(data["peak"], 3),
        "direction_deg": None if direction is None else round(math.degrees(direction), 2),
        "speed_change_mps": [round(part, 3) for part in data["velocity_change"]],
        "speed_mps": None if data["speed"] is None else round(data["speed"], 3),
        "mount": data["mount"],
        "t": t,
    }


def impact(number: int, session: str, at: datetime, event: MotionEvent, mount: int) -> Finding:
    """Give the alert of an impact, event number `number`; its data tell beside the usual what is known of it."""
    shown = _shown(number, at, event.t, _stored(event, mount))
    told = ("direction_deg", "peak_mps2", "duration_s", "speed_change_mps", "speed_mps")
    known = {
        "session": session,
        "t": event.t,
        "at": findings.text(at),
        "since_t": event.start,
        "since": findings.text(shown["start_at"]),
        "mount": mount,
        "event": number,
    }
    message = impact_message(event, at)
    return Finding(IMPACT, "critical", message, findings.data(known | {name: shown[name] for name in told}))


def impact_message(event: MotionEvent, at: datetime) -> str:
    """Say what an impact was like, such as "Impact from the front left (38 degrees), 12 g for 90 ms, ..."."""
    where = ""
    if math.isfinite(event.direction):
        degrees = words.degrees_text(abs(math.degrees(event.direction)))
        where = f" from the {words.side(event.direction)} ({degrees} degrees)"
    change = float(np.hypot(*event.velocity_change)) * KMH
    return (
        f"Impact{where}, {words.degrees_text(event.peak / G)} g for {1e3 * event.duration:.0f} ms, "
        f"speed changed by {change:.0f} km/h, at {at:%H:%M} UTC."
    )
