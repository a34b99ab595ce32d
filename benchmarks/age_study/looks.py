"""Lists, alerts and charts, through what the routes call, up to the text that is sent."""

from collections.abc import Callable, Iterator
from datetime import timedelta
from functools import partial
from itertools import product
from typing import Any

from pydantic import BaseModel

from api.routes.alerts import list_alerts
from api.routes.devices import list_devices
from api.routes.installations import read_estimates
from api.services import paging
from api.services.context import Context
from benchmarks.age_study.pair import CHARTED, SENDS
from benchmarks.age_study.past import HALF_LIFE, NOW, periods
from storage.models import microseconds

LISTS: tuple[dict[str, Any], ...] = (
    {},
    {"stage": "confirmed"},
    {"stage": "waiting"},
    {"has_open_alert": True},
    {"has_open_alert": False},
    {"has_open_alert": True, "stage": "aligning"},
    {"has_open_alert": False, "stage": "settling"},
    {"alert_kind": "device_silent"},
    {"alert_severity": "critical"},
    {"alert_severity": "warning", "stage": "confirmed"},
    {"q": "box"},
    {"q": "box 99"},
    {"q": "nowhere"},
    {"q": "box", "stage": "confirmed"},
    {"q": "box", "stage": "waiting"},
    {"q": "box", "has_open_alert": True},
    {"q": "hh-lv 1", "has_open_alert": True},
    {"q": "hh-lv 1", "has_open_alert": False, "stage": "settling"},
)
"""each in every order"""
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
AGO = [microseconds(NOW - HALF_LIFE * half_lives) for half_lives in (1, 6)]
DEEP = {
    "id": ("id dev-8 ", "id dev-fe "),
    "name": ("name dev-8 box 5", "name dev-8 box 98"),
    "-last_data_at": (f"-last_data_at dev-8 {AGO[0]}", f"-last_data_at dev-8 {AGO[1]}"),
}
"""places in each order after which pages begin, in the middle and near the end"""
LIMIT = 100
"""items on a page, as by default"""
Look = Callable[[], str]


def lists(context: Context) -> Iterator[tuple[str, Look]]:
    """Give the first page of every list of devices, and deep ones."""
    for (order, deep), filters in product(DEEP.items(), LISTS):
        asked = filters if order == "id" else {"sort": order} | filters
        name = _named("devices", asked)
        yield name, partial(_devices, context, asked, None)
        for place, where in zip(deep, ("in the middle", "near the end"), strict=True):
            yield f"{name}, a page {where}", partial(_devices, context, asked, paging.encode(place))


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
    return _text(list_devices(context, **filters, cursor=cursor, limit=LIMIT))


def _alerts(context: Context, filters: dict[str, Any], cursor: str | None) -> str:
    before = None if cursor is None else paging.decode_place(cursor)
    return _text(list_alerts(context, before, **filters, limit=LIMIT))


def _chart(context: Context, span: timedelta) -> str:
    return _text(read_estimates(CHARTED, context, NOW - span, NOW, 1000))


def _text(answer: BaseModel) -> str:
    return answer.model_dump_json()
