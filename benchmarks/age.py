"""Lists of a large fleet and charts of a long past: the time of each query, ms, the best of several."""

import argparse
import sys
import tempfile
import time
from collections.abc import Callable, Sized
from datetime import timedelta
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from pydantic import SecretStr

from api.services import history, startup
from api.services.context import Context
from api.settings import Settings
from benchmarks.age_study.past import NOW, add_fleet, add_year, periods
from storage import alerts, devices
from storage.alerts import Filter
from storage.database import ReadSession

LISTS: tuple[dict[str, Any], ...] = (
    {},
    {"stage": "confirmed"},
    {"stage": "waiting"},
    {"has_open_alert": True},
    {"has_open_alert": False},
    {"has_open_alert": True, "stage": "aligning"},
    {"has_open_alert": False, "stage": "settling"},
    {"q": "box 99"},
    {"q": "nowhere"},
    {"q": "box", "stage": "waiting"},
    {"q": "hh-lv 1", "has_open_alert": True},
)
ALERTS = (
    Filter(),
    Filter(state="open"),
    Filter(kind="gps_lost", state="resolved"),
    Filter(severity="critical"),
    Filter(device_id="old"),
    Filter(since=NOW),
    Filter(until=NOW.replace(year=NOW.year - 1)),
    Filter(kind="sensor_fault", severity="critical", state="open"),
)
NAMES = ("q", "stage", "has_open_alert")
REPEATS = 5


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--database-url", help="an empty database; one in a temporary file unless given")
    parser.add_argument("--devices", type=int, default=100_000)
    parser.add_argument("--alerts", type=int, default=10, help="of each device, over as many years")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as directory:
        url = arguments.database_url or f"sqlite:///{directory}/age.db"
        settings = Settings(database_url=SecretStr(url), data_dir=Path(directory))
        context = Context.make(settings, lambda: NOW)
        startup.prepare(context)
        pk = add_year(context, 5, 1.6)
        add_fleet(context.database, range(pk + 1, pk + 1 + arguments.devices), arguments.alerts)
        measure(context, pk)
        context.database.close()


def measure(context: Context, pk: int) -> None:
    """Print a line for each query."""
    for filters in LISTS:
        show(context, f"devices {filters}", devices.page, 101, None, *map(filters.get, NAMES))
        show(context, "  from the middle", devices.page, 101, "dev-8", *map(filters.get, NAMES))
    for wanted in ALERTS:
        named = {name: str(value) for name, value in wanted._asdict().items() if value is not None}
        show(context, f"alerts {named}", alerts.page, 101, None, wanted)
    for name, span in periods():
        show(context, f"chart of {name}", chart, pk, span)
    show(context, "counts of alerts", alerts.counts)
    show(context, "counts of stages", devices.stages)


def chart(tx: ReadSession, pk: int, span: timedelta) -> Sized:
    """Give the times of a chart's points."""
    return history.read(tx, pk, NOW - span, NOW, 1000).time


def show(context: Context, name: str, query: Callable[..., Sized], *arguments: object) -> None:
    """Print how long a query takes and how much it gives."""
    best = float("inf")
    for _ in range(REPEATS):
        begun = time.perf_counter()
        with context.database.read() as tx:
            found = query(tx, *arguments)
        best = min(best, time.perf_counter() - begun)
    print(f"{1e3 * best:8.1f} ms {len(found):6d} {name}", flush=True)


if __name__ == "__main__":
    main()
