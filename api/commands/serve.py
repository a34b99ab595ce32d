"""`livella serve`: the service and the page."""

import copy
from typing import Any

import typer
import uvicorn
from uvicorn.config import LOGGING_CONFIG

from api.commands.surroundings import configure, opened
from api.services import startup

KEEP_ALIVE = 120
"""s an idle connection is kept: longer than the interval at which devices post"""
GRACE = 20
"""s a request may still take after the service was told to end"""


def run(flags: dict[str, Any]) -> None:
    """Bring the database up to date, then serve until told to end; `flags` go before the environment."""
    settings = configure(flags)
    with opened(settings) as context:
        first_key = startup.prepare(context)
    host = f"[{settings.host}]" if ":" in settings.host else settings.host
    if first_key:
        typer.echo(f"First admin key, shown only once: {first_key}")
    typer.echo(f"Livella is at http://{host}:{settings.port}")
    uvicorn.run(
        "api.app:create_app",
        factory=True,
        host=settings.host,
        port=settings.port,
        workers=settings.workers,
        timeout_keep_alive=KEEP_ALIVE,
        timeout_graceful_shutdown=GRACE,
        server_header=False,
        access_log=False,
        ws="none",
        forwarded_allow_ips=settings.forwarded_allow_ips,
        log_config=_logging(),
    )


def _logging() -> dict[str, Any]:
    """Give uvicorn's logging, with the service's own messages written the same way."""
    config = copy.deepcopy(LOGGING_CONFIG)
    config["loggers"] |= {
        name: {"handlers": ["default"], "level": "INFO", "propagate": False} for name in ("api", "storage")
    }
    return config
