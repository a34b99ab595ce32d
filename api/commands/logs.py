"""Logs that commands read whole: what is wrong with a file ends the command."""

from pathlib import Path

from api.commands import output
from api.formats import FormatError
from api.formats.files import Format, open_log
from core import Samples


def read(path: Path, log_format: Format | None) -> Samples:
    """Read a log; when it cannot be read, say file, line, column and what was expected, and end with status 2."""
    try:
        log = open_log(path, log_format).parse()
    except OSError as error:
        output.fail(f"{path}: {error.strerror or error}", output.UNREADABLE)
    except FormatError as error:
        sentences = [str(problem) for problem in error.problems] or [error.detail]
        output.fail("\n".join(f"{path}: {sentence}" for sentence in sentences), output.UNREADABLE)
    return log.samples().samples
