"""What is wrong with a log, in words that say where and what was expected."""

from collections.abc import Iterable
from http import HTTPStatus
from typing import NamedTuple, Self


def printable(name: str) -> str:
    """Give a name that a stranger chose without what would end a line or steer a terminal."""
    return name if name.isprintable() else name.encode("unicode_escape").decode()


class Problem(NamedTuple):
    """One thing wrong with a log."""

    line: int | None
    """line of the decoded text, from 1 (of an Arrow stream: the row, from 1); None when it is about the whole"""
    column: str | None
    """name of the column"""
    expected: str
    """what should have been there"""
    message: str
    """the whole sentence without the place, such as "expected a finite number, found 'abc'" """

    def __str__(self) -> str:
        """Give the sentence with its place."""
        places = [f"line {self.line}" if self.line else "", f"column {self.column}" if self.column else ""]
        return ": ".join(filter(None, [", ".join(filter(None, places)), self.message]))


class FormatError(ValueError):
    """A log that cannot be read. `status` is the HTTP status that tells the sender so: 400, 413, 415 or 422."""

    def __init__(self, status: int, title: str, detail: str, problems: Iterable[Problem] = ()) -> None:
        super().__init__(detail)
        self.status = int(status)
        self.title = title
        self.detail = detail
        self.problems = list(problems)

    @classmethod
    def unreadable(cls, *problems: Problem) -> Self:
        """Make the 422 of a log with these problems; the first one is the detail."""
        return cls(HTTPStatus.UNPROCESSABLE_ENTITY, "The log cannot be read", str(problems[0]), problems)

    @classmethod
    def too_large(cls, detail: str) -> Self:
        """Make the 413 of a log over a limit."""
        return cls(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, "The log is too large", detail)

    @classmethod
    def undecodable(cls, detail: str) -> Self:
        """Make the 400 of a body that is not what its content encoding says."""
        return cls(HTTPStatus.BAD_REQUEST, "The content encoding is wrong", detail)

    @classmethod
    def unsupported(cls, detail: str) -> Self:
        """Make the 415 of a media type or content encoding that is not read."""
        return cls(HTTPStatus.UNSUPPORTED_MEDIA_TYPE, "The format is not supported", detail)
