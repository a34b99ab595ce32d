import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from api.cli import app
from api.commands.motion_summary import Summary
from api.formats.writer import write_native_csv
from core import quaternion
from core.motion import Motion
from core.simulation_handling import HandlingDrive, HandlingScenario, simulate_handling
from tests.cli import livella
from tests.cli.conftest import Log

ROW = {
    "type", "t", "speed", "velocity", "velocity_sigma", "acceleration", "yaw_rate_deg", "roll_deg", "pitch_deg",
    "heading_deg", "sideslip_deg", "sideslip_sigma_deg", "position", "position_sigma", "dead_reckoned",
}  # fmt: skip


class Handled:
    """A simulated drive as a file, its mounting as text."""

    def __init__(self, directory: Path) -> None:
        scenario = HandlingScenario("slalom", "nonlinear", 0.5, seconds=70.0, seed=4, outages=((50.0, 60.0),))
        self.drive: HandlingDrive = simulate_handling(scenario)
        self.path = directory / "handled.csv"
        self.path.write_bytes(write_native_csv(self.drive.samples))
        self.mount = ",".join(f"{a:.6f}" for a in np.degrees(quaternion.angles(self.drive.truth.q_vs))[::-1])


@pytest.fixture(scope="module")
def handled(tmp_path_factory: pytest.TempPathFactory) -> Handled:
    return Handled(tmp_path_factory.mktemp("handled"))


def motion(*arguments: object) -> Result:
    return CliRunner().invoke(app, ["motion", *map(str, arguments)])


def rows_of(done: Result) -> list[dict[str, Any]]:
    return [json.loads(line) for line in done.stdout.splitlines()]


def test_json_has_rows_and_one_summary(handled: Handled) -> None:
    done = livella.run("motion", handled.path, "--vehicle", "sedan", "--mount", handled.mount, "--json")
    assert (done.status, done.err) == (0, "")
    *rows, summary = done.lines
    assert {row["type"] for row in rows} == {"motion"}
    assert all(set(row) == ROW for row in rows)
    np.testing.assert_allclose(np.diff([row["t"] for row in rows]), 1.0, atol=0.05)
    assert rows[0]["speed"] is None
    known = [row for row in rows if row["sideslip_deg"] is not None and row["t"] > 40]
    truth = handled.drive.truth.at(np.array([row["t"] for row in known]))
    np.testing.assert_allclose([row["sideslip_deg"] for row in known], np.degrees(truth.sideslip), atol=1.5)
    np.testing.assert_allclose([row["speed"] for row in known], np.linalg.norm(truth.velocity_v, axis=1), atol=0.8)
    yaw = np.degrees(quaternion.all_angles(truth.q_nv)[:, 2])
    off = (np.array([row["heading_deg"] for row in known]) - (90 - yaw) + 180) % 360 - 180
    np.testing.assert_allclose(off, 0.0, atol=3.0)
    assert summary["type"] == "summary"
    assert summary["mount"]["source"] == "given"
    assert summary["outages"]["count"] == 1
    assert summary["outages"]["total_s"] == pytest.approx(10.0, abs=1.0)
    path = np.linalg.norm(np.diff(handled.drive.truth.at(np.arange(0.0, 70.0, 0.1)).position_n, axis=0), axis=1).sum()
    assert summary["distance_m"] == pytest.approx(path, rel=0.02)
    assert 3.5 < summary["acceleration_mps2"]["lateral"][1] < 6.0


def test_fewer_rows(handled: Handled) -> None:
    rows = rows_of(motion(handled.path, "--vehicle", "sedan", "--mount", handled.mount, "--json", "--every", 20))
    assert [round(row["t"]) for row in rows[:-1]] == [0, 20, 40, 60]


def test_the_table(handled: Handled) -> None:
    done = motion(handled.path, "--vehicle", "sedan", "--mount", handled.mount)
    assert done.exit_code == 0
    for words in ("distance", "top speed", "lateral acceleration", "sideslip", "outages bridged", "longest outage"):
        assert words in done.stdout


def test_a_mounting_nobody_gave_is_found_first(drive: Log) -> None:
    done = motion(drive.path, "--vehicle", "van", "--json", "--every", 60)
    summary = rows_of(done)[-1]
    assert (done.exit_code, done.stderr) == (0, "")
    assert summary["mount"]["source"] == "confirmed"
    truth = drive.truth["mount"]["quaternion"]
    assert np.degrees(quaternion.angle_between(summary["mount"]["quaternion"], truth)) < 4
    assert summary["latency_s"] == pytest.approx(drive.truth["simulation"]["latency"], abs=0.15)


def test_an_estimate_has_to_do(handled: Handled) -> None:
    done = motion(handled.path, "--vehicle", "sedan", "--json", "--every", 60)
    assert done.exit_code == 0
    assert "no mounting was confirmed; the best estimate is used" in done.stderr
    assert rows_of(done)[-1]["mount"]["source"] == "estimate"


def test_without_any_estimate_it_ends(tmp_path: Path) -> None:
    path = tmp_path / "one.csv"
    path.write_text("t,ax,ay,az,fix,speed,course\n5,0,0,9.8,1,3,90\n")
    done = motion(path, "--vehicle", "sedan", "--json")
    assert (done.exit_code, done.stdout) == (2, "")
    assert "give --mount" in done.stderr


