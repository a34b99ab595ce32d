import gzip
import tracemalloc

import pytest
import zstandard
from hypothesis import given
from hypothesis import strategies as st

from api.formats import FormatError, Limits, decode, parse

CSV = b"t,ax,ay,az,fix,speed,course\n0,0,0,9.8,1,3,90\n"
MIB = 1024 * 1024


def compress(content: bytes, encoding: str) -> bytes:
    return gzip.compress(content) if encoding == "gzip" else zstandard.compress(content)


def status(body: bytes, encoding: str | None, limits: Limits = Limits()) -> int:  # noqa: B008 a tuple
    with pytest.raises(FormatError) as caught:
        decode(body, encoding, limits)
    return caught.value.status


@given(content=st.binary(max_size=5000), encoding=st.sampled_from(["gzip", "zstd"]))
def test_round_trip(content: bytes, encoding: str) -> None:
    assert decode(compress(content, encoding), encoding, Limits()) == content


@pytest.mark.parametrize("encoding", ["gzip", "zstd"])
def test_members_follow_each_other(encoding: str) -> None:
    parts = [bytes([i]) * 40_000 for i in range(50)]
    assert decode(b"".join(compress(part, encoding) for part in parts), encoding, Limits()) == b"".join(parts)


def test_zeros_after_the_end_are_padding() -> None:
    assert decode(gzip.compress(CSV) + bytes(512), "gzip", Limits()) == CSV


def test_the_same_content_is_the_same_chunk_however_it_is_compressed() -> None:
    plain = parse(CSV, "text/csv", None)
    assert {parse(compress(CSV, e), "text/csv", e).fingerprint.digest for e in ("gzip", "zstd")} == {
        plain.fingerprint.digest
    }
    assert parse(CSV + b"0.1,0,0,9.8,,,\n", "text/csv", None).fingerprint.digest != plain.fingerprint.digest


@pytest.mark.parametrize("encoding", ["gzip", "zstd"])
@pytest.mark.parametrize("body", [b"", CSV, b"\x1f\x8b", b"\x28\xb5\x2f\xfd"])
def test_not_so_encoded(body: bytes, encoding: str) -> None:
    assert status(body, encoding) == 400


@pytest.mark.parametrize("encoding", ["gzip", "zstd"])
def test_truncated_or_damaged(encoding: str) -> None:
    body = compress(CSV * 100, encoding)
    assert all(status(body[:length], encoding) == 400 for length in range(1, len(body)))
    assert status(body + b"rubbish", encoding) == 400


@pytest.mark.parametrize("encoding", ["br", "gzip, gzip", "deflate"])
def test_other_encodings(encoding: str) -> None:
    assert status(CSV, encoding) == 415


@pytest.mark.parametrize("encoding", [None, "", "identity", " Identity "])
def test_no_encoding(encoding: str | None) -> None:
    assert decode(CSV, encoding, Limits()) is CSV
    assert status(CSV, encoding, Limits(max_decoded_bytes=10)) == 413
    assert status(CSV, encoding, Limits(max_encoded_bytes=10)) == 413


@pytest.mark.parametrize("encoding", ["gzip", "zstd"])
def test_a_bomb_is_refused_without_filling_the_memory(encoding: str) -> None:
    bomb = compress(bytes(300 * MIB), encoding)
    tracemalloc.start()
    try:
        assert status(bomb, encoding, Limits(max_decoded_bytes=MIB)) == 413
        assert tracemalloc.get_traced_memory()[1] < 100 * MIB
    finally:
        tracemalloc.stop()


def test_a_heap_of_tiny_members_is_refused() -> None:
    assert status(gzip.compress(b"") * 20_000, "gzip") == 400


def test_a_frame_that_asks_for_a_huge_window_is_refused() -> None:
    parameters = zstandard.ZstdCompressionParameters(window_log=27, write_content_size=False)
    compressor = zstandard.ZstdCompressor(compression_params=parameters).compressobj()
    assert status(compressor.compress(CSV) + compressor.flush(), "zstd") == 400


@pytest.mark.parametrize(
    "content_type", ["", "csv", "text/plain", "application/json", "text/csv; charset=utf-16", "image/png"]
)
def test_media_types_that_are_not_read(content_type: str) -> None:
    with pytest.raises(FormatError) as caught:
        parse(CSV, content_type, None)
    assert caught.value.status == 415


def test_a_charset_may_be_stated() -> None:
    assert parse(CSV, 'TEXT/CSV; charset="UTF-8"; header=present', None).rows == 1
