"""Logs: one line per message, as text or JSON, each with the id of the request it belongs to."""

import copy
import logging
import re
from contextvars import ContextVar
from typing import Any

from pythonjsonlogger.json import JsonFormatter
from uvicorn.config import LOGGING_CONFIG

from api.settings import Settings

REQUEST_ID: ContextVar[str | None] = ContextVar("request_id", default=None)
"""of the request in work, also in the threads that work on it"""

ACCESS = "api.access"
FIELDS = ("request_id", "method", "route", "status", "duration_ms", "device_id")
"""what a line for people shows beside its message; JSON has everything"""

logging.logThreads = logging.logProcesses = logging.logMultiprocessing = False
"""None of them is in a line of ours, and looking them up for every record takes time on the way of every upload."""

_UNSAFE = re.compile(r"[\x00-\x1f\x7f-\x9f\u2028\u2029]")


class WithRequest(logging.Filter):
    """Puts the id of the request on every message."""

    def filter(self, record: logging.LogRecord) -> bool:
        """Let every message pass."""
        request_id = REQUEST_ID.get()
        if request_id is not None:
            record.request_id = request_id
        return True


def _escape(found: re.Match[str]) -> str:
    return found.group().encode("unicode_escape").decode()


class TextFormatter(logging.Formatter):
    """Lines for people. What came from outside cannot begin a line of its own: tracebacks are indented."""

    def __init__(self) -> None:
        super().__init__("%(asctime)s %(levelname)-7s %(name)s: %(message)s")

    def formatMessage(self, record: logging.LogRecord) -> str:  # noqa: N802 - the name is logging's
        """Give the line without its traceback."""
        given = ((name, getattr(record, name, None)) for name in FIELDS)
        fields = "".join(f" {name}={value}" for name, value in given if value is not None)
        return _UNSAFE.sub(_escape, super().formatMessage(record) + fields)

    def formatException(self, ei: Any) -> str:  # noqa: N802 - the name is logging's
        """Give a traceback."""
        lines = super().formatException(ei).splitlines()
        return "\n".join("    " + _UNSAFE.sub(_escape, line) for line in lines)


def json_formatter() -> logging.Formatter:
    """Make JSON objects for machines."""
    return JsonFormatter(
        ["levelname", "name", "message"],
        rename_fields={"levelname": "level", "name": "logger"},
        timestamp="time",
    )


def config(settings: Settings) -> dict[str, Any]:
    """Give the logging of the service and of uvicorn, written the same way."""
    made = copy.deepcopy(LOGGING_CONFIG)
    formatter = json_formatter if settings.log_format == "json" else TextFormatter
    handler = {"class": "logging.StreamHandler", "formatter": "line", "filters": ["request"]}
    level = settings.log_level.upper()
    made["formatters"] = {"line": {"()": formatter}}
    made["filters"] = {"request": {"()": WithRequest}}
    made["handlers"] = {"stderr": {**handler, "stream": "ext://sys.stderr"}}
    made["loggers"] = {
        name: {"handlers": ["stderr"], "level": level, "propagate": False}
        for name in ("uvicorn", "api", "storage", "py.warnings")
    }
    return made
