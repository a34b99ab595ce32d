from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

from core import Samples, quaternion
from core.attitude import DEFAULT, FILTERS, Attitudes, has_compass, initial_state
from core.simulation_marg import DIP, FIELD_STRENGTH, MargLog, MargScenario, simulate
from core.simulation_motion import GRAVITY

Floats = NDArray[np.float64]
CORRECTING = [name for name in FILTERS if name != "gyro"]
COMPASSED = ["ekf", "madgwick", "quest-ekf"]
RATE = 100.0
EARTH = FIELD_STRENGTH * np.array([0.0, np.cos(DIP), -np.sin(DIP)])
HURTING = [
    [0.0, 0.0, 0.0],
    [np.pi, 0.0, 0.0],
    [0.0, np.pi - 1e-6, 0.0],
    [0.0, 0.0, np.pi],
    [0.0, np.pi / 2, 0.0],
    [1.0, -2.0, 0.5],
]


@cache
def log_of(motion: str, seed: int = 11, disturbed: bool = False, magnetometer: bool = True) -> MargLog:
    return simulate(MargScenario(motion, 60.0, seed, disturbed=disturbed, magnetometer=magnetometer))


def still(q_ns: Floats, seconds: float = 10.0) -> Samples:
    """Readings without noise of a sensor that stands at one attitude."""
    n = int(seconds * RATE)
    f, m = (np.tile(quaternion.rotate(quaternion.conjugate(q_ns), v), (n, 1)) for v in ([0.0, 0.0, GRAVITY], EARTH))
    return Samples.make(np.arange(n) / RATE, f, np.zeros((n, 3)), m_s=m)


def errors(found: Floats, truth: Floats) -> tuple[Floats, Floats]:
    """Tilt and heading error, degrees."""
    off = quaternion.multiply(found, quaternion.conjugate(truth))
    heading = 2 * np.arctan2(off[:, 3], off[:, 0])
    tilt = np.arccos(np.clip(quaternion.matrix(off)[:, 2, 2], -1, 1))
    return np.degrees(tilt), np.degrees((heading + np.pi) % (2 * np.pi) - np.pi)


def rms(values: Floats) -> float:
    return float(np.sqrt(np.mean(values[500:] ** 2)))


def assert_sound(found: Attitudes) -> None:
    np.testing.assert_allclose(np.linalg.norm(found.q_ns, axis=1), 1.0, atol=1e-9)
    assert np.isfinite(found.gyro_bias).all()


@pytest.mark.compiled
@pytest.mark.parametrize("name", FILTERS)
@pytest.mark.parametrize("disturbed", [False, True])
def test_pieces_give_what_the_whole_gives(name: str, disturbed: bool) -> None:
    samples = log_of("brisk", disturbed=disturbed).samples
    used = FILTERS[name]
    whole, at_once = used.run(samples)
    cuts = [0, 1, 2, 2, 37, 1000, 1001, 4321, len(samples)]
    state, parts = initial_state(used.params), []
    for start, stop in pairwise(cuts):
        state, part = used.advance(used.params, state, samples.slice(start, stop))
        parts.append(part)
    assert state.tobytes() == whole.tobytes()
    for pieces, column in zip(zip(*parts, strict=True), at_once, strict=True):
        np.testing.assert_array_equal(np.concatenate(pieces), column)


@pytest.mark.compiled
@pytest.mark.parametrize("name", COMPASSED)
@pytest.mark.parametrize("motion", ["level", "walk", "brisk", "violent"])
def test_the_attitude_is_found(name: str, motion: str) -> None:
    log = log_of(motion)
    tilt, heading = errors(FILTERS[name].run(log.samples)[1].q_ns, log.q_ns)
    assert rms(tilt) < 1.3
    assert rms(heading) < 2.0


@pytest.mark.parametrize("name", COMPASSED)
def test_a_disturbed_field_does_not_tilt_and_hardly_turns(name: str) -> None:
    log = log_of("walk", disturbed=True)
    tilt, heading = errors(FILTERS[name].run(log.samples)[1].q_ns, log.q_ns)
    assert rms(tilt) < 1.3
    assert rms(heading) < 4.0


def test_the_linear_filter_finds_the_tilt_near_the_level() -> None:
    log = log_of("level")
    tilt, _ = errors(FILTERS["linear"].run(log.samples)[1].q_ns, log.q_ns)
    assert rms(tilt) < 1.3


