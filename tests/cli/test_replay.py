import gzip
import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import zstandard
from typer.testing import CliRunner, Result

import core
from api.cli import app
from core import Event, EventKind, Evidence, Fault, Outcome, State, quaternion
from tests.cli import livella
from tests.cli.conftest import Log

EVENTS = {
    "verification_started",
    "verification_passed",
    "verification_failed",
    "confirmed",
    "orientation_changed",
    "fault",
}


def replay(*arguments: object) -> Result:
    return CliRunner().invoke(app, ["replay", *map(str, arguments)])


@pytest.fixture(scope="module")
def lines(drive: Log) -> list[dict[str, Any]]:
    done = livella.run("replay", drive.path, "--json")
    assert (done.status, done.err) == (0, "")
    return done.lines


def of(kind: str, lines: list[dict[str, Any]]) -> list[dict[str, Any]]:
    return [line for line in lines if line["type"] == kind]


def test_json_has_estimates_events_and_one_summary(lines: list[dict[str, Any]]) -> None:
    assert {line["type"] for line in lines} == {"estimate", "event", "summary"}
    assert [line["type"] for line in lines].index("summary") == len(lines) - 1
    times = [line["t"] for line in lines[:-1]]
    assert times == sorted(times)


def test_estimates_come_every_second(lines: list[dict[str, Any]]) -> None:
    estimates = of("estimate", lines)
    assert set(estimates[0]) == {
        "type", "t", "stage", "quaternion", "sigma_deg", "stable", "reliable", "progress", "needs",
    }  # fmt: skip
    np.testing.assert_allclose(np.diff([line["t"] for line in estimates]), 1.0, atol=0.3)
    assert len(estimates) > 300
    assert {line["stage"] for line in estimates} >= {"settling", "verifying", "confirmed"}


def test_the_mounting_is_found(lines: list[dict[str, Any]], drive: Log) -> None:
    confirmed = [line for line in of("event", lines) if line["event"] == "confirmed"]
    assert {line["event"] for line in of("event", lines)} <= EVENTS
    summary = lines[-1]
    assert summary["stage"] == "confirmed"
    truth = drive.truth["mount"]["quaternion"]
    for found in (confirmed[-1], summary["mount"], summary["estimate"]):
        assert np.degrees(quaternion.angle_between(found["quaternion"], truth)) < 4
        assert len(found["sigma_deg"]) == 3
    assert summary["mount"]["angles_deg"]["yaw"] == pytest.approx(100, abs=5)


def test_the_summary_counts(lines: list[dict[str, Any]], drive: Log) -> None:
    summary = lines[-1]
    assert summary["file"] == str(drive.path)
    assert summary["samples"] + summary["rejected"].get("duplicate_time", 0) == 66_000
    assert summary["fixes"] > 1300
    assert summary["duration_s"] == pytest.approx(330, abs=0.1)


def test_json_is_strict_json(lines: list[dict[str, Any]]) -> None:
    json.dumps(lines, allow_nan=False)


def test_fewer_estimates(drive: Log) -> None:
    done = replay(drive.path, "--json", "--every", 30)
    estimates = of("estimate", [json.loads(line) for line in done.stdout.splitlines()])
    assert 5 < len(estimates) <= 12


@pytest.mark.parametrize("preset", ["default", "thesis"])
def test_the_table(drive: Log, preset: str) -> None:
    done = replay(drive.path, drive.path, "--preset", preset)
    assert done.exit_code == 0
    assert done.stdout.count("66000") == 2
    assert "roll" in done.stdout
    assert "±" in done.stdout


def test_every_compression_gives_the_same(tmp_path: Path, lines: list[dict[str, Any]], drive: Log) -> None:
    content = gzip.decompress(drive.path.read_bytes())
    for name, body in (("plain.log", content), ("log.zst", zstandard.compress(content))):
        path = tmp_path / name
        path.write_bytes(body)
        done = replay(path, "--json")
        assert [json.loads(line) for line in done.stdout.splitlines()][:-1] == lines[:-1]


def test_a_thesis_log(tmp_path: Path, drive: Log) -> None:
    path = tmp_path / "thesis.txt"
    path.write_text(thesis_log(gzip.decompress(drive.path.read_bytes()).decode()))
    done = replay(path, "--json")
    summary = json.loads(done.stdout.splitlines()[-1])
    assert summary["stage"] == "confirmed"
    truth = drive.truth["mount"]["quaternion"]
    assert np.degrees(quaternion.angle_between(summary["mount"]["quaternion"], truth)) < 5


def thesis_log(csv: str) -> str:
    """The same drive in the thesis' format: repeated cells, course counted anticlockwise, no gyroscope."""
    header, *rows = csv.splitlines()
    out, gps = [], "0;0;0;0;0;0"
    for number, row in enumerate(rows):
        cells = dict(zip(header.split(","), row.split(","), strict=True))
        if cells["fix"] == "1":
            course = -float(cells["course"]) % 360
            gps = f"{cells['lon']};{cells['lat']};{cells['alt']};{float(cells['speed']) * 3.6:.3f};{course:.3f};1"
        acceleration = ";".join(f"{float(cells[axis]) / 0.0980665:.3f}" for axis in ("ax", "ay", "az"))
        out.append(f"{number};{float(cells['t']) * 1000:.0f};{gps};{acceleration}")
    return "\n".join(out)


