"""`livella serve`: the service and the page."""

import copy
import os
import sqlite3
from typing import Any

import typer
import uvicorn
from pydantic import ValidationError
from sqlalchemy.exc import SQLAlchemyError
from uvicorn.config import LOGGING_CONFIG

from api.commands import output
from api.services import startup
from api.services.context import Context
from api.settings import PREFIX, Settings

KEEP_ALIVE = 120
"""s an idle connection is kept: longer than the interval at which devices post"""
GRACE = 20
"""s a request may still take after the service was told to end"""


def run(flags: dict[str, Any]) -> None:
    """Bring the database up to date, then serve until told to end; `flags` go before the environment."""
    settings = configure(flags)
    first_key = _prepare(settings)
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
        log_config=_logging(),
    )


def configure(flags: dict[str, Any]) -> Settings:
    """Put the flags that were given into the environment, where worker processes find them, and read all settings."""
    for name, value in flags.items():
        if value is not None:
            os.environ[f"{PREFIX}{name.upper()}"] = str(value)
    try:
        return Settings()
    except ValidationError as error:
        lines = [
            f"{PREFIX}{'.'.join(map(str, e['loc'])).upper()}: {e['msg']}" for e in error.errors(include_input=False)
        ]
        output.fail("\n".join(lines), output.UNREADABLE)


def _prepare(settings: Settings) -> str | None:
    """Migrate; give the first admin key if it was made now."""
    try:
        context = Context.make(settings)
        try:
            return startup.prepare(context)
        finally:
            context.database.close()
    except (SQLAlchemyError, sqlite3.Error, OSError) as error:
        output.fail(f"The database cannot be used: {_without_secrets(error)}")


def _without_secrets(error: Exception) -> str:
    """Give an error's words without statement, parameters and address of the database."""
    return str(getattr(error, "orig", None) or error).strip()


def _logging() -> dict[str, Any]:
    """Give uvicorn's logging, with the service's own messages written the same way."""
    config = copy.deepcopy(LOGGING_CONFIG)
    config["loggers"] |= {
        name: {"handlers": ["default"], "level": "INFO", "propagate": False} for name in ("api", "storage")
    }
    return config
