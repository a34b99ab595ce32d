"""Lists, alerts and charts, through what the routes call, up to the text that is sent."""

from collections.abc import Callable, Iterator
from datetime import timedelta
from functools import partial
from typing import Any

from pydantic import BaseModel

from api.routes.alerts import list_alerts
from api.routes.devices import list_devices
from api.routes.installations import read_estimates
from api.services import paging
from api.services.context import Context
from benchmarks.age_study.pair import CHARTED, SENDS
from benchmarks.age_study.past import NOW, periods

LISTS: tuple[dict[str, Any], ...] = (
    {},
    {"stage": "confirmed"},
    {"stage": "waiting"},
    {"has_open_alert": True},
    {"has_open_alert": False},
    {"has_open_alert": True, "stage": "aligning"},
    {"has_open_alert": False, "stage": "settling"},
    {"q": "box"},
    {"q": "box 99"},
    {"q": "nowhere"},
    {"q": "box", "stage": "confirmed"},
    {"q": "box", "stage": "waiting"},
    {"q": "box", "has_open_alert": True},
    {"q": "hh-lv 1", "has_open_alert": True},
    {"q": "hh-lv 1", "has_open_alert": False, "stage": "settling"},
)
ALERTS: tuple[dict[str, Any], ...] = (
    {},
    {"state": "open"},
    {"kind": "gps_lost", "state": "resolved"},
    {"severity": "critical"},
    {"device_id": SENDS.format(0)},
    {"since": NOW - timedelta(hours=1)},
    {"until": NOW - timedelta(days=180)},
    {"kind": "sensor_fault", "severity": "critical", "state": "open"},
)
DEEP = {"a page in the middle": "dev-8", "a page near the end": "dev-fe"}
"""ids after which pages begin"""
LIMIT = 100
"""items on a page, as by default"""
Look = Callable[[], str]


def lists(context: Context) -> Iterator[tuple[str, Look]]:
    """Give the first page of every list of devices, and deep ones."""
    for filters in LISTS:
        yield _named("devices", filters), partial(_devices, context, filters, None)
        for name, after in DEEP.items():
            yield f"{_named('devices', filters)}, {name}", partial(_devices, context, filters, paging.encode(after))


def alerts(context: Context) -> Iterator[tuple[str, Look]]:
    """Give the first page of every list of alerts, and one half a year deep."""
    deep = paging.encode(paging.place(NOW - timedelta(days=180), 1))
    for filters in ALERTS:
        yield _named("alerts", filters), partial(_alerts, context, filters, None)
    yield "alerts, half a year deep", partial(_alerts, context, {}, deep)


def charts(context: Context) -> Iterator[tuple[str, Look]]:
    """Give charts of the device that has driven every day."""
    for name, span in periods():
        yield f"chart of {name}", partial(_chart, context, span)


def _named(what: str, filters: dict[str, Any]) -> str:
    return ", ".join([what, *(f"{name} {str(value).lower()}" for name, value in filters.items())])


def _devices(context: Context, filters: dict[str, Any], cursor: str | None) -> str:
    after = None if cursor is None else paging.decode(cursor)
    return _text(list_devices(context, after, **filters, limit=LIMIT))


def _alerts(context: Context, filters: dict[str, Any], cursor: str | None) -> str:
    before = None if cursor is None else paging.decode_place(cursor)
    return _text(list_alerts(context, before, **filters, limit=LIMIT))


def _chart(context: Context, span: timedelta) -> str:
    return _text(read_estimates(CHARTED, context, NOW - span, NOW, 1000))


def _text(answer: BaseModel) -> str:
    return answer.model_dump_json()
