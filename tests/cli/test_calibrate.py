import gzip
import json
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from api.cli import app
from api.formats.writer import write_native_csv
from core import AccelerometerCalibration
from core._kernel import GRAVITY
from tests.core.poses import NINE, random_calibration, readings, recording

TRUTH = random_calibration(np.random.default_rng(1))


class Logs(NamedTuple):
    first: Path
    second: Path
    few: Path


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> Logs:
    """One accelerometer in nine poses, five in one log and five in the other."""
    made = Logs(*(tmp_path_factory.mktemp("poses") / name for name in ("first.csv", "second.csv.gz", "few.csv")))
    held = readings(TRUTH, NINE)
    made.first.write_bytes(write_native_csv(recording(held[:5])))
    made.second.write_bytes(gzip.compress(write_native_csv(recording(held[4:], seed=1))))
    made.few.write_bytes(write_native_csv(recording(held[:8])))
    return made


def calibrate(*arguments: object) -> Result:
    return CliRunner().invoke(app, ["calibrate", *map(str, arguments)])


def taken(document: dict[str, Any]) -> AccelerometerCalibration:
    given = document["accelerometer_calibration"]
    return AccelerometerCalibration(np.array(given["gain"]), np.array(given["offset"]))


def numbers(done: Result) -> list[str]:
    """Numbers of the poses in the table."""
    cells = [line.split() for line in done.stdout.splitlines()]
    return [row[0] for row in cells if row and row[0].isdigit()]


def test_the_errors_of_the_accelerometer_are_found(logs: Logs) -> None:
    done = calibrate(logs.first, logs.second, "--json")
    assert (done.exit_code, done.stderr) == (0, "")
    found = json.loads(done.stdout)
    gain, offset = taken(found)
    assert (np.abs(gain - TRUTH.gain) < 4 * np.array(found["gain_sigma"])).all()
    assert (np.abs(offset - TRUTH.offset) < 4 * np.array(found["offset_sigma"])).all()
    assert found["rms_after_mps2"] < 0.01
    assert found["rms_before_mps2"] > 0.1
    assert len(found["poses"]) == 9
    np.testing.assert_allclose([pose["seconds"] for pose in found["poses"][:4]], 3, atol=0.5)


def test_the_table_shows_poses_parameters_and_what_it_brings(logs: Logs) -> None:
    done = calibrate(logs.first, logs.second)
    assert done.exit_code == 0
    assert numbers(done) == [str(number) for number in range(1, 10)]
    lines = done.stdout.splitlines()
    poses = [line.split() for line in lines if line.split()[:1] in [[number] for number in numbers(done)]]
    np.testing.assert_allclose([float(row[6]) for row in poses], GRAVITY, atol=0.01)
    assert max(abs(float(row[5]) - GRAVITY) for row in poses) > 0.1
    assert sum("±" in line for line in lines) == 3
    assert lines[-2].startswith("|f| - g over the poses: ")
    assert lines[-2].endswith(" after")
    assert "would also test them" in lines[-1]


def test_the_file_is_what_the_service_takes(logs: Logs, tmp_path: Path) -> None:
    out = tmp_path / "calibration.json"
    assert calibrate(logs.first, logs.second, "--output", out).exit_code == 0
    document = json.loads(out.read_text())
    assert set(document) == {"accelerometer_calibration"}
    np.testing.assert_allclose(taken(document).offset, TRUTH.offset, atol=0.05)


def test_too_few_poses_are_shown_and_those_that_are_missing_named(logs: Logs, tmp_path: Path) -> None:
    out = tmp_path / "calibration.json"
    done = calibrate(logs.few, "--output", out)
    assert done.exit_code == 2
    assert "8 poses were found, 9 are needed" in done.stderr
    assert "tilted half-way between its y and z axes" in done.stderr
    assert "x axis" not in done.stderr
    assert numbers(done) == [str(number) for number in range(1, 9)]
    assert not out.exists()
    assert calibrate(logs.few, "--json").stdout == ""


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("missing.csv", None, "No such file"),
        ("broken.csv", b"t,ax,ay,az,fix,speed,course\n0,1,2,abc,,,\n", "line 2, column az"),
    ],
)
def test_files_that_cannot_be_read(logs: Logs, tmp_path: Path, name: str, content: bytes | None, words: str) -> None:
    path = tmp_path / name
    if content is not None:
        path.write_bytes(content)
    done = calibrate(logs.first, logs.second, path)
    assert (done.exit_code, done.stdout) == (2, "")
    assert str(path) in done.stderr
    assert words in done.stderr


def test_a_file_that_cannot_be_written(logs: Logs, tmp_path: Path) -> None:
    done = calibrate(logs.first, logs.second, "--output", tmp_path / "nowhere" / "calibration.json")
    assert done.exit_code == 2
    assert "nowhere" in done.stderr