def event(kind: EventKind, **known: Any) -> Event:
    nothing = dict.fromkeys(("quaternion", "sigma", "verification", "angle", "reason"))
    return Event(t=98.2, kind=kind, **(nothing | known))


FAULTY = event(EventKind.FAULT, fault=Fault.LEFT_HANDED, reason="the axes are a mirror image", since=61.0)
MOVED = event(
    EventKind.ORIENTATION_CHANGED,
    quaternion=np.array([1.0, 0.0, 0.0, 0.0]),
    sigma=np.radians([1.0, 1.0, 2.0]),
    angle=np.radians(14.0),
    axis=np.array([0.0, 0.0, 1.0]),
    since=61.0,
    evidence=Evidence(np.array([60.0, 65.0]), np.array([20.0, 61.0]), 60.0),
)


@pytest.fixture
def eventful(monkeypatch: pytest.MonkeyPatch) -> None:
    """An estimator that finds the same events in every piece of a log."""

    def advance(*given: Any) -> tuple[State, Outcome]:
        state, outcome = core.advance(*given)
        return state, outcome._replace(events=(FAULTY, MOVED))

    monkeypatch.setattr("api.commands.replay.core", SimpleNamespace(**vars(core) | {"advance": advance}))


@pytest.mark.usefixtures("eventful")
def test_event_lines_tell_what_is_known_and_nothing_else(tmp_path: Path) -> None:
    done = replay(one_sample(tmp_path), "--json")
    fault, moved = of("event", [json.loads(line) for line in done.stdout.splitlines()])
    assert fault == {
        "type": "event",
        "t": 98.2,
        "event": "fault",
        "since": 61.0,
        "fault": "left_handed",
        "reason": "the axes are a mirror image",
    }
    assert moved.pop("sigma_deg") == pytest.approx([1, 1, 2])
    assert moved == {
        "type": "event",
        "t": 98.2,
        "event": "orientation_changed",
        "quaternion": [1, 0, 0, 0],
        "angle_deg": pytest.approx(14),
        "axis": [0, 0, 1],
        "since": 61.0,
        "evidence": {"t": [60, 65], "value": [20, 61], "threshold": 60.0},
    }


@pytest.mark.usefixtures("eventful")
def test_the_table_names_each_fault_once(drive: Log) -> None:
    assert replay(drive.path).stdout.count("left_handed") == 1


def test_a_file_that_cannot_be_read_and_one_that_can(tmp_path: Path, drive: Log) -> None:
    bad = tmp_path / "bad.csv"
    bad.write_text("t,ax,ay,az,fix,speed,course\n0,0,0,9.8,1,3,90\n0.1,0,oops,9.8,,,\n")
    done = livella.run("replay", bad, drive.path, tmp_path / "missing.csv", "--json", "--every", 100)
    assert done.status == 2
    assert f"{bad}: line 3, column ay: expected a number, found 'oops'" in done.err
    assert f"{tmp_path / 'missing.csv'}: No such file" in done.err
    assert [line["file"] for line in of("summary", done.lines)] == [str(drive.path)]


@pytest.mark.parametrize(
    ("name", "body", "words"),
    [
        ("empty.csv", b"", "line 1: the log is empty"),
        ("photo.png", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", "not text"),
        ("cut.csv.gz", gzip.compress(b"t,ax,ay,az,fix,lat,lon\n0,0,0,9.8,,,\n", mtime=0)[:-9], "truncated"),
        ("header.csv", b"t,ax,ay,az,fix\n", 'column speed: the column "speed" is missing'),
        ("short.txt", b"1 2 3\n", "line 1: expected 11 cells, found 3"),
    ],
)
def test_files_that_are_no_logs(tmp_path: Path, name: str, body: bytes, words: str) -> None:
    (tmp_path / name).write_bytes(body)
    done = replay(tmp_path / name, "--json")
    assert done.exit_code == 2
    assert done.stdout == ""
    assert f"{tmp_path / name}: " in done.stderr
    assert words in done.stderr


def test_a_directory_is_no_log(tmp_path: Path) -> None:
    done = replay(tmp_path)
    assert done.exit_code == 2
    assert "Is a directory" in done.stderr


def one_sample(directory: Path) -> Path:
    path = directory / "one.csv"
    path.write_text("t,ax,ay,az,fix,speed,course\n5,0,0,9.8,1,3,90\n")
    return path


def test_a_log_of_one_sample(tmp_path: Path) -> None:
    path = one_sample(tmp_path)
    done = replay(path, "--json")
    summary = json.loads(done.stdout.splitlines()[-1])
    assert (done.exit_code, summary["mount"], summary["estimate"], summary["samples"]) == (0, None, None, 1)
    assert "turn" in replay(path).stdout, "a vehicle in motion is to show where forward is"


def test_unknown_columns_are_reported_on_stderr(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text("t,ax,ay,az,fix,speed,course,rpm\n5,0,0,9.8,1,3,90,900\n")
    assert 'column "rpm" is not known' in replay(path, "--json").stderr
