import gzip
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from api.cli import app
from api.formats.files import open_log
from core import quaternion
from core.simulation_routes import ROUTES
from tests.cli.conftest import Log

SHORT = ["--seconds", "5", "--seed", "7"]


def simulate(*arguments: object) -> int:
    return CliRunner().invoke(app, ["simulate", *map(str, arguments)]).exit_code


def test_the_truth_is_the_mounting_asked_for(drive: Log) -> None:
    assert drive.truth["mount"]["angles_deg"] == pytest.approx({"roll": 15, "pitch": -20, "yaw": 100})
    assert drive.truth["remount"] is None
    samples = open_log(drive.path).parse().samples().samples
    assert samples.t[-1] == pytest.approx(330, abs=0.1)
    upwards = quaternion.rotate(drive.truth["mount"]["quaternion"], samples.f_s.mean(axis=0))
    assert np.degrees(np.arctan2(np.hypot(*upwards[:2]), upwards[2])) < 4


def test_the_same_seed_gives_the_same_bytes(tmp_path: Path) -> None:
    names = [tmp_path / name for name in ("a.csv", "b.csv.gz", "c.csv.gz", "other.csv")]
    for path in names[:3]:
        assert simulate(path, *SHORT) == 0
    assert simulate(names[3], "--seconds", 5, "--seed", 8) == 0
    plain, zipped, again, other = (path.read_bytes() for path in names)
    assert zipped == again
    assert gzip.decompress(zipped) == plain
    assert other != plain


def test_the_device_is_turned_when_asked(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    arguments = ["--route", "parked", "--sensor", "calibrated", "--mount", "0,0,0", "--remount-at", "10,0,0,90"]
    assert simulate(path, "--seconds", 20, *arguments) == 0
    samples = open_log(path).parse().samples().samples
    before, after = samples.f_s[samples.t < 9].mean(axis=0), samples.f_s[samples.t > 12].mean(axis=0)
    np.testing.assert_allclose(before, [0, 0, 9.8], atol=0.6)
    np.testing.assert_allclose(after, [0, 9.8, 0], atol=0.6)


@pytest.mark.parametrize("route", ["city", "hills", "straight", "motorway", "parked", "roundabout"])
def test_routes(tmp_path: Path, route: str) -> None:
    assert simulate(tmp_path / "log.csv", *SHORT, "--route", route) == 0


@pytest.mark.parametrize(
    "arguments",
    [
        ["--route", "nowhere"],
        ["--sensor", "none"],
        ["--mount", "1,2"],
        ["--mount", "a,b,c"],
        ["--mount", "1,2,nan"],
        ["--remount-at", "1,2,3"],
        ["--seconds", "0"],
        ["--seed", "-1"],
    ],
)
def test_arguments_that_cannot_be_used(tmp_path: Path, arguments: list[str]) -> None:
    assert simulate(tmp_path / "log.csv", *arguments) == 2
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["log.txt", "log", "nowhere/log.csv"])
def test_files_that_cannot_be_written(tmp_path: Path, name: str) -> None:
    assert simulate(tmp_path / name, *SHORT) == 2


def test_help_names_every_route() -> None:
    text = CliRunner().invoke(app, ["simulate", "--help"], env={"COLUMNS": "200"}).stdout
    assert all(route in text for route in ROUTES)
