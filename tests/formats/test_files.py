import gzip
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
import zstandard

from api.formats import FormatError, parse
from api.formats.files import MEDIA_TYPES, Format, LogFile, chunks, open_log, sniff_media_type
from api.formats.writer import write_native_csv
from core import Samples
from core.simulation import Scenario, simulate

THESIS = b"1 0 12.25 45.5 10 36 90 1 1 2 100\n2 5 12.25 45.5 10 36 90 1 1 2 100\n3 2005 12.25 45.5 10 36 91 1 1 2 100\n"


@pytest.fixture(scope="module")
def drive() -> Samples:
    scenario = Scenario(
        route="city", seconds=20, seed=4, gyro=True, vertical_speed=True, accuracy=True, outages=((8, 16),)
    )
    return simulate(scenario).samples


def arrow(csv: bytes) -> bytes:
    table = pa.csv.read_csv(BytesIO(csv))
    out = BytesIO()
    with pa.ipc.new_stream(out, table.schema) as writer:
        writer.write_table(table)
    return out.getvalue()


def test_what_is_written_reads_the_same(drive: Samples) -> None:
    samples = parse(write_native_csv(drive), "text/csv", None).samples().samples
    np.testing.assert_allclose(samples.t, drive.t, rtol=0, atol=0.5001e-4)
    np.testing.assert_allclose(samples.f_s, drive.f_s, rtol=0, atol=0.5001e-5)
    np.testing.assert_allclose(samples.w_s, drive.w_s, rtol=0, atol=0.5001e-6)
    np.testing.assert_array_equal(samples.fix_row[samples.fix_valid], drive.fix_row[drive.fix_valid])
    tolerance = np.array([2e-10, 2e-10, 1e-4, 1e-4, 1e-6, 1e-4, 1e-4, 1e-6])
    difference = samples.fix[samples.fix_valid] - drive.fix[drive.fix_valid]
    difference[:, 4] = np.angle(np.exp(1j * difference[:, 4]))
    assert np.nanmax(np.abs(difference) - tolerance) < 0
    np.testing.assert_array_equal(np.isnan(samples.fix[samples.fix_valid]), np.isnan(drive.fix[drive.fix_valid]))
    assert (~samples.fix_valid).any()


def test_columns_nobody_filled_are_left_out(drive: Samples) -> None:
    fix = np.where(np.arange(8) < 5, drive.fix, np.nan)
    bare = Samples.make(drive.t, drive.f_s, None, drive.fix_row, drive.fix_valid, fix)
    header = write_native_csv(bare).split(b"\n", 1)[0]
    assert header == b"t,ax,ay,az,fix,lat,lon,alt,speed,course"


@pytest.mark.parametrize("compress", [bytes, gzip.compress, zstandard.compress])
@pytest.mark.parametrize("name", list(Format))
def test_a_file_is_found_out(tmp_path: Path, drive: Samples, name: Format, compress: type[bytes]) -> None:
    csv = write_native_csv(drive)
    content = {"csv": csv, "thesis": THESIS, "arrow": arrow(csv)}[name]
    path = tmp_path / "log"
    path.write_bytes(compress(content))
    log = open_log(path)
    assert log == (content, MEDIA_TYPES[name])
    assert log == open_log(path, name)
    assert log.parse().rows == (3 if name == "thesis" else len(drive))


def test_a_format_can_be_forced(tmp_path: Path) -> None:
    path = tmp_path / "log"
    path.write_bytes(THESIS)
    with pytest.raises(FormatError, match="found numbers"):
        open_log(path, Format.CSV).parse()


def test_rubbish_is_taken_for_csv_and_refused_as_such(tmp_path: Path) -> None:
    path = tmp_path / "photo.csv"
    path.write_bytes(b"\xff\xd8\xff\xe0\0\x10JFIF")
    with pytest.raises(FormatError, match="not text"):
        open_log(path).parse()


@pytest.mark.parametrize("name", [Format.CSV, Format.ARROW])
def test_chunks_put_together_are_the_log(drive: Samples, name: Format) -> None:
    csv = b"\xef\xbb\xbf" + write_native_csv(drive).replace(b"\n", b"\r\n\r\n")
    log = LogFile(arrow(write_native_csv(drive)) if name == "arrow" else csv, MEDIA_TYPES[name])
    whole = log.parse().samples().samples
    pieces = list(chunks(log, whole.t, 6.0))
    assert [piece.t for piece in pieces] == [0.0, 6.0, 12.0, 18.0]
    context: dict[str, Any] = {}
    t, f_s, fixes = [], [], 0
    for piece in pieces:
        samples, _, context = parse(piece.content, log.media_type, None).samples(context)
        assert (samples.t[0], samples.t[-1]) == (piece.t, piece.until)
        t.append(samples.t)
        f_s.append(samples.f_s)
        fixes += samples.fix_row.size
    np.testing.assert_array_equal(np.concatenate(t), whole.t)
    np.testing.assert_array_equal(np.concatenate(f_s), whole.f_s)
    assert fixes == whole.fix_row.size


def test_a_gap_makes_no_empty_chunk() -> None:
    log = LogFile(THESIS, MEDIA_TYPES[Format.THESIS])
    pieces = list(chunks(log, log.parse().samples().samples.t, 0.5))
    assert [(piece.t, piece.until) for piece in pieces] == [(0.0, 0.005), (2.005, 2.005)]
    assert b"".join(piece.content for piece in pieces) == THESIS


def test_a_clock_that_jumps_years_ahead_is_no_trouble() -> None:
    log = LogFile(THESIS.replace(b"2005", b"1900000000000"), MEDIA_TYPES[Format.THESIS])
    assert len(list(chunks(log, log.parse().samples().samples.t, 0.001))) == 3


@pytest.mark.parametrize(
    ("content", "name"),
    [
        (b"", Format.CSV),
        (b"t,ax\n", Format.CSV),
        (b"\n\n 1;2;3\n", Format.THESIS),
        (b"\xef\xbb\xbf1\t2", Format.THESIS),
        (b"-1e5,2\n", Format.THESIS),
        (b"e\n", Format.CSV),
    ],
)
def test_sniffing(content: bytes, name: Format) -> None:
    assert sniff_media_type(content) == MEDIA_TYPES[name]
