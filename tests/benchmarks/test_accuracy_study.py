"""The yardsticks of docs/accuracy.md measure what they should, and the page says what was measured."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks.accuracy_study import (
    alarms,
    cells,
    confirming,
    drive_tests,
    gyroscopes,
    hard,
    page,
    real,
    remounts,
    runs,
)
from benchmarks.accuracy_study.options import Options
from benchmarks.accuracy_study.procrustes import epochs, procrustes, solve
from core import Estimates, quaternion
from core.simulation import Scenario, simulate
from core.simulation_motion import GRAVITY

RNG = np.random.default_rng(3)
PERFECT = Scenario(seconds=240, ideal=True, vibration=0.2, latency=0.0, lever_arm=(0, 0, 0), relief=0.0, imu_rate=50)


@pytest.mark.parametrize("q_vs", quaternion.random(RNG, 4))
def test_procrustes_solves_for_a_mounting_and_ignores_a_bias(q_vs: np.ndarray) -> None:
    k_v = np.column_stack([RNG.normal(size=(200, 2)), np.full(200, GRAVITY)])
    f_s = k_v @ quaternion.matrix(q_vs) + [0.02, -0.01, 0.03]
    assert runs.degrees_off(solve(f_s, k_v), q_vs) < 0.3


def test_procrustes_recovers_the_mounting_of_a_drive() -> None:
    drive = simulate(PERFECT)
    early, late = procrustes(drive.samples, [5.0, 240.0])
    assert np.all(np.isnan(early))
    assert runs.degrees_off(late, drive.truth.q_vs) < 1.0


def test_epochs_last_about_a_second_and_are_in_motion() -> None:
    drive = simulate(PERFECT)
    seen = epochs(drive.samples)
    assert np.all(np.diff(seen.t) > 0.94)
    assert 100 < seen.t.size < 240
    np.testing.assert_allclose(np.linalg.norm(seen.f_s, axis=1), np.linalg.norm(seen.k_v, axis=1), atol=1.0)


def test_the_newest_estimate_is_compared_with_the_truth() -> None:
    truth = np.array([1.0, 0, 0, 0])
    off = [quaternion.from_rotation_vector([0.0, 0.0, np.radians(a)]) for a in (4.0, 2.0)]
    flags, sigma = np.zeros(2, np.int64), np.full((2, 3), np.radians(2.0))
    told = Estimates(np.array([10.0, 20.0]), np.array(off), sigma, flags, flags, flags > 0, flags > 0, np.zeros(2))
    found = runs.errors(told, truth, np.array([5.0, 15.0, 20.0, 99.0]))
    np.testing.assert_allclose(found.angle, [np.nan, 4, 2, 2])
    np.testing.assert_allclose(found.nees, [np.nan, 4, 1, 1])


def test_gyroscopes_show_the_rotation_between_two_devices_with_clocks_apart() -> None:
    scenario = replace(PERFECT, mount=(1, 0, 0, 0), gyro=True, route="curves")
    q = quaternion.from_angles(0.3, -0.2, 1.5)
    one, other = simulate(scenario).samples, simulate(replace(scenario, mount=q)).samples
    late = replace(other, t=other.t + 7.3)
    assert runs.degrees_off(gyroscopes.relative_rotation(one, late), q) < 0.2


def test_the_drive_test_tells_a_tilted_mounting_from_a_right_one() -> None:
    drive = simulate(PERFECT)
    work, q_vs = drive_tests.work_of(drive), drive.truth.q_vs
    tilted = quaternion.multiply(quaternion.from_rotation_vector([0.0, 0.1, 0.0]), q_vs)
    right, wrong = (drive_tests.speed_error(work, quaternion.matrix(q)[0], np.zeros(3), 60.0) for q in (q_vs, tilted))
    assert right < 1.5
    assert wrong > 20
    assert np.isnan(drive_tests.speed_error(work, quaternion.matrix(q_vs)[0], np.zeros(3), 230.0))


def test_the_angles_of_turned_logs_are_near_90_and_180_too() -> None:
    q = real.rotations(RNG)
    angle = np.degrees(quaternion.angle_between(q, [1.0, 0, 0, 0]))
    assert q.shape == (20, 4)
    assert np.sum(np.abs(angle - 90) < 3) >= 6
    assert np.sum(np.abs(angle - 180) < 3) >= 6


@pytest.mark.parametrize("kind", hard.KINDS)
def test_every_hard_drive_can_be_simulated(kind: str) -> None:
    scenario = hard.scenario_of(kind, 1)
    assert 300 <= scenario.seconds <= 600
    assert len(simulate(replace(scenario, seconds=20.0, imu_rate=20.0)).samples) > 100


def test_what_a_left_handed_sensor_confirms_is_wrong() -> None:
    good = {"confirmed": [{"t": 1.0, "error": [0.1, 0.1, 0.1], "sigma": [1, 1, 1]}], "faults": []}
    assert hard.wrong("steep hills", [good]) == 0
    assert hard.wrong("left-handed, accelerometer", [good]) == 1
    assert hard.wrong("left-handed, accelerometer", [{"confirmed": [], "faults": []}]) == 0


def test_stories_keep_the_device_from_drive_to_drive() -> None:
    sessions = alarms.sessions_of("town, then a night, then town", 3)
    assert [scenario.session for scenario in sessions] == [0, 1, 2]
    assert {scenario.seed for scenario in sessions} == {3}


def test_a_device_is_turned_by_what_is_said() -> None:
    for axis in remounts.AXES:
        scenario, angle = remounts.scenario_of((axis, True, (10.0, 20.0), 5))
        assert scenario.remount is not None
        assert scenario.mount is not None
        turn = np.degrees(runs.error_vector(scenario.remount[1], scenario.mount))
        assert np.linalg.norm(turn) == pytest.approx(angle)
        assert 10 <= angle <= 20
        assert (np.abs(turn[2]) == pytest.approx(angle)) == (axis == "yaw only")


def test_without_recorded_drives_the_section_says_so(tmp_path: Path) -> None:
    result = real.measure(Options(data=tmp_path))
    assert "skipped" in real.text(result)
    assert {target.met for target in real.targets(result)} == {None}


def fake_cells() -> dict[str, Any]:
    series = [None, *[1.0] * (cells.TIMES.size - 1)]
    confirmed = [{"t": 100.0, "error": [0.5, 0.0, 0.0], "sigma": [1.0, 1.0, 1.0]}]
    names = ("default", "thesis", "procrustes", "nees")
    drive = dict.fromkeys(names, series) | {"moving": 5.0, "confirmed": confirmed}
    return {name: [drive, drive] for name in cells.CELLS}


def test_the_page_begins_with_the_targets_and_leaves_out_what_was_not_measured(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cells, "PICTURES", tmp_path)
    told = page.assemble({"cells": fake_cells()})
    assert told.index("## Targets") < told.index("## Accuracy over time") < told.index("## Confirmations")
    assert "## Hard drives" not in told
    assert "| city, mems: error after 2 min, median / 95th percentile | ≤ 2.00 / 4.50° | 1.00 / 1.00° | met |" in told
    assert "median / 90th percentile | ≤ 120 / 240 s | 95.0 / 95.0 s | met |" in told
    assert {path.name for path in tmp_path.iterdir()} == {"error.png", "nees.png"}


def test_a_confirmation_outside_its_region_is_counted() -> None:
    bold = {"error": [5.0, 0.0, 0.0], "sigma": [1.0, 1.0, 1.0]}
    honest = {"error": [2.0, 2.0, 2.0], "sigma": [1.0, 1.0, 1.0]}
    assert confirming.in_region([bold, honest]) == 0.5
    assert confirming.in_axes([bold, honest]) == pytest.approx(5 / 6)


def test_alarms_are_counted_and_say_where_to_look() -> None:
    quiet = {"seed": 1, "hours": 1.0, "raised": [], "confirmed": True}
    loud = quiet | {"seed": 2, "raised": [["orientation_changed", 0, 99.0], ["stuck_axis", 1, 5.0]]}
    result = {"city, mems": [quiet, loud], "town, then towed": [loud]}
    assert [target.measured for target in alarms.targets(result)] == ["1 in 2 h", "1 in 2 h"]
    told = alarms.text(result)
    assert "| city, mems | 2.0 | 2 of 2 | 1 | 1 |" in told
    assert "- city, mems, seed 2: stuck_axis on drive 2 after 5 s" in told


def test_every_row_of_a_table_has_all_its_columns() -> None:
    good = {"confirmed": [{"t": 1.0, "error": [0.1, 0.1, 0.1], "sigma": [1, 1, 1]}], "faults": ["saturated"]}
    turned = {"before": True, "false": 0, "delay": 9.0, "angle_error": 1.0, "anew": None, "anew_after": None}
    drives = [[["any axis", True, [6.0, 10.0], 0], turned]]
    told = [hard.text({"saturated": [good]}), remounts.text({"drives": drives}), confirming.text(fake_cells())]
    for text in told:
        assert len({line.count(" | ") for line in text.splitlines() if line.startswith("|")}) == 1
