"""The page finds its words for the service's sentences by the English ones: each must stand in its texts."""

import re
from datetime import timedelta
from typing import Any, NamedTuple

import pytest

from api.services import presenting
from api.services.rules import Limits, clock_fault
from api.services.rules.clock_fault import Memory
from core import estimator
from storage.alerts import Finding
from tests.server import ROOT
from tests.services.test_rules import NOW, seen

TEXTS = (ROOT / "web/src/text/en/history.ts").read_text()


class Case(NamedTuple):
    """What shows that a clock is wrong."""

    memory: Memory
    chunk: dict[str, Any]


ZERO = NOW.timestamp()
CLOCKS = {
    "back": Case(Memory(session=1, t=100.0), {"t_first": 40.0, "t_last": 100.0, "back": 600}),
    "standing": Case(Memory(session=1), {"repeated": 6000}),
    "ahead": Case(Memory(session=1, agreed=ZERO, least=ZERO, window_r=ZERO), {"t_last": 120.0}),
    "fast": Case(
        Memory(session=1, window_r=ZERO, least=ZERO, rates=(1.1, 1.1)),
        {"t_last": 660.0, "received_at": NOW + timedelta(seconds=600)},
    ),
}


@pytest.mark.parametrize("name", CLOCKS)
def test_the_page_knows_what_is_wrong_with_a_clock(name: str) -> None:
    memory, chunk = CLOCKS[name]
    _, verdict = clock_fault.step(memory, seen(**chunk), Limits())
    assert isinstance(verdict, Finding)
    assert re.sub(r"\d+", "{{number}}", verdict.data["reason"]) in TEXTS


SENTENCES = (
    *presenting.HINTS.values(),
    *(reason for reason in estimator._REASONS if reason),
    *(sentence for _, sentence in estimator._FAULTS),
)


@pytest.mark.parametrize("sentence", SENTENCES)
def test_the_page_knows_the_reasons_of_tests_faults_and_stalled_calibrations(sentence: str) -> None:
    assert f'"{sentence}"' in TEXTS


@pytest.mark.parametrize("reason", [*estimator.REJECTIONS, "fix_repeated", "unusable"])
def test_the_page_says_what_to_do_about_readings_that_are_not_used(reason: str) -> None:
    assert f" {reason}:" in TEXTS
    assert f" {reason}_do:" in TEXTS