@pytest.mark.parametrize("name", COMPASSED)
def test_the_bias_of_the_gyroscope_is_found(name: str) -> None:
    log = log_of("walk")
    found = FILTERS[name].run(log.samples)[1].gyro_bias[-1]
    assert np.degrees(np.linalg.norm(found - log.gyro_bias)) < 0.15


@pytest.mark.parametrize("name", COMPASSED)
@pytest.mark.parametrize("v", HURTING)
def test_there_is_no_transient_from_any_attitude(name: str, v: list[float]) -> None:
    q_ns = quaternion.from_rotation_vector(v)
    found = FILTERS[name].run(still(q_ns))[1].q_ns
    assert np.degrees(quaternion.angle_between(found, q_ns)).max() < 1e-3


@pytest.mark.parametrize("name", COMPASSED)
def test_a_wrong_start_is_put_right(name: str) -> None:
    """The first reading is of a push: the attitude is then as far off as it can be thrown."""
    samples = still(quaternion.from_angles(0.2, 0.1, 2.0), 60.0)
    samples.f_s[0] = [9.0, 0.0, 4.0]
    found = FILTERS[name].run(samples)[1].q_ns
    assert np.degrees(quaternion.angle_between(found[0], found[-1])) > 30
    assert np.degrees(quaternion.angle_between(found[-1], quaternion.from_angles(0.2, 0.1, 2.0))) < 1.0


@pytest.mark.parametrize("name", FILTERS)
def test_without_magnetometer_heading_is_relative_to_the_start(name: str) -> None:
    log = log_of("brisk", magnetometer=False)
    state, found = FILTERS[name].run(log.samples)
    assert not has_compass(state)
    assert abs(quaternion.angles(found.q_ns[0])[2]) < 1e-12
    _, heading = errors(found.q_ns, log.q_ns)
    turned = np.abs(heading - heading[0])
    assert turned[:300].max() < 2.0
    assert_sound(found)


@pytest.mark.parametrize("name", COMPASSED)
def test_without_magnetometer_the_tilt_is_found_all_the_same(name: str) -> None:
    log = log_of("walk", magnetometer=False)
    tilt, _ = errors(FILTERS[name].run(log.samples)[1].q_ns, log.q_ns)
    assert rms(tilt) < 1.3


@pytest.mark.compiled
def test_rows_without_a_field_are_as_no_magnetometer() -> None:
    log = log_of("walk", magnetometer=False)
    rows = replace(log.samples, m_s=np.full((len(log.samples), 3), np.nan))
    for name in FILTERS:
        np.testing.assert_array_equal(FILTERS[name].run(rows)[1].q_ns, FILTERS[name].run(log.samples)[1].q_ns)


@pytest.mark.compiled
@pytest.mark.parametrize("name", FILTERS)
def test_nothing_makes_it_lose_a_rotation(name: str) -> None:
    """Gaps, repeated times, missing and absurd readings, free fall, in a log that is otherwise sound."""
    rng = np.random.default_rng(5)
    samples = log_of("violent").samples
    n = len(samples)
    t, f, w, m, p = (np.array(x) for x in (samples.t, samples.f_s, samples.w_s, samples.m_s, samples.pressure))
    t += np.cumsum(np.where(rng.random(n) < 0.002, rng.exponential(3.0, n), 0.0))
    t[1000:1010] = t[1000]
    for values, odd in ((f, [0.0, 1e-200, 1e160]), (w, [np.nan, np.inf, -1e300]), (m, [np.nan, 0.0, 1e200, -np.inf])):
        rows = np.flatnonzero(rng.random(n) < 0.02)
        values[rows] = rng.choice(odd, (rows.size, 3))
    w[2000:2500] = np.nan
    f[3000:3300] = 0.0
    p[rng.random(n) < 0.1] = np.nan
    found = FILTERS[name].run(Samples.make(t, f, w, m_s=m, pressure=p))[1]
    assert_sound(found)
    assert np.isfinite(found.altitude[10:]).all()


