import pytest

from core import DEFAULT, NotStillError, advance, begin_session, encode, initial_state, level_start
from core.simulation import Scenario, simulate
from tests.core.drives import drive

PARKED = simulate(Scenario("parked", 10.0, 1, imu_rate=20.0)).samples


def test_a_vehicle_that_stands_still_is_taken_at_the_installers_word() -> None:
    state, _ = advance(DEFAULT, initial_state(DEFAULT), PARKED)
    before = encode(state)
    level_start(DEFAULT, state)
    assert encode(state) == before


def test_without_data_nothing_is_known_of_the_vehicle() -> None:
    with pytest.raises(NotStillError, match="has sent no data"):
        level_start(DEFAULT, initial_state(DEFAULT))
    state, _ = advance(DEFAULT, initial_state(DEFAULT), PARKED)
    with pytest.raises(NotStillError, match="has sent no data"):
        level_start(DEFAULT, begin_session(DEFAULT, state))


def test_a_moving_vehicle_is_refused_until_it_has_stood_for_two_seconds() -> None:
    state, _ = advance(DEFAULT, initial_state(DEFAULT), drive("short").samples)
    state.clock["motion_t"] = state.clock["t"] - 1.9
    with pytest.raises(NotStillError, match="was moving within the last 2 seconds"):
        level_start(DEFAULT, state)
    state.clock["motion_t"] = state.clock["t"] - 2.1
    level_start(DEFAULT, state)
