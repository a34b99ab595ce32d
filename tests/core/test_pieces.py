"""A drive in any pieces through snapshots equals the drive at once, bit for bit."""

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from core import DEFAULT, THESIS, Outcome, Parameters, Samples, State, advance, decode, encode, initial_state
from tests.core.drives import drive, remounted, run


class Whole(NamedTuple):
    """What all pieces gave, one after the other."""

    state: bytes
    history: bytes
    speeds: bytes
    events: str


def together(state: State, outcomes: Sequence[Outcome]) -> Whole:
    return Whole(
        encode(state),
        joined([outcome.estimates for outcome in outcomes]),
        joined([outcome.tested for outcome in outcomes]),
        str([event for outcome in outcomes for event in outcome.events]),
    )


def joined(tables: Sequence[Sequence[np.ndarray]]) -> bytes:
    rows = [np.column_stack([np.atleast_2d(column.T).T for column in table]) for table in tables]
    return np.concatenate(rows).tobytes()


def in_pieces(params: Parameters, samples: Samples, cuts: list[int]) -> Whole:
    state = initial_state(params)
    outcomes: list[Outcome] = []
    edges = [0, *sorted(cuts), len(samples)]
    for start, stop in pairwise(edges):
        state, outcome = advance(params, decode(encode(state)), samples.slice(start, stop))
        outcomes.append(outcome)
    return together(state, outcomes)


def assert_same(params: Parameters, samples: Samples, cuts: list[int]) -> None:
    whole, outcome = run(samples, params)
    assert in_pieces(params, samples, cuts) == together(whole, [outcome])


@pytest.mark.compiled
@settings(max_examples=12, deadline=None, suppress_health_check=list(HealthCheck))
@given(cuts=st.lists(st.integers(0, 1800), max_size=12), params=st.sampled_from([DEFAULT, THESIS]))
def test_any_cuts(cuts: list[int], params: Parameters) -> None:
    assert_same(params, drive("short").samples, cuts)


def test_single_samples() -> None:
    samples = drive("short").samples.slice(0, 1000)
    assert_same(DEFAULT, samples, list(range(1, 1000)))


@pytest.mark.compiled
def test_through_confirmation_and_orientation_change() -> None:
    samples = remounted().samples
    assert_same(DEFAULT, samples, np.random.default_rng(1).integers(0, len(samples), 60).tolist())
