from dataclasses import replace

import numpy as np
import pytest

from core import quaternion
from core.simulation_marg import DIP, FIELD_STRENGTH, KINDS, MargScenario, simulate
from core.simulation_motion import GRAVITY

QUIET = MargScenario(gyro_noise=0.0, force_noise=0.0, field_noise=0.0, pressure_noise=0.0)


@pytest.mark.parametrize("motion", KINDS)
def test_integrating_the_gyroscope_gives_the_attitude_back(motion: str) -> None:
    log = simulate(replace(QUIET, motion=motion, seconds=20.0, seed=1, gyro_bias=0.0))
    q = log.q_ns[0]
    for turned in quaternion.from_rotation_vector(log.samples.w_s[1:] / 100.0):
        q = quaternion.multiply(q, turned)
    assert quaternion.angle_between(q, log.q_ns[-1]) < 1e-9


def test_integrating_the_specific_force_gives_a_path_that_comes_to_no_other_height() -> None:
    log = simulate(replace(QUIET, motion="violent", seconds=30.0, seed=2, rate=400.0, arm=0.3))
    a_n = quaternion.rotate(log.q_ns, log.samples.f_s) - [0.0, 0.0, GRAVITY]
    height = np.cumsum(np.cumsum(a_n[:, 2]) / 400.0) / 400.0
    assert np.abs(height - (log.altitude - log.altitude[0])).max() < 0.01


def test_the_field_is_the_earths_unless_it_is_disturbed() -> None:
    log = simulate(replace(QUIET, motion="brisk", seconds=60.0, seed=3, disturbed=True))
    assert log.samples.m_s is not None
    m_n = quaternion.rotate(log.q_ns, log.samples.m_s)
    earth = FIELD_STRENGTH * np.array([0.0, np.cos(DIP), -np.sin(DIP)])
    off = np.linalg.norm(m_n - earth, axis=1)
    assert off[~log.disturbed].max() < 1e-9
    assert 0.1 < log.disturbed.mean() < 0.7
    assert off.max() > 10.0


def test_the_same_seed_gives_the_same_log_and_another_another() -> None:
    one, same, other = (simulate(MargScenario(seconds=5.0, seed=seed)).samples.f_s for seed in (4, 4, 5))
    np.testing.assert_array_equal(one, same)
    assert np.abs(one - other).max() > 0.01


def test_the_pressure_tells_the_altitude() -> None:
    log = simulate(replace(QUIET, motion="rest", seconds=2.0))
    assert log.samples.pressure is not None
    np.testing.assert_allclose(log.samples.pressure, 100129.4, atol=1.0)  # ISO 2533 at 100 m
