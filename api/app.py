"""The application: what it is made of, and what runs beside the requests."""

import logging
import os
import signal
import sys
import threading
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import asynccontextmanager, contextmanager
from dataclasses import replace
from datetime import datetime
from importlib.metadata import version
from typing import Any, TypedDict

import anyio
from anyio import to_thread
from fastapi import FastAPI

from api import errors, headers, metrics, page, rates, tracing
from api.live import Hub
from api.observing import Observing
from api.overload import Gate, Limits
from api.routes import api, service
from api.routes.chunks import Uploads, open_uploads
from api.routes.plain_uploads import PlainUploads
from api.services import housekeeping, startup
from api.services.context import Context, utc_now
from api.services.limiting import Rates
from api.settings import Settings

log = logging.getLogger(__name__)

READY = "the estimator is compiled"
"""said once by every server process: `/readyz` speaks for the one that answers only"""


class State(TypedDict):
    """What a request finds in `request.state`."""

    context: Context
    hub: Hub
    ready: threading.Event
    gate: Gate
    uploads: Uploads
    watch: service.Watch
    rates: Rates


def create_app(
    settings: Settings | None = None,
    clock: Callable[[], datetime] = utc_now,
    when_ready: Callable[[], None] = lambda: None,
) -> FastAPI:
    """Make the application; settings come from the environment unless given; `when_ready` is called once."""
    chosen = settings or Settings()
    gate = Gate(chosen)
    allowed = Rates(chosen)
    app = FastAPI(
        title="Livella",
        version=version("livella"),
        description="Automatic mounting-angle calibration for vehicle black boxes.",
        lifespan=lambda _: _lifespan(chosen, clock, gate, allowed, when_ready),
        docs_url=None,
        redoc_url=None,
        responses=errors.RESPONSES,
        generate_unique_id_function=lambda route: route.name,
        telemetry={"tracing": False, "metrics": False, "logs": False},  # see `tracing` and `metrics`
    )
    errors.install(app)
    app.router.routes.append(PlainUploads())
    app.include_router(service.router)
    app.include_router(api)
    app.router.default = page.Page(app.router.default, page.STATIC)
    app.add_middleware(Limits, gate=gate)
    app.add_middleware(rates.RateHeaders, rates=allowed)
    app.add_middleware(headers.SecurityHeaders)
    app.add_middleware(Observing)
    _describe(app)
    tracing.install(app)
    return app


def _describe(app: FastAPI) -> None:
    generate = app.openapi

    def openapi() -> dict[str, Any]:
        return errors.describe(generate())

    app.openapi = openapi  # type: ignore[method-assign]


@asynccontextmanager
async def _lifespan(
    settings: Settings, clock: Callable[[], datetime], gate: Gate, rates: Rates, when_ready: Callable[[], None]
) -> AsyncIterator[State]:
    metrics.forget_dead_processes()
    context = Context.make(settings, clock)
    hub = Hub(context.database)
    context = replace(context, wake=hub.wake)
    first_key = await to_thread.run_sync(startup.prepare, context)
    if first_key is not None:
        print(f"First admin key, shown only once: {first_key}", file=sys.stderr, flush=True)
    ready = threading.Event()
    uploads = open_uploads(context)
    async with anyio.create_task_group() as tasks:
        tasks.start_soon(_warm_up, context, ready, when_ready)
        tasks.start_soon(hub.run)
        tasks.start_soon(housekeeping.run, context)
        with _ending_with(hub.close):
            yield State(
                context=context,
                hub=hub,
                ready=ready,
                gate=gate,
                uploads=uploads,
                watch=service.Watch(context),
                rates=rates,
            )
        hub.close()
        tasks.cancel_scope.cancel()  # threads at work are waited for
    await to_thread.run_sync(uploads.close)
    await to_thread.run_sync(housekeeping.finish, context)
    context.database.close()


async def _warm_up(context: Context, ready: threading.Event, when_ready: Callable[[], None]) -> None:
    try:
        await to_thread.run_sync(startup.warm_up, context.params)
    except Exception:
        log.exception("the estimator cannot be compiled; the service stays unready")
        return
    when_ready()
    ready.set()
    log.info("%s (process %d)", READY, os.getpid())


@contextmanager
def _ending_with(action: Callable[[], None]) -> Iterator[None]:
    """Call `action` when the process is told to stop: the server then waits for open streams, which have to end."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    former = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}

    def stop(number: int, frame: Any) -> None:
        action()
        handler = former[signal.Signals(number)]
        if callable(handler):
            handler(number, frame)

    for number in former:
        signal.signal(number, stop)
    try:
        yield
    finally:
        for number, handler in former.items():
            signal.signal(number, handler)
