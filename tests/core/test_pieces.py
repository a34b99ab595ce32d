"""A drive in any pieces through snapshots equals the drive at once, bit for bit."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from core import DEFAULT, THESIS, Event, Parameters, Samples, State, advance, decode, encode, initial_state
from tests.core.drives import drive, remounted, run


def in_pieces(params: Parameters, samples: Samples, cuts: list[int]) -> tuple[State, list[np.ndarray], list[Event]]:
    state = initial_state(params)
    history: list[np.ndarray] = []
    events: list[Event] = []
    edges = [0, *sorted(cuts), len(samples)]
    for start, stop in pairwise(edges):
        state, outcome = advance(params, decode(encode(state)), samples.slice(start, stop))
        history.append(np.column_stack([np.atleast_2d(column.T).T for column in outcome.estimates]))
        events += outcome.events
    return state, history, events


def assert_same(params: Parameters, samples: Samples, cuts: list[int]) -> None:
    whole, outcome = run(samples, params)
    state, history, events = in_pieces(params, samples, cuts)
    assert encode(state) == encode(whole)
    at_once = np.column_stack([np.atleast_2d(column.T).T for column in outcome.estimates])
    assert np.concatenate(history).tobytes() == at_once.tobytes()
    assert str(events) == str(list(outcome.events))


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
