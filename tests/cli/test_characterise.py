import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from api.cli import app
from api.formats.writer import write_native_csv
from core.simulation_marg import MargScenario, simulate

SCENARIO = MargScenario("rest", seconds=150.0, seed=3)


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """150 s at rest at 100 Hz, as in 003 chapter 5."""
    path = tmp_path_factory.mktemp("rest") / "rest.csv"
    path.write_bytes(write_native_csv(simulate(SCENARIO).samples))
    return path


def characterise(*arguments: object) -> Result:
    return CliRunner().invoke(app, ["characterise", *map(str, arguments)])


def test_json(log: Path) -> None:
    done = characterise(log, "--json")
    assert (done.exit_code, done.stderr) == (0, "")
    found = json.loads(done.stdout)
    assert set(found) == {"file", "gyroscope", "accelerometer", "magnetometer"}
    gyroscope = found["gyroscope"]
    np.testing.assert_allclose(np.abs(gyroscope["mean"]), 0.5, atol=0.005)
    np.testing.assert_allclose(gyroscope["noise_density"], np.degrees(SCENARIO.gyro_noise) / np.sqrt(2), rtol=0.1)
    np.testing.assert_allclose(np.sqrt(found["accelerometer"]["variance"]), SCENARIO.force_noise, rtol=0.05)
    np.testing.assert_allclose(found["accelerometer"]["mean"], [0, 0, 9.80665], atol=0.01)
    assert found["magnetometer"]["rate"] == pytest.approx(100.0)
    assert len(gyroscope["allan"]["deviation"]) == 3
    assert len(gyroscope["allan"]["deviation"][0]) == len(gyroscope["allan"]["tau"])


def test_the_table(log: Path) -> None:
    done = characterise(log)
    assert done.exit_code == 0
    assert all(word in done.stdout for word in ("gyroscope, deg/s", "accelerometer, m/s²", "magnetometer, µT", "-"))


def test_a_picture(log: Path, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    picture = tmp_path / "allan.png"
    assert characterise(log, "--plot", picture).exit_code == 0
    assert picture.stat().st_size > 5000


def test_a_log_that_is_too_short_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "short.csv"
    path.write_bytes(write_native_csv(simulate(MargScenario("rest", seconds=0.5)).samples))
    done = characterise(path)
    assert (done.exit_code, done.stdout) == (2, "")
    assert "at least 100" in done.stderr


def test_a_log_that_cannot_be_read_is_named(tmp_path: Path) -> None:
    path = tmp_path / "odd.csv"
    path.write_text("t,ax,ay,az,fix,speed,course\n0,0,0,x,,,\n")
    done = characterise(path)
    assert done.exit_code == 2
    assert f"{path}: line 2, column az" in done.stderr
