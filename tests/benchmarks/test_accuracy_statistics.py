"""The figures of docs/accuracy.md: what is counted, and how, before anything is run."""

import math

import pytest

from benchmarks.accuracy_study.statistics import (
    at_least,
    at_most,
    none_of,
    number,
    percent,
    quantile,
    share_of,
    spread,
    table,
    target_table,
    within,
)


def test_a_drive_without_an_estimate_counts_as_infinitely_bad() -> None:
    assert quantile([1.0, 2.0, 3.0, math.nan], 0.5) == 3.0
    assert quantile([1.0, None, None], 0.95) == math.inf
    assert spread([0.5, 0.5, math.nan]) == "0.50 / none"


def test_a_percentile_is_the_error_of_a_drive_and_never_below_its_share() -> None:
    errors = list(range(1, 101))
    assert quantile(errors, 0.95) == 96
    assert quantile([7.0], 0.95) == 7.0
    assert math.isnan(quantile([], 0.5))


@pytest.mark.parametrize(
    ("value", "written"),
    [(0.054, "0.05"), (9.99, "9.99"), (12.34, "12.3"), (180.0, "180"), (math.inf, "none"), (math.nan, "–")],
)
def test_figures_have_three_digits(value: float, written: str) -> None:
    assert number(value) == written


def test_almost_all_is_not_all() -> None:
    assert percent(0.9999) == "99.9 %"
    assert percent(1.0) == "100 %"
    assert percent(share_of([])) == "–"
    assert share_of([True, False]) == 0.5


def test_every_figure_has_to_meet_its_limit() -> None:
    assert at_most("error", (1.0, 2.0), (1.0, 2.0)).met
    assert at_most("error", (1.0, 2.1), (1.0, 2.0)).met is False
    assert at_most("delay", (math.inf,), (180.0,), " s") == ("delay", "≤ 180 s", "none", False)
    assert within("nees", (2.1, 4.2), 2.1, 4.2).met
    assert within("nees", (2.0, 3.0), 2.1, 4.2).met is False
    assert at_least("inside", 0.99, 0.99).met
    assert at_least("inside", 0.98, 0.99).met is False


def test_nothing_measured_is_neither_met_nor_missed() -> None:
    made = [
        at_most("error", (math.nan,), (1.0,)),
        within("nees", (math.nan, 3.0), 2, 4),
        at_least("inside", math.nan, 0.99),
        none_of("alarms", 0, 0, "h"),
    ]
    assert [target.met for target in made] == [None] * 4


def test_what_must_never_happen() -> None:
    assert none_of("alarms", 0, 300, "h") == ("alarms", "0", "0 in 300 h", True)
    assert none_of("alarms", 1, 300, "h").met is False


def test_tables_are_markdown() -> None:
    assert table(["a", "b"], [["c", "d"]]) == "| a | b |\n| --- | --: |\n| c | d |"
    assert "| inside | ≥ 99.0 % | 100 % | met |" in target_table([at_least("inside", 1.0, 0.99)])
    assert "**not met**" in target_table([at_least("inside", 0.5, 0.99)])
