"""`livella serve`: the service and the page."""

import ctypes
import gc
import os
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import typer
import uvicorn
from fastapi import FastAPI

from api import logs
from api.app import create_app
from api.commands.surroundings import configure, opened
from api.services import startup
from api.settings import Settings

KEEP_ALIVE = 120
"""s an idle connection is kept: longer than the interval at which devices post"""
GRACE = 20
"""s a request may still take after the service was told to end"""
HANGS = 30
"""s of silence after which one of several processes is replaced: starting on a busy machine may need more than 5 s"""
LOOKED_AFTER = 20_000
"""objects that came and have not gone after which the garbage collector looks for cycles among them; Python's: 700"""
KEPT = {-3: 32 * 1024 * 1024, -1: 256 * 1024 * 1024}
"""options of mallopt(3), in bytes: M_MMAP_THRESHOLD, above which memory comes straight from the system, at its largest;
M_TRIM_THRESHOLD, free at the end of an arena after which it goes back"""

FIGURES = "PROMETHEUS_MULTIPROC_DIR"
"""environment variable, read when `api.metrics` is imported"""
HTTP: Any = "auto" if sys.platform == "win32" else "api.protocol:BoundedProtocol"


def run(flags: dict[str, Any]) -> None:
    """Bring the database up to date, then serve until told to end; `flags` go before the environment."""
    settings = configure(flags)
    with opened(settings) as context:
        first_key = startup.prepare(context)
    host = f"[{settings.host}]" if ":" in settings.host else settings.host
    if first_key:
        typer.echo(f"First admin key, shown only once: {first_key}")
    typer.echo(f"Livella is at http://{host}:{settings.port}")
    with _shared_figures(settings.workers):
        _serve(settings)


def app() -> FastAPI:
    """Make the application of a process that serves nothing else."""
    keep_memory()
    return create_app(when_ready=spare_the_lasting)


def keep_memory() -> None:
    """Let the C library, where it is glibc, keep what was given back for what is needed next.

    A chunk takes arrays of a megabyte and gives them back; fetched from the system each time, page by page, they are a
    twelfth of an upload's processor time.
    """
    if sys.platform == "linux" and (mallopt := getattr(ctypes.CDLL(None), "mallopt", None)) is not None:
        for option, size in KEPT.items():
            mallopt(option, size)


def spare_the_lasting() -> None:
    """Let the garbage collector pass over what is there now and stays, and look less often at the rest.

    A look through everything stops uploads for 0.1 s; and a tenth of the processor's time went into looks through
    connections and requests in work, which are no garbage.
    """
    gc.collect()
    gc.freeze()
    gc.set_threshold(LOOKED_AFTER, *gc.get_threshold()[1:])


def _serve(settings: Settings) -> None:
    uvicorn.run(
        "api.commands.serve:app",
        factory=True,
        host=settings.host,
        port=settings.port,
        workers=settings.workers,
        timeout_keep_alive=KEEP_ALIVE,
        timeout_graceful_shutdown=GRACE,
        timeout_worker_healthcheck=HANGS,
        server_header=False,
        access_log=False,
        ws="none",
        http=HTTP,
        forwarded_allow_ips=settings.forwarded_allow_ips,
        log_config=logs.config(settings),
    )


@contextmanager
def _shared_figures(workers: int) -> Iterator[None]:
    """Give several processes a directory through which each of them tells the figures of all."""
    if workers == 1:
        yield
        return
    with tempfile.TemporaryDirectory(prefix="livella-metrics-") as directory:
        os.environ[FIGURES] = directory
        yield
