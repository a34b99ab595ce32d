"""What the service decides by, each with its unit and its meaning, for people: angles in degrees.

Units and meanings are said where a number is declared: in `core/params.py`, in `rules/limits.py`, in `api/settings.py`.
"""

import math
from collections.abc import Iterator
from typing import get_args

import core
from api import schemas
from api.services.context import Context
from api.services.rules import Limits
from api.settings import Settings
from core.motion import events

ESTIMATOR = {"settling": "settling", "verification": "verification", "change": "change", "fault": "alerts"}
"""group by stage of the estimator"""
SETTINGS = {
    "alert_stalled_minutes": "alerts",
    "alert_failed_tests": "alerts",
    "alert_gps_lost_minutes": "alerts",
    "alert_silent_hours": "alerts",
    "alert_reopen_minutes": "alerts",
    "max_chunk_bytes": "upload",
    "max_decoded_bytes": "upload",
    "gap_timeout": "upload",
    "max_waiting_chunks": "upload",
    "device_requests_per_minute": "upload",
    "history_days": "retention",
    "coarse_history_days": "retention",
    "receipt_days": "retention",
    "raw_retention_days": "retention",
    "delivery_days": "retention",
    "audit_days": "retention",
}
"""group by name; no secret is among them, nor what only tells where things are"""
UNITS = {"bytes": "bytes", "timeout": "s", "minutes": "min", "hours": "h", "days": "d", "minute": "1/min"}
"""of a setting, by the end of its name"""


def listed(context: Context) -> schemas.Thresholds:
    """Give them all, group by group."""
    found = [
        *_of_estimator(context.params),
        *_of_events(),
        *_of_rules(context.settings),
        *_of_settings(context.settings),
    ]
    groups = get_args(schemas.ThresholdGroup)
    return schemas.Thresholds(items=sorted(found, key=lambda row: groups.index(row.group)))


def _of_estimator(params: core.Parameters) -> Iterator[schemas.Threshold]:
    for stage, group in ESTIMATOR.items():
        yield from (_row(stage, group, found) for found in core.thresholds(getattr(params, stage)))


def _of_events() -> Iterator[schemas.Threshold]:
    return (_row("events", "events", found) for found in core.thresholds(events.DEFAULT))


def _of_rules(settings: Settings) -> Iterator[schemas.Threshold]:
    return (_row("limits", "alerts", found) for found in core.thresholds(Limits.of(settings)))


def _row(where: str, group: str, found: core.Threshold) -> schemas.Threshold:
    is_angle = found.unit.startswith("rad")
    value = round(math.degrees(found.value), 6) if is_angle else found.value
    return schemas.Threshold.model_validate(
        {
            "name": f"{where}.{found.name}",
            "group": group,
            "value": value if math.isfinite(value) else "infinite",
            "unit": found.unit.replace("rad", "deg"),
            "meaning": found.meaning,
        }
    )


def _of_settings(settings: Settings) -> Iterator[schemas.Threshold]:
    for name, group in SETTINGS.items():
        yield schemas.Threshold.model_validate(
            {
                "name": name,
                "group": group,
                "value": getattr(settings, name),
                "unit": UNITS.get(name.rsplit("_", 1)[-1], ""),
                "meaning": Settings.model_fields[name].description,
            }
        )
