"""The fleet in figures for Prometheus, counted in the database now and then rather than at every look."""

import logging
import platform
import threading
import time
from collections.abc import Callable, Iterator
from importlib.metadata import version

from prometheus_client import CollectorRegistry, generate_latest
from prometheus_client.core import GaugeMetricFamily
from prometheus_client.metrics_core import Metric
from sqlalchemy.exc import SQLAlchemyError

from api.services import webhooks
from api.services.context import Context
from core import Stage
from storage import alerts, devices

log = logging.getLogger(__name__)

KEPT = 15.0
"""s a count is good for"""


class Fleet:
    """Counts of the whole fleet, the same from every process."""

    def __init__(self, context: Context, now: Callable[[], float] = time.monotonic) -> None:
        self.context = context
        self._now = now
        self._lock = threading.Lock()
        self._known: bytes | None = None
        self._until = 0.0

    def render(self) -> bytes:
        """Give the counts in Prometheus' text format, no older than `KEPT`."""
        with self._lock:
            if self._known is None or self._now() >= self._until:
                self._known = self._render()
                self._until = self._now() + KEPT
            return self._known

    def _render(self) -> bytes:
        registry = CollectorRegistry()
        registry.register(_Given([_build(), *self._count()]))
        return generate_latest(registry)

    def _count(self) -> list[Metric]:
        up = GaugeMetricFamily("livella_database_up", "1 when the database answers.")
        try:
            counted = _counted(self.context)
        except SQLAlchemyError as error:
            log.warning("the fleet cannot be counted: %s", type(error).__name__)
            counted = []
        up.add_metric([], 1.0 if counted else 0.0)
        return [up, *counted]


class _Given:
    """A collector of metrics that are there already."""

    def __init__(self, metrics: list[Metric]) -> None:
        self.metrics = metrics

    def collect(self) -> Iterator[Metric]:
        """Give them."""
        yield from self.metrics


def _build() -> Metric:
    family = GaugeMetricFamily("livella_build_info", "Version of the service.", labels=["version", "python"])
    family.add_metric([version("livella"), platform.python_version()], 1.0)
    return family


def _counted(context: Context) -> list[Metric]:
    with context.database.read() as tx:
        by_stage, open_alerts, backlog = devices.stages(tx), alerts.counts(tx), webhooks.backlog(tx)
    staged = GaugeMetricFamily("livella_devices", "Devices by stage.", labels=["stage"])
    for stage in Stage:
        staged.add_metric([stage.word], by_stage.get(stage.word, 0))
    alerting = GaugeMetricFamily("livella_open_alerts", "Alerts not resolved.", labels=["kind", "severity"])
    for kind, severity, number in open_alerts:
        alerting.add_metric([kind, severity], number)
    waiting = GaugeMetricFamily("livella_webhook_backlog", "Messages to webhooks not yet delivered.", value=backlog)
    return [staged, alerting, waiting]
