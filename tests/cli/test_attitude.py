import json
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from api.cli import app
from api.formats.writer import write_native_csv
from core import quaternion
from core.simulation_marg import MargLog, MargScenario, simulate
from tests.cli import livella

FILTERS = ["linear", "ekf", "madgwick", "quest-ekf", "gyro"]


class Logs(NamedTuple):
    full: Path
    bare: Path
    truth: MargLog


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> Logs:
    """A log with magnetometer and barometer, and one of an accelerometer alone."""
    directory = tmp_path_factory.mktemp("attitude")
    truth = simulate(MargScenario("walk", seconds=30.0, seed=9))
    made = Logs(directory / "full.csv", directory / "bare.csv", truth)
    made.full.write_bytes(write_native_csv(truth.samples))
    lines = ["t,ax,ay,az,fix,speed,course", *(f"{k / 100},0,0,9.81,,," for k in range(300))]
    made.bare.write_text("\n".join(lines) + "\n")
    return made


def attitude(*arguments: object) -> Result:
    return CliRunner().invoke(app, ["attitude", *map(str, arguments)])


@pytest.mark.parametrize("name", FILTERS)
def test_json_lines(logs: Logs, name: str) -> None:
    done = attitude(logs.full, "--filter", name, "--json", "--every", "2")
    assert (done.exit_code, done.stderr) == (0, "")
    *lines, summary = map(json.loads, done.stdout.splitlines())
    assert [round(line["t"], 2) for line in lines] == [2.0 * k for k in range(15)]
    assert {line["type"] for line in lines} == {"attitude"}
    assert summary["type"] == "summary"
    assert (summary["filter"], summary["samples"], summary["file"]) == (name, 3000, str(logs.full))
    assert summary["duration_s"] == pytest.approx(29.99)
    assert summary["altitude_range"][0] == pytest.approx(100.0, abs=1.0)


def test_the_attitude_told_is_the_true_one(logs: Logs) -> None:
    *lines, summary = map(json.loads, attitude(logs.full, "--json").stdout.splitlines())
    for line in lines[5:]:
        q_ns = logs.truth.q_ns[round(line["t"] * 100)]
        assert np.degrees(quaternion.angle_between(line["quaternion"], q_ns)) < 3.0
        told = np.radians([line["angles_deg"][axis] for axis in ("roll", "pitch", "yaw")])
        assert quaternion.angle_between(quaternion.from_angles(*told), line["quaternion"]) < 1e-9
        assert len(line["sigma_deg"]) == 3
    assert summary["heading"] == "magnetic"
    assert np.linalg.norm(np.array(summary["gyro_bias_dps"]) - np.degrees(logs.truth.gyro_bias)) < 0.3


@pytest.mark.parametrize(("name", "heading"), [("linear", "magnetic at the start"), ("ekf", "magnetic")])
def test_the_table(logs: Logs, name: str, heading: str) -> None:
    done = attitude(logs.full, "--filter", name)
    assert done.exit_code == 0
    assert f"Heading: {heading}" in done.stdout
    assert all(word in done.stdout for word in ("roll, deg", "pitch, deg", "yaw, deg", "altitude, m", "30.0 s"))


def test_without_a_magnetometer_the_heading_is_relative(logs: Logs, tmp_path: Path) -> None:
    samples = simulate(MargScenario("walk", seconds=5.0, magnetometer=False)).samples
    path = tmp_path / "plain.csv"
    path.write_bytes(write_native_csv(samples))
    summary = json.loads(attitude(path, "--json").stdout.splitlines()[-1])
    assert summary["heading"] == "relative to the start"


@pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
def test_a_picture(logs: Logs, tmp_path: Path, ending: str) -> None:
    pytest.importorskip("matplotlib")
    picture = tmp_path / f"attitude.{ending}"
    assert attitude(logs.full, "--plot", picture).exit_code == 0
    assert picture.stat().st_size > 5000


def test_a_picture_of_no_known_kind_is_refused(logs: Logs, tmp_path: Path) -> None:
    done = attitude(logs.full, "--plot", tmp_path / "attitude.txt")
    assert done.exit_code == 2
    assert ".png" in done.stderr


def test_without_matplotlib_a_picture_is_refused(logs: Logs, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "matplotlib.figure", None)
    done = attitude(logs.full, "--plot", tmp_path / "attitude.png")
    assert (done.exit_code, done.stdout) == (2, "")
    assert "livella[plot]" in done.stderr


def test_a_log_without_gyroscope_is_refused(logs: Logs) -> None:
    done = attitude(logs.bare, "--json")
    assert (done.exit_code, done.stdout) == (2, "")
    assert "no gyroscope" in done.stderr
    assert "gx, gy, gz" in done.stderr


def test_a_log_that_cannot_be_read_is_named_with_line_and_column(tmp_path: Path) -> None:
    path = tmp_path / "odd.csv"
    path.write_text("t,ax,ay,az,gx,gy,gz,fix,speed,course\n0,0,0,9.81,0,0,0,,,\n0.01,0,abc,9.81,0,0,0,,,\n")
    done = livella.run("attitude", path)
    assert (done.status, done.out) == (2, "")
    assert f"{path}: line 3, column ay: expected a number" in done.err
    assert livella.run("attitude", tmp_path / "none.csv").status == 2
