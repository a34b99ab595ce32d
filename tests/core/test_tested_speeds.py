"""What the drive test tells of the speeds it compares, and the speed at the last fix."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest

from core import DEFAULT, THESIS, EventKind, Outcome, Parameters, Verification
from core._kernel import EARTH_RADIUS
from tests.core.drives import Floats, drive, remounted_result, run

ENDS = (EventKind.VERIFICATION_FAILED, EventKind.CONFIRMED)


class Trace(NamedTuple):
    """Speeds of one test."""

    t: Floats
    gps: Floats
    sensor: Floats


def finished(outcome: Outcome) -> list[tuple[Trace, Verification]]:
    """Give the speeds of each finished test, with how it ended."""
    tested = outcome.tested
    begun = np.flatnonzero(tested.begins)
    found = []
    for event in outcome.events:
        if event.kind in ENDS:
            assert event.verification is not None
            stop = int(np.searchsorted(tested.t, event.t, side="right"))
            start = int(begun[begun < stop][-1])
            columns = (tested.t, tested.gps, tested.sensor)
            found.append((Trace(*(column[start:stop] for column in columns)), event.verification))
    return found


@pytest.mark.compiled
@pytest.mark.parametrize("params", [DEFAULT, THESIS], ids=["default", "thesis"])
@pytest.mark.parametrize("name", ["city", "city without gyro"])
def test_at_the_end_of_a_test_the_speeds_differ_by_its_error(name: str, params: Parameters) -> None:
    tests = finished(run(drive(name).samples, params)[1])
    assert tests
    for speeds, verification in tests:
        assert abs(speeds.sensor[-1] - speeds.gps[-1]) == pytest.approx(verification.error, abs=1e-9)


@pytest.mark.compiled
def test_under_a_right_mounting_the_speeds_lie_on_each_other_and_under_a_wrong_one_they_part() -> None:
    tests = finished(run(drive("city").samples)[1])
    assert {verification.state for _, verification in tests} == {"failed", "passed"}
    for speeds, verification in tests:
        apart = np.abs(speeds.sensor - speeds.gps)
        if verification.state == "passed":
            assert apart.max() < 1.0
            assert np.corrcoef(speeds.sensor, speeds.gps)[0, 1] > 0.99
        else:
            assert apart[-1] > 4 * apart[: apart.size // 4].max()


@pytest.mark.compiled
@pytest.mark.parametrize("params", [DEFAULT, THESIS], ids=["default", "thesis"])
def test_there_is_a_row_for_each_second_of_driving_and_none_of_standing(params: Parameters) -> None:
    samples = drive("city").samples
    _, outcome = run(samples, params)
    started = [event for event in outcome.events if event.kind is EventKind.VERIFICATION_STARTED]
    assert np.count_nonzero(outcome.tested.begins) == len(started)
    for speeds, verification in finished(outcome):
        assert verification.elapsed <= speeds.t.size <= verification.elapsed + 2
        assert np.all(np.diff(speeds.t) > 0)
        said = samples.fix[np.isin(samples.t[samples.fix_row], speeds.t), 3]
        assert speeds.gps.tolist() == said.tolist()
        if params is DEFAULT:
            assert speeds.gps.min() > params.epoch.moving_speed


def test_rows_are_told_of_tests_alone() -> None:
    """Also after the mounting that was confirmed no longer holds, and until the next is on its test."""
    _, outcome = remounted_result()
    tested = outcome.tested
    running = np.zeros(tested.t.size, bool)
    begun = np.nan
    for event in outcome.events:
        if event.kind is EventKind.VERIFICATION_STARTED:
            begun = event.t
        if event.kind in ENDS:
            running |= (tested.t > begun) & (tested.t <= event.t)
    assert len(finished(outcome)) >= 2
    assert running.all()


def test_the_speed_is_that_of_the_last_fix() -> None:
    samples = drive("short").samples
    assert run(samples)[1].speed == samples.fix[-1, 3]
    assert np.isnan(run(replace(samples, fix_valid=np.zeros_like(samples.fix_valid)))[1].speed)


def test_the_speed_is_derived_from_positions_as_for_the_estimator() -> None:
    samples = drive("short").samples
    fix = samples.fix.copy()
    fix[:, 3:5] = np.nan
    t, place = samples.t[samples.fix_row[-2:]], fix[-2:, :2]
    north, east = EARTH_RADIUS * (place[1] - place[0]) * [1.0, np.cos(place[1, 0])]
    assert run(replace(samples, fix=fix))[1].speed == pytest.approx(np.hypot(north, east) / (t[1] - t[0]))
    fix[-1, :2] = np.nan
    assert np.isnan(run(replace(samples, fix=fix))[1].speed)
