import json
import sys
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from api.cli import app
from api.formats.files import open_log
from api.formats.writer import write_native_csv
from core.simulation_steering import SteeringDrive, SteeringScenario, simulate_steering


class Logs(NamedTuple):
    car: Path
    wheel: Path
    drive: SteeringDrive


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> Logs:
    drive = simulate_steering(SteeringScenario(seed=12, seconds=120.0, rate=50.0, wheel_rate=52.0))
    directory = tmp_path_factory.mktemp("steering")
    made = Logs(directory / "car.csv", directory / "wheel.csv", drive)
    made.car.write_bytes(write_native_csv(drive.car))
    made.wheel.write_bytes(write_native_csv(drive.wheel))
    return made


def steering(*arguments: object) -> Result:
    return CliRunner().invoke(app, ["steering", *map(str, arguments)])


def lines(done: Result) -> list[dict[str, Any]]:
    return [json.loads(line) for line in done.stdout.splitlines()]


def test_two_logs_give_the_angle_over_time(logs: Logs) -> None:
    done = steering(logs.car, "--wheel", logs.wheel, "--json", "--every", 0.5)
    assert (done.exit_code, done.stderr) == (0, "")
    *rows, summary = lines(done)
    assert {row["type"] for row in rows} == {"steering"}
    t, angle, sigma = (np.array([row[name] for row in rows]) for name in ("t", "angle_deg", "sigma_deg"))
    np.testing.assert_allclose(np.diff(t), 0.5, atol=0.02)
    error = angle - np.degrees(np.interp(t, logs.drive.t, logs.drive.angle))
    assert np.sqrt((error**2).mean()) < 3.0
    assert (np.abs(error) < 5 * sigma).all()
    assert summary["type"] == "summary"
    assert summary["clock_offset_s"] == pytest.approx(logs.drive.clock_offset, abs=0.03)


def test_second_is_another_word_and_the_table_says_the_same(logs: Logs) -> None:
    done = steering(logs.car, "--second", logs.wheel, "--every", 10)
    assert done.exit_code == 0
    rows = [cells for line in done.stdout.splitlines() if (cells := line.split()) and cells[0][:1].isdigit()]
    told = lines(steering(logs.car, "--wheel", logs.wheel, "--json", "--every", 10))[:-1]
    assert [row[1] for row in rows] == [f"{line['angle_deg']:.1f}" for line in told]


def test_the_log_is_written_with_the_steering_angle(logs: Logs, tmp_path: Path) -> None:
    out = tmp_path / "with.csv"
    assert steering(logs.car, "--wheel", logs.wheel, "--output", out).exit_code == 0
    read = open_log(out).parse().samples().samples
    given = logs.drive.car
    np.testing.assert_allclose(read.t, given.t, atol=1e-4)
    np.testing.assert_allclose(read.f_s, given.f_s, atol=1e-5)
    assert read.fix_row.tolist() == given.fix_row.tolist()
    assert read.steer is not None
    error = np.degrees(read.steer - np.interp(read.t, logs.drive.t, logs.drive.angle))
    assert np.sqrt(np.nanmean(error**2)) < 3.0
    assert np.isnan(read.steer[0])  # the wheel's device came later


def test_a_plot(logs: Logs, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    out = tmp_path / "angle.png"
    assert steering(logs.car, "--wheel", logs.wheel, "--plot", out).exit_code == 0
    assert out.read_bytes().startswith(b"\x89PNG")
    assert steering(logs.car, "--wheel", logs.wheel, "--plot", tmp_path / "nowhere" / "angle.png").exit_code == 2


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("missing.csv", None, "No such file"),
        ("broken.csv", b"t,ax,ay,az,fix,speed,course\n0,1,2,abc,,,\n", "line 2, column az"),
        ("parked.csv", b"t,ax,ay,az,fix,speed,course\n0,1,2,9,,,\n", "no gyroscope"),
    ],
)
def test_logs_that_cannot_be_used(logs: Logs, tmp_path: Path, name: str, content: bytes | None, words: str) -> None:
    path = tmp_path / name
    if content is not None:
        path.write_bytes(content)
    for arguments in ((path, "--wheel", logs.wheel), (logs.car, "--wheel", path)):
        done = steering(*arguments, "--json")
        assert (done.exit_code, done.stdout) == (2, "")
        assert words in done.stderr


def test_what_does_not_go_together(logs: Logs, tmp_path: Path) -> None:
    assert "device on the wheel" in steering(logs.car).stderr
    film = tmp_path / "film.avi"
    assert "no second device" in steering(film, "--wheel", logs.wheel).stderr
    assert "--log" in steering(film, "--output", tmp_path / "out.csv").stderr
    missing = steering(film)
    assert missing.exit_code == 2
    assert "No such file" in missing.stderr


def test_a_film_beside_a_log(logs: Logs, tmp_path: Path) -> None:
    pytest.importorskip("cv2")
    from benchmarks.motion_study.wheel_video import Film, render

    path, out = tmp_path / "film.avi", tmp_path / "with.csv"
    truth = render(Film(seed=43, seconds=4.0, size=(320, 240), light=0.1, shake=2.0), path)
    done = steering(path, "--log", logs.car, "--video-start", 30, "--json", "--every", 0.1, "--output", out)
    assert (done.exit_code, done.stderr) == (0, "")
    *rows, summary = lines(done)
    assert (summary["method"], summary["colour"], summary["video_start_s"]) == ("markers", "red", 30.0)
    known = [row for row in rows if row["angle_deg"] is not None]
    assert len(known) > 0.9 * len(rows)
    error = [row["angle_deg"] - np.degrees(np.interp(row["t"] - 30, truth.t, truth.angle)) for row in known]
    assert np.sqrt(np.mean(np.square(error))) < 2.0
    steer = open_log(out).parse().samples().samples.steer
    assert steer is not None
    t = logs.drive.car.t
    assert np.isnan(steer[(t < 29.9) | (t > 34.1)]).all()
    assert np.isfinite(steer[(t > 30.1) & (t < 33.8)]).mean() > 0.8


def test_a_film_without_opencv(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "cv2", None)
    film = tmp_path / "film.avi"
    film.write_bytes(b"RIFF0000AVI ")
    done = steering(film)
    assert (done.exit_code, done.stdout) == (2, "")
    assert "livella[video]" in done.stderr
