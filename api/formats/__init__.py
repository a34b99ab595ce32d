"""Log formats: bytes -> samples in SI units and radians, a file for each format. Pure: no clock, no files."""

from collections.abc import Callable
from email.message import Message
from functools import lru_cache

from api.formats import arrow_stream, native_csv, thesis_log
from api.formats.compression import FILE_LIMITS, UPLOAD_LIMITS, Limits, decode, sniff_encoding
from api.formats.course_sense import Sense
from api.formats.errors import FormatError, Problem
from api.formats.fingerprint import Fingerprint
from api.formats.log import Context, ParsedLog, Reading

__all__ = [
    "FILE_LIMITS",
    "MEDIA_TYPES",
    "UPLOAD_LIMITS",
    "Context",
    "FormatError",
    "Limits",
    "ParsedLog",
    "Problem",
    "Reading",
    "Sense",
    "decode",
    "parse",
    "sniff_encoding",
]

_Reader = Callable[[bytes, Limits, Fingerprint, Sense], ParsedLog]
_READERS: dict[str, _Reader] = {
    native_csv.MEDIA_TYPE: lambda content, limits, fingerprint, _: native_csv.parse(content, limits, fingerprint),
    thesis_log.MEDIA_TYPE: thesis_log.parse,
    arrow_stream.MEDIA_TYPE: lambda content, limits, fingerprint, _: arrow_stream.parse(content, limits, fingerprint),
}
MEDIA_TYPES = tuple(_READERS)
_CHARSETS = ("utf-8", "utf8", "us-ascii")


def parse(
    body: bytes, content_type: str, content_encoding: str | None, limits: Limits = UPLOAD_LIMITS, course: str = "auto"
) -> ParsedLog:
    """Read one chunk or one whole log.

    Parameters
    ----------
    body
        as sent
    content_type
        one of `MEDIA_TYPES`, with or without parameters
    content_encoding
        gzip, zstd, identity or None
    limits
        what the log may take
    course
        sense of the course of a thesis log: clockwise, anticlockwise, or auto, decided from the positions

    Raises
    ------
    FormatError
        with the HTTP status: 400 not encoded as stated, 413 over a limit, 415 unknown format, 422 wrong content.
    """
    media_type = _media_type(content_type)
    sense = _sense(course)
    content = decode(body, content_encoding, limits)
    return _READERS[media_type](content, limits, Fingerprint(media_type, content), sense)


@lru_cache(maxsize=64)
def _media_type(content_type: str) -> str:
    header = Message()
    header["Content-Type"] = content_type
    media_type = header.get_content_type()
    charset = str(header.get_param("charset", "utf-8")).lower()
    if media_type not in _READERS or "/" not in content_type:
        raise FormatError.unsupported(f"media type {content_type[:80]!r} is not read; send {', '.join(MEDIA_TYPES)}")
    if charset not in _CHARSETS:
        raise FormatError.unsupported(f"character set {charset[:40]!r} is not read; send UTF-8")
    return media_type


def _sense(course: str) -> Sense:
    try:
        return Sense(course)
    except ValueError:
        expected = ", ".join(Sense)
        raise FormatError.unreadable(
            Problem(None, None, expected, f"course={course[:40]!r} is not known; expected one of {expected}")
        ) from None
