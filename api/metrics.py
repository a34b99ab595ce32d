"""What Prometheus is told of this process. Labels have few values: never a device, a key or a path.

Where several processes serve one port, `PROMETHEUS_MULTIPROC_DIR` names the directory through which each of them can
answer for all; it has to be set before this file is imported.
"""

import os
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from prometheus_client import CollectorRegistry, Counter, Gauge, Histogram, generate_latest
from prometheus_client.multiprocess import MultiProcessCollector, mark_process_dead
from prometheus_client.platform_collector import PlatformCollector
from prometheus_client.process_collector import ProcessCollector
from sqlalchemy import event
from sqlalchemy.engine import Engine, ExceptionContext

from storage import prepared

DIRECTORY = "PROMETHEUS_MULTIPROC_DIR"
FORMATS = {
    "text/csv": "csv",
    "text/vnd.livella.tmd2": "thesis",
    "application/vnd.apache.arrow.stream": "arrow",
}
FAST = (0.0005, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0)
"""s, bounds for what takes milliseconds"""
SLOW = (0.1, 0.5, 1.0, 2.0, 5.0, 10.0, 30.0, 60.0, 120.0, 300.0, 900.0, 3600.0)
"""s, bounds for how far behind an estimate is"""

_own = CollectorRegistry()
ProcessCollector(registry=_own)
PlatformCollector(registry=_own)

UPLOADS = Counter("livella_uploads", "Chunks answered.", ["state", "format"], registry=_own)
REFUSED = Counter("livella_uploads_refused", "Chunks refused.", ["reason"], registry=_own)
REJECTED = Counter("livella_samples_rejected", "Samples and fixes left out.", ["reason"], registry=_own)
STAGES = Histogram(
    "livella_upload_stage_seconds", "Time of an upload, without filter.", ["stage"], buckets=FAST, registry=_own
)
FILTER = Histogram("livella_filter_seconds", "Time of one call of the estimator.", buckets=FAST, registry=_own)
LAG = Histogram("livella_estimate_lag_seconds", "From the last sample to its estimate.", buckets=SLOW, registry=_own)
QUEUE = Gauge("livella_uploads_in_work", "Chunks read, waiting or in work.", multiprocess_mode="livesum", registry=_own)
BODIES = Gauge("livella_body_bytes", "Bytes of request bodies in memory.", multiprocess_mode="livesum", registry=_own)
OVERLOADED = Counter("livella_overloaded", "Requests refused because of overload.", ["limit"], registry=_own)
REQUESTS = Counter("livella_http_requests", "Requests answered.", ["method", "route", "status"], registry=_own)
DURATION = Histogram("livella_http_request_seconds", "Time of a request.", ["route"], buckets=FAST, registry=_own)
DATABASE_ERRORS = Counter("livella_database_errors", "Errors of the database.", ["kind"], registry=_own)


LAPS = {stage: STAGES.labels(stage) for stage in ("parse", "foresee", "wait", "store", "commit")}


class _OfThread(threading.local):
    upload: "Upload | None" = None


_of_thread = _OfThread()


class Upload:
    """Measures one upload, lap by lap; the estimator's time is in none of them.

    Entered while a thread works on the upload: what the estimator needs meanwhile is this one's.
    """

    def __init__(self, content_type: str) -> None:
        self.format = FORMATS.get(content_type.partition(";")[0].strip().lower(), "other")
        self.filter_seconds = 0.0
        self._since = time.perf_counter()

    def __enter__(self) -> None:
        _of_thread.upload = self

    def __exit__(self, *_: object) -> None:
        _of_thread.upload = None

    def start(self) -> None:
        """A stage begins; what passed since the last lap is in none."""
        self._since = time.perf_counter()

    def lap(self, stage: str) -> None:
        """A stage has ended, and the next begins."""
        now = time.perf_counter()
        LAPS[stage].observe(max(now - self._since - self.filter_seconds, 0.0))
        self._since, self.filter_seconds = now, 0.0

    def answered(self, state: str, rejected: dict[str, int]) -> None:
        """It was answered with success."""
        UPLOADS.labels(state, self.format).inc()
        if state == "duplicate":
            return
        for reason, number in rejected.items():
            REJECTED.labels(reason).inc(number)


def refused(error: Exception) -> None:
    """Count an upload that was refused, or failed."""
    status = getattr(error, "status", None)
    REFUSED.labels(getattr(error, "kind", None) or (f"log-{status}" if status else "fault")).inc()


@contextmanager
def estimator() -> Iterator[None]:
    """Measure a call of the estimator; inside an upload that counts here and not in the lap."""
    begun = time.perf_counter()
    yield
    taken = time.perf_counter() - begun
    FILTER.observe(taken)
    if _of_thread.upload is not None:
        _of_thread.upload.filter_seconds += taken


@event.listens_for(Engine, "handle_error")
def _count_error(context: ExceptionContext) -> None:
    _count(context.sqlalchemy_exception or context.original_exception)


def _count(error: BaseException) -> None:
    DATABASE_ERRORS.labels(type(error).__name__).inc()


prepared.on_error.append(_count)


def several_processes() -> bool:
    """Tell whether this process answers for others too."""
    return DIRECTORY in os.environ


def render() -> bytes:
    """Give the figures of all processes in Prometheus' text format."""
    if not several_processes():
        return generate_latest(_own)
    shared = CollectorRegistry()
    MultiProcessCollector(shared)  # type: ignore[no-untyped-call]
    return generate_latest(shared)


def forget_dead_processes() -> None:
    """Take what processes that ended had in work out of the sums."""
    if not several_processes():
        return
    for file in Path(os.environ[DIRECTORY]).glob("gauge_live*_*.db"):
        pid = int(file.stem.rpartition("_")[2])
        if not _lives(pid):
            mark_process_dead(pid)  # type: ignore[no-untyped-call]


def _lives(pid: int) -> bool:
    with suppress(PermissionError):
        try:
            os.kill(pid, 0)
        except ProcessLookupError:
            return False
    return True
