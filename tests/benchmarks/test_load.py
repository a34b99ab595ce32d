"""The load generator: pacing, figures, page, and a small fleet against the real service."""

import math

import pytest

from benchmarks.load_study.cells import CELLS, Result, measure
from benchmarks.load_study.pacing import Answer, Latency, Plan, bracket, due_times, errors, measured, quantiles
from benchmarks.load_study.page import assemble, largest_held
from benchmarks.load_study.processes import TICK, parse
from benchmarks.sections import with_section

PLAN = Plan(4, 20.0, 60.0)


def result(devices: int, p99: float, unanswered: int = 0, wrong: int = 0) -> Result:
    latency = Latency(0.01, 0.02, p99, 0.5)
    return Result(devices, latency, 100, {}, unanswered, wrong, 5e-3, 0.0, 3e-4, [200.0, 190.0], 0.5, devices, 1.5)


def test_devices_post_once_a_minute_at_phases_evenly_spread() -> None:
    assert [due_times(i, PLAN) for i in range(4)] == [[0.0, 60.0], [15.0, 75.0], [30.0], [45.0]]


def test_quantiles_are_values_and_rounded_up() -> None:
    assert quantiles([i / 100 for i in range(1, 101)]) == Latency(0.51, 0.96, 1.0, 1.0)
    assert all(math.isnan(value) for value in quantiles([]))


def test_the_warm_up_is_not_measured_but_its_errors_count() -> None:
    answers = [Answer(1.0, 9.0, 503), Answer(20.0, 0.1, 200), Answer(80.0, 0.1, 200), Answer(30.0, 1.0, 0)]
    assert [answer.due for answer in measured(answers, PLAN)] == [20.0, 30.0]
    assert errors(answers) == {"503": 1, "broken": 1}


@pytest.mark.parametrize(
    ("tried", "wanted"),
    [
        ({}, 1600),
        ({1600: True}, None),
        ({1600: False}, 800),
        ({1600: False, 800: True}, 1200),
        ({1600: False, 1500: True}, None),
    ],
)
def test_the_target_is_tried_first_then_what_lies_between(tried: dict[int, bool], wanted: int | None) -> None:
    assert bracket(tried, 1600, 100) == wanted


def test_a_count_is_held_only_if_nothing_went_wrong() -> None:
    assert result(10, 0.2).held(0.3)
    assert not result(10, 0.4).held(0.3)
    assert not any(result(10, 0.2, **{name: 1}).held(0.3) for name in ("unanswered", "wrong"))
    assert not result(10, 0.2)._replace(errors={"503": 1}).held(0.3)
    assert largest_held([result(10, 0.2), result(20, 0.4)], 0.3) == 10


def test_the_name_of_a_process_may_hold_anything() -> None:
    assert parse(7, "7 (a) b (c) S 3 0 0 0 0 0 0 0 0 0 40 2 0 0 20") == (7, 3, 42 * TICK)


def test_the_page_tells_what_was_met_and_what_was_skipped() -> None:
    runs = {"sqlite-csv": [result(10_000, 0.2)], "sqlite-arrow": [result(30_000, 0.4), result(15_000, 0.1)]}
    text = assemble(runs, {"sqlite-csv-fsync": "gcc is needed"}, {"CSV": {"parse": 2.0}}, PLAN, 0.3)
    assert "| devices, SQLite, CSV zstd | ≥ 10000 | 10000 | met |" in text
    assert "| devices, SQLite, Arrow zstd | ≥ 30000 | 15000 | **not met** |" in text
    assert "gcc is needed | not measured" in text
    assert "| sqlite-csv | 10000 | yes | 10.0 / 20.0 / 200 / 500 | 0 | 5.00 |" in text
    assert "| parse | 2.00 |" in text


def test_a_section_is_written_anew_and_leaves_the_others() -> None:
    page = with_section(with_section("", "a", "# A\n\n1"), "b", "# B\n\n2")
    again = with_section(page, "a", "# A\n\n3")
    assert again == page.replace("1", "3")
    assert again.index("# A") < again.index("# B")


@pytest.mark.slow
def test_every_chunk_a_small_fleet_sends_is_stored_once() -> None:
    seen = measure(CELLS["sqlite-csv"], Plan(20, 1.0, 5.0))
    assert seen.chunks >= 1
    assert (seen.errors, seen.unanswered, seen.wrong) == ({}, 0, 0)
    assert seen.server_cpu > 0
