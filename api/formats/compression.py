"""gzip and zstd, undone piece by piece so that a small body can never fill the memory."""

import zlib
from collections.abc import Callable
from typing import NamedTuple, Protocol

import zstandard

from api.formats.errors import FormatError

MEBIBYTE = 1024 * 1024
GZIP_MAGIC = b"\x1f\x8b"
ZSTD_MAGIC = b"\x28\xb5\x2f\xfd"


class Limits(NamedTuple):
    """What a log may take."""

    max_encoded_bytes: int = 16 * MEBIBYTE
    """bytes as sent"""
    max_decoded_bytes: int = 64 * MEBIBYTE
    """bytes after decompression"""
    max_rows: int = 1_000_000
    """samples"""
    max_window_bytes: int = 8 * MEBIBYTE
    """memory a zstd frame may ask for; 8 MiB is what RFC 9659 allows on the web"""


UPLOAD_LIMITS = Limits()
FILE_LIMITS = Limits(2**40, 2**40, 2**40, 2**27)
"""For files on this machine's own disk: no limit but the memory."""


class _Decompressor(Protocol):
    @property
    def eof(self) -> bool: ...
    @property
    def unused_data(self) -> bytes: ...
    def decompress(self, data: bytes, /) -> bytes: ...


class _Coding(NamedTuple):
    name: str
    magic: bytes
    new: Callable[[Limits], _Decompressor]
    piece: int
    """bytes fed at a time: small enough that what comes out of one piece does not matter beside the limit"""


def _gzip(_: Limits) -> _Decompressor:
    return zlib.decompressobj(wbits=31)


def _zstd(limits: Limits) -> _Decompressor:
    decompressor: _Decompressor = zstandard.ZstdDecompressor(max_window_size=limits.max_window_bytes).decompressobj()
    return decompressor


_GZIP = _Coding("gzip", GZIP_MAGIC, _gzip, 16 * 1024)
# a zstd block of 4 bytes may stand for 128 KiB, gzip expands 1030 times at most
_ZSTD = _Coding("zstd", ZSTD_MAGIC, _zstd, 1024)
_CODINGS = {"gzip": _GZIP, "x-gzip": _GZIP, "zstd": _ZSTD}
_MAX_MEMBERS = 10_000


def decode(body: bytes, encoding: str | None, limits: Limits) -> bytes:
    """Undo the content encoding.

    Raises
    ------
    FormatError
        413 over a limit, 415 for an encoding other than gzip and zstd, 400 for a body that is not so encoded.
    """
    if len(body) > limits.max_encoded_bytes:
        raise FormatError.too_large(f"the body is longer than {limits.max_encoded_bytes} bytes")
    name = (encoding or "identity").strip().lower()
    if name == "identity":
        return _checked(body, len(body), limits)
    if name not in _CODINGS:
        raise FormatError.unsupported(f"content encoding {name!r} is not read; send gzip, zstd or none")
    coding = _CODINGS[name]
    content = _zstd_at_once(body, limits) if coding is _ZSTD else None
    return _decompress(body, coding, limits) if content is None else content


def sniff_encoding(body: bytes) -> str | None:
    """Tell the compression of a file from its first bytes."""
    return next((coding.name for coding in (_GZIP, _ZSTD) if body.startswith(coding.magic)), None)


def _checked(content: bytes, size: int, limits: Limits) -> bytes:
    if size > limits.max_decoded_bytes:
        raise FormatError.too_large(f"the log is longer than {limits.max_decoded_bytes} bytes after decompression")
    return content


def _zstd_at_once(body: bytes, limits: Limits) -> bytes | None:
    """Decompress one frame that states a size within the limits; None for anything else, or damaged."""
    try:
        frame = zstandard.get_frame_parameters(body)
        stated = 0 < frame.content_size <= limits.max_decoded_bytes and frame.window_size <= limits.max_window_bytes
        return zstandard.ZstdDecompressor().decompress(body, allow_extra_data=False) if stated else None
    except zstandard.ZstdError:
        return None


def _decompress(body: bytes, coding: _Coding, limits: Limits) -> bytes:
    """Decompress every member (frame) of the body; zeros after the last are padding, as in gzip(1)."""
    out: list[bytes] = []
    size = 0
    member = coding.new(limits)
    members = 1
    for start in range(0, len(body), coding.piece):
        piece = body[start : start + coding.piece]
        while piece:
            if member.eof:
                piece = piece.lstrip(b"\0")
                if not piece:
                    break
                member, members = coding.new(limits), members + 1
            out.append(_step(member, piece, coding))
            size += len(out[-1])
            _checked(b"", size, limits)
            if members > _MAX_MEMBERS:
                raise FormatError.undecodable(f"the body has more than {_MAX_MEMBERS} {coding.name} members")
            piece = member.unused_data if member.eof else b""
    if not member.eof:
        raise FormatError.undecodable(f"the {coding.name} body is truncated: its end is missing")
    return b"".join(out)


def _step(member: _Decompressor, piece: bytes, coding: _Coding) -> bytes:
    try:
        return member.decompress(piece)
    except (zlib.error, zstandard.ZstdError) as error:
        raise FormatError.undecodable(f"the body is not {coding.name}, or it is damaged: {error}") from error