def test_a_log_of_one_sample(tmp_path: Path) -> None:
    path = tmp_path / "one.csv"
    path.write_text("t,ax,ay,az,fix,speed,course\n5,0,0,9.8,1,3,90\n")
    done = motion(path, "--vehicle", "sedan", "--mount", "0,0,0", "--json", "--plot", tmp_path / "one.png")
    (summary,) = rows_of(done)
    assert (done.exit_code, summary["samples"], summary["distance_m"], summary["sideslip_deg"]) == (0, 1, 0.0, None)
    assert "not known" in motion(path, "--vehicle", "sedan", "--mount", "0,0,0").stdout


def test_a_vehicle_from_a_file(handled: Handled, tmp_path: Path) -> None:
    path = tmp_path / "van.toml"
    path.write_text('class = "van"\nmass = 2900\ndevice = [0.6, 0.1, 0.4]\n')
    assert motion(handled.path, "--vehicle", path, "--mount", handled.mount).exit_code == 0


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (None, "neither a file nor one of city_car, sedan"),
        ("mass = -1", "mass must be a positive number, not -1"),
        ("mas = 1", "'mas' is not known"),
        ("mass = ", "Invalid value"),
    ],
)
def test_vehicles_that_cannot_be_used(handled: Handled, tmp_path: Path, text: str | None, words: str) -> None:
    path = tmp_path / "vehicle.toml"
    if text is not None:
        path.write_text(text)
    done = motion(handled.path, "--vehicle", path, "--mount", handled.mount)
    assert (done.exit_code, done.stdout) == (2, "")
    assert f"{path}: " in done.stderr
    assert words in done.stderr


def test_what_else_cannot_be_used(handled: Handled, tmp_path: Path) -> None:
    assert motion(handled.path, "--vehicle", "sedan", "--mount", "1,2").exit_code == 2
    missing = motion(tmp_path / "missing.csv", "--vehicle", "sedan")
    assert (missing.exit_code, missing.stderr) == (2, f"{tmp_path / 'missing.csv'}: No such file or directory\n")
    bad = tmp_path / "bad.csv"
    bad.write_text("t,ax,ay,az,fix,speed,course\n0,0,oops,9.8,1,3,90\n")
    done = motion(bad, "--vehicle", "sedan")
    assert (done.exit_code, done.stdout) == (2, "")
    assert "line 2, column ay" in done.stderr


def test_a_picture(handled: Handled, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    arguments = (handled.path, "--vehicle", "sedan", "--mount", handled.mount, "--plot")
    assert motion(*arguments, tmp_path / "drive.png").exit_code == 0
    assert (tmp_path / "drive.png").read_bytes().startswith(b"\x89PNG")
    done = motion(*arguments, tmp_path / "drive.xyz")
    assert done.exit_code == 2
    assert "not supported" in done.stderr


def test_a_picture_without_matplotlib(handled: Handled, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(sys.modules, "api.commands.motion_plot", raising=False)
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    done = motion(handled.path, "--vehicle", "sedan", "--mount", handled.mount, "--plot", tmp_path / "drive.png")
    assert done.exit_code == 2
    assert "livella[plot]" in done.stderr


def rows(n: int, **columns: Any) -> Motion:
    """Rows of 10 Hz of a vehicle that drives 10 m/s straight on."""
    usual: dict[str, Any] = {
        "t": np.arange(n) / 10.0,
        "q_nv": np.tile([1.0, 0.0, 0.0, 0.0], (n, 1)),
        "a_v": np.zeros((n, 3)),
        "w_v": np.zeros((n, 3)),
        "velocity_v": np.tile([10.0, 0.0], (n, 1)),
        "velocity_sigma": np.full((n, 2), 0.1),
        "sideslip": np.zeros(n),
        "sideslip_sigma": np.full(n, 0.01),
        "position_n": np.zeros((n, 3)),
        "position_sigma": np.arange(n) / 10.0,
        "dead_reckoned": np.zeros(n, np.bool_),
        "origin": None,
    }
    return Motion(**(usual | columns))


@pytest.mark.parametrize("cut", [1, 13, 25, 26, 30, 39])
def test_a_summary_of_pieces_is_that_of_the_whole(cut: int) -> None:
    rng = np.random.default_rng(1)
    bridged = np.zeros(40, np.bool_)
    bridged[3:7] = bridged[20:31] = True
    whole = rows(40, a_v=rng.normal(size=(40, 3)), sideslip=rng.normal(size=40) / 20, dead_reckoned=bridged)
    at_once, in_pieces = Summary(10.0), Summary(10.0)
    at_once.add(whole)
    for part in (slice(0, cut), slice(cut, None)):
        columns: dict[str, Any] = {name: getattr(whole, name)[part] for name in Motion._fields[:-1]}
        in_pieces.add(whole._replace(**columns))
    one, other = at_once.document(), in_pieces.document()
    assert one["outages"] == pytest.approx({"count": 2, "total_s": 1.5, "longest_s": 1.1, "position_sigma_m": 3.0})
    assert other["outages"] == pytest.approx(one["outages"])
    for name in ("distance_m", "top_speed_mps", "known_s"):
        assert other[name] == pytest.approx(one[name])
    for axis in ("longitudinal", "lateral", "vertical"):
        assert other["acceleration_mps2"][axis] == pytest.approx(one["acceleration_mps2"][axis])
    assert other["sideslip_deg"]["range"] == pytest.approx(one["sideslip_deg"]["range"])
