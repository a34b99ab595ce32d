"""Logs on this machine's disk: found out, opened, and cut into chunks as a device would send them."""

from collections.abc import Iterator
from enum import StrEnum
from io import BytesIO
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pyarrow as pa

from api.formats import arrow_stream, native_csv, parse, thesis_log
from api.formats.compression import FILE_LIMITS, decode, sniff_encoding
from api.formats.delimited import BYTE_ORDER_MARK, Floats, is_numbers, lines
from api.formats.log import ParsedLog


class Format(StrEnum):
    """Short names of the formats, for people."""

    CSV = "csv"
    THESIS = "thesis"
    ARROW = "arrow"


MEDIA_TYPES = {
    Format.CSV: native_csv.MEDIA_TYPE,
    Format.THESIS: thesis_log.MEDIA_TYPE,
    Format.ARROW: arrow_stream.MEDIA_TYPE,
}

_ARROW_CONTINUATION = b"\xff\xff\xff\xff"


class LogFile(NamedTuple):
    """A log without its compression."""

    content: bytes
    media_type: str

    def parse(self, course: str = "auto") -> ParsedLog:
        """Read the whole log, with no other limit than the memory. Raises `FormatError`."""
        return parse(self.content, self.media_type, None, FILE_LIMITS, course)


class Chunk(NamedTuple):
    """A part of a log that is a log itself."""

    t: float
    """s, session clock, of its first sample"""
    until: float
    """s, session clock, of its last sample"""
    content: bytes


def open_log(path: Path, log_format: Format | None = None) -> LogFile:
    """Read and decompress a file; the format is found out unless given.

    Raises
    ------
    OSError
        the file cannot be read
    FormatError
        the compression is damaged
    """
    body = path.read_bytes()
    content = decode(body, sniff_encoding(body), FILE_LIMITS)
    return LogFile(content, MEDIA_TYPES[log_format] if log_format else sniff_media_type(content))


def sniff_media_type(content: bytes) -> str:
    """Tell the format: Arrow by its mark, a thesis log by a first line of nothing but numbers, else native CSV."""
    if content.startswith(_ARROW_CONTINUATION):
        return arrow_stream.MEDIA_TYPE
    text = content.removeprefix(BYTE_ORDER_MARK)
    first = next((line.strip() for line in lines(text[:65536]) if line.strip()), b"")
    return thesis_log.MEDIA_TYPE if is_numbers(first) else native_csv.MEDIA_TYPE


def chunks(log: LogFile, t: Floats, seconds: float) -> Iterator[Chunk]:
    """Cut a log whose samples' times are `t` (N,) into chunks of so many seconds; none is without samples."""
    starts = np.flatnonzero(np.diff(np.floor((t - t[0]) / seconds), prepend=-1.0))
    bounds = np.append(starts, t.size)
    rows = _arrow_rows(log, bounds) if log.media_type == arrow_stream.MEDIA_TYPE else _text_rows(log, bounds)
    for (start, stop), content in zip(pairwise(bounds.tolist()), rows, strict=True):
        yield Chunk(float(t[start]), float(t[stop - 1]), content)


def _text_rows(log: LogFile, bounds: np.ndarray) -> Iterator[bytes]:
    filled = [line for line in lines(log.content.removeprefix(BYTE_ORDER_MARK)) if line.strip(b" ")]
    header = [filled.pop(0)] if log.media_type == native_csv.MEDIA_TYPE else []
    for start, stop in pairwise(bounds.tolist()):
        yield b"\n".join([*header, *filled[start:stop], b""])


def _arrow_rows(log: LogFile, bounds: np.ndarray) -> Iterator[bytes]:
    table = pa.ipc.open_stream(log.content).read_all()
    for start, stop in pairwise(bounds.tolist()):
        out = BytesIO()
        with pa.ipc.new_stream(out, table.schema) as writer:
            writer.write_table(table.slice(start, stop - start))
        yield out.getvalue()