@pytest.mark.parametrize("name", COMPASSED)
def test_after_a_gap_the_attitude_is_found_anew(name: str) -> None:
    before, after = (quaternion.from_angles(*a) for a in ((0.0, 0.0, 0.0), (0.5, -0.3, 2.0)))
    first, second = still(before), still(after)
    used = FILTERS[name]
    state, _ = used.run(first)
    _, found = used.advance(used.params, state, replace(second, t=second.t + 60.0))
    assert np.degrees(quaternion.angle_between(found.q_ns, after)).max() < 0.1


@pytest.mark.parametrize("name", COMPASSED)
def test_in_free_fall_the_gyroscope_carries_on(name: str) -> None:
    log = simulate(MargScenario("violent", 30.0, 2, magnetometer=False))
    falling = np.array(log.samples.f_s)
    falling[2000:2200] = 0.02 * np.random.default_rng(0).normal(size=(200, 3))
    found = FILTERS[name].run(replace(log.samples, f_s=falling))[1].q_ns
    tilt, _ = errors(found, log.q_ns)
    assert tilt[2000:2400].max() < tilt[1900:2000].max() + 2.0


@pytest.mark.parametrize("name", COMPASSED)
def test_a_vertical_field_gives_no_heading(name: str) -> None:
    samples = still(np.array([1.0, 0.0, 0.0, 0.0]))
    state, found = FILTERS[name].run(replace(samples, m_s=np.tile([0.1, 0.1, -48.0], (len(samples), 1))))
    assert not has_compass(state)
    assert np.degrees(quaternion.angle_between(found.q_ns, [1.0, 0.0, 0.0, 0.0])).max() < 1e-3


@pytest.mark.compiled
@pytest.mark.parametrize("name", COMPASSED)
def test_another_field_is_believed_after_a_while(name: str) -> None:
    """A device that is carried into another place: heading holds, then goes over to the field that is there."""
    samples = still(np.array([1.0, 0.0, 0.0, 0.0]), 200.0)
    assert samples.m_s is not None
    samples.m_s[2000:] = 1.4 * quaternion.rotate(quaternion.from_rotation_vector([0.0, 0.0, 0.5]), EARTH)
    found = FILTERS[name].run(samples)[1]
    yaw = quaternion.all_angles(found.q_ns)[:, 2]
    patience = int(DEFAULT.field_patience * RATE)
    assert np.abs(yaw[: 2000 + patience - 100]).max() < 0.02
    assert abs(yaw[-1] + 0.5) < 0.05
    assert not found.field_trusted[2100 : 2000 + patience - 100].any()


@pytest.mark.compiled
def test_the_gyroscope_alone_drifts_as_in_figure_12_and_the_filters_do_not() -> None:
    """003 fig. 12: at rest, 0.07 deg/s of bias over 150 s is 10 deg."""
    log = simulate(MargScenario("rest", 150.0, gyro_bias=np.radians(0.07 / np.sqrt(3))))
    drift = {
        name: np.degrees(quaternion.angle_between(used.run(log.samples)[1].q_ns[-1], log.q_ns[-1]))
        for name, used in FILTERS.items()
    }
    assert drift["gyro"] == pytest.approx(10.5, abs=0.5)
    for name in COMPASSED:
        assert drift[name] < 0.5


@pytest.mark.parametrize("name", ["ekf", "quest-ekf"])
def test_sigma_is_honest_at_rest_and_grows_where_shaken(name: str) -> None:
    found = FILTERS[name].run(log_of("violent").samples)[1]
    assert np.isfinite(found.sigma).all()
    assert found.sigma[2000:, :2].mean() > 2 * found.sigma[350:400, :2].mean()


def test_filters_without_a_covariance_tell_no_sigma() -> None:
    assert np.isnan(FILTERS["madgwick"].run(log_of("walk").samples)[1].sigma).all()


@pytest.mark.parametrize("name", FILTERS)
def test_the_altitude_is_that_of_the_barometer(name: str) -> None:
    log = log_of("walk")
    found = FILTERS[name].run(log.samples)[1].altitude
    assert np.sqrt(np.mean((found - log.altitude)[200:] ** 2)) < 0.15


def test_a_state_is_not_changed_by_going_on_from_it() -> None:
    used, samples = FILTERS["ekf"], log_of("walk").samples
    state, _ = used.advance(used.params, initial_state(used.params), samples.slice(0, 500))
    before = state.tobytes()
    used.advance(used.params, state, samples.slice(500, 1000))
    assert state.tobytes() == before
