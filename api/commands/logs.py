"""Logs that commands read whole, and what is said when one cannot be read: file, line, column, what was expected."""

from pathlib import Path
from typing import NoReturn

from api.commands import output
from api.formats import FormatError, Reading, Sense
from api.formats.files import Format, open_log
from core import Samples


def read(path: Path, log_format: Format | None, course: Sense = Sense.AUTO) -> Samples:
    """Read a log; when it cannot be read, say why and end with status 2."""
    try:
        return read_with_counts(path, log_format, course).samples
    except (OSError, FormatError) as error:
        refuse(path, error)


def read_with_counts(path: Path, log_format: Format | None, course: Sense) -> Reading:
    """Read a log with what was rejected in it; what was noticed goes to stderr.

    Raises
    ------
    OSError, FormatError
        it cannot be read; `sentences` says why.
    """
    log = open_log(path, log_format).parse(course)
    for notice in log.notices:
        output.complain(f"{path}: {notice}")
    return log.samples()


def refuse(path: Path, error: OSError | FormatError) -> NoReturn:
    """Say why a file cannot be read, and end with status 2."""
    output.fail("\n".join(sentences(path, error)), output.UNREADABLE)


def sentences(path: Path, error: OSError | FormatError) -> list[str]:
    """Say why a file cannot be read, a sentence for each fault."""
    if isinstance(error, OSError):
        return [f"{path}: {error.strerror or error}"]
    return [f"{path}: {sentence}" for sentence in map(str, error.problems)] or [f"{path}: {error.detail}"]
