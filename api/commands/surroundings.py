"""Settings and database of the commands that work on the service's own machine."""

import os
import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from pydantic import ValidationError
from sqlalchemy.exc import SQLAlchemyError

from api.commands import output
from api.services.context import Context
from api.settings import PREFIX, Settings


def configure(flags: dict[str, Any]) -> Settings:
    """Put the flags that were given into the environment, where worker processes find them, and read all settings."""
    for name, value in flags.items():
        if value is not None:
            os.environ[f"{PREFIX}{name.upper()}"] = str(value)
    try:
        return Settings()
    except ValidationError as error:
        problems = error.errors(include_input=False)
        lines = [f"{PREFIX}{'.'.join(map(str, problem['loc'])).upper()}: {problem['msg']}" for problem in problems]
        output.fail("\n".join(lines), output.UNREADABLE)


@contextmanager
def opened(settings: Settings) -> Iterator[Context]:
    """Connect to the database; what goes wrong with it ends the command with a sentence, without its secrets."""
    try:
        context = Context.make(settings)
        try:
            yield context
        finally:
            context.database.close()
    except (SQLAlchemyError, sqlite3.Error, OSError) as error:
        words = str(getattr(error, "orig", None) or error).strip()
        output.fail(f"The database cannot be used: {words}")
