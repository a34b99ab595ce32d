"""The kinematic filter: prediction against equation (1), Jacobians against finite differences."""

import numpy as np
import pytest

from core import quaternion
from core.motion import DEFAULT, VEHICLES, _kernel, initial_state
from core.motion.params import as_record as params_record
from core.motion.vehicle import as_record as vehicle_record

DT = 0.02
G = np.array([0.0, 0.0, _kernel.GRAVITY])
P, C = params_record(DEFAULT)[0], vehicle_record(VEHICLES["sedan"])[0]


def a_state(seed: int) -> np.void:
    rng = np.random.default_rng(seed)
    s: np.void = initial_state()[0]
    s["q_nv"][:] = quaternion.random(rng)
    s["v_n"][:] = rng.normal(size=3) * 10
    s["place"][:] = (0.8, 0.2, 100.0)
    s["arm"][:] = rng.normal(size=3)
    s["w_v"][:] = rng.normal(size=3) * 0.3
    s["running"] = s["placed"] = True
    s["ring_t"][1] = s["t"] = 0.0
    s["ring_head"], s["ring_count"] = 0, 0
    return s


def predicted(s: np.void, w: np.ndarray, f: np.ndarray, dt: float = DT) -> tuple[np.ndarray, np.ndarray]:
    """Attitude matrix and velocity after an interval."""
    s = s.copy()
    _kernel.predict_mean(s, w, f, dt, np.empty((3, 3)))
    return quaternion.matrix(s["q_nv"]), s["v_n"].copy()


@pytest.mark.parametrize("yaw_rate", [0.0, 0.3, -0.8])
def test_on_a_plane_it_is_equation_1(yaw_rate: float) -> None:
    """u+ = u + T (ax + r v), v+ = v + T (ay - r u), to first order in T."""
    s = a_state(1)
    s["q_nv"][:] = quaternion.from_angles(0.0, 0.0, 0.7)
    before = quaternion.matrix(s["q_nv"]).T @ np.array([12.0, -5.0, 0.0])
    s["v_n"][:] = (12.0, -5.0, 0.0)
    ax, ay, dt = 1.5, -3.0, 1e-4
    r_nv, v_n = predicted(s, np.array([0.0, 0.0, yaw_rate]), np.array([ax, ay, _kernel.GRAVITY]), dt)
    change = (r_nv.T @ v_n - before) / dt
    np.testing.assert_allclose(change, [ax + yaw_rate * before[1], ay - yaw_rate * before[0], 0.0], atol=1e-3)


@pytest.mark.parametrize("seed", range(3))
def test_the_transition_is_the_derivative_of_the_prediction(seed: int) -> None:
    rng = np.random.default_rng(seed + 10)
    s = a_state(seed)
    w, dw, f = rng.normal(size=3) * 0.4, rng.normal(size=3), rng.normal(size=3) * 2 + G
    blocks, r = np.zeros((4, 3, 3)), np.empty((3, 3))
    nominal = s.copy()
    _kernel.predict_mean(nominal, w, f, DT, r)
    _kernel.transition(r, f, w, dw, True, blocks)
    r0, v0 = predicted(s, w, f)
    for k, h in enumerate(np.eye(3) * 1e-6):
        turned = s.copy()
        _kernel.turn_left(turned["q_nv"], *h)
        assert_velocity((predicted(turned, w, f)[1] - v0) / 1e-6, blocks[0][:, k])
        assert_velocity((predicted(s, w, f - h)[1] - v0) / 1e-6, blocks[1][:, k])
        r_biased, _ = predicted(s, w - h, f)
        tilt = quaternion.rotation_vector(quaternion.from_matrix(r_biased @ r0.T)) / 1e-6
        np.testing.assert_allclose(tilt, DT * blocks[3][:, k], atol=1e-4)
        if k < 2:  # an arm that is longer: less of Rivals' term remains in the force
            moved = np.zeros(3)
            _kernel.rivals(w, dw, -h, moved)
            assert_velocity((predicted(s, w, f + moved)[1] - v0) / 1e-6, blocks[2][:, k])


def assert_velocity(numeric: np.ndarray, block: np.ndarray) -> None:
    np.testing.assert_allclose(numeric, DT * block, atol=2e-5)


def test_the_covariance_is_carried_on_by_the_same_transition() -> None:
    rng = np.random.default_rng(5)
    root = rng.normal(size=(_kernel.STATES, _kernel.STATES))
    cov, blocks = root @ root.T, rng.normal(size=(4, 3, 3))
    blocks[2, :, 2] = 0.0
    f = np.eye(_kernel.STATES)
    f[0:3, 3:6] = DT * np.eye(3)
    f[3:6, 6:9], f[3:6, 12:15], f[3:6, 15:17] = DT * blocks[0], DT * blocks[1], DT * blocks[2][:, :2]
    f[6:9, 9:12] = DT * blocks[3]
    expected = f @ cov @ f.T
    _kernel.predict_covariance(cov, blocks, DT)
    np.testing.assert_allclose(cov, expected, rtol=1e-12, atol=1e-12)


def moved(s: np.void, dx: np.ndarray) -> np.void:
    s = s.copy()
    _kernel.fold(P, s, dx)
    return s


def device_velocity(s: np.void) -> np.ndarray:
    velocity: np.ndarray = s["v_n"] + quaternion.matrix(s["q_nv"]) @ np.cross(s["w_v"], s["arm"])
    return velocity


@pytest.mark.parametrize("seed", range(3))
def test_rows_of_h_are_derivatives(seed: int) -> None:
    s, h = a_state(seed), np.empty(_kernel.STATES)
    s["ring_count"] = 0
    d = np.array([0.6, 0.8, 0.0])
    r, v = quaternion.matrix(s["q_nv"]), device_velocity(s)
    _kernel.velocity_row(r, v - s["v_n"], s["w_v"], d, h)
    numeric = [(d @ device_velocity(moved(s, e)) - d @ v) / 1e-6 for e in np.eye(_kernel.STATES) * 1e-6]
    np.testing.assert_allclose(h, numeric, atol=1e-4)
    for axis in range(3):
        value = _kernel.body_row(r, s["v_n"], axis, h)
        assert value == pytest.approx((r.T @ s["v_n"])[axis])
        numeric = [(body_velocity(moved(s, e))[axis] - value) / 1e-6 for e in np.eye(_kernel.STATES) * 1e-6]
        np.testing.assert_allclose(h, numeric, atol=1e-4)


def body_velocity(s: np.void) -> np.ndarray:
    velocity: np.ndarray = quaternion.matrix(s["q_nv"]).T @ s["v_n"]
    return velocity


def test_a_scalar_update_is_that_of_the_textbook() -> None:
    rng = np.random.default_rng(3)
    root = rng.normal(size=(6, 6))
    cov, h, dx = root @ root.T, rng.normal(size=6), rng.normal(size=6)
    gain = cov @ h / (h @ cov @ h + 0.3)
    expected_dx = dx + gain * (1.7 - h @ dx)
    expected = (np.eye(6) - np.outer(gain, h)) @ cov
    _kernel.update(cov, dx, h, 1.7, 0.3)
    np.testing.assert_allclose(dx, expected_dx)
    np.testing.assert_allclose(cov, expected, atol=1e-12)


def test_a_correction_reaches_the_past() -> None:
    """What is seen of the past after a correction is what a corrected state would have seen."""
    f, w = np.array([1.0, 3.0, 9.5]), np.array([0.02, -0.01, 0.4])
    dx = np.zeros(_kernel.STATES)
    dx[:9] = (3.0, -2.0, 1.0, 0.4, -0.3, 0.1, 0.002, -0.003, 0.01)
    late, early = (driven(w, f, None), driven(w, f, dx))
    final = np.zeros(_kernel.STATES)
    final[:9] = dx[:9]
    final[0:3] += dx[3:6] * 0.5  # velocity errors have become position errors since
    final[3:6] += np.cross(dx[6:9], late["v_n"] - driven(w, f, None, 0)["v_n"] + 0.5 * G)
    _kernel.fold(P, late, final)
    for at in (0.1, 0.33):
        v1, p1, v2, p2 = (np.empty(3) for _ in range(4))
        _kernel.look_back(late, at, v1, p1)
        _kernel.look_back(early, at, v2, p2)
        np.testing.assert_allclose(v1, v2, atol=2e-4)
        np.testing.assert_allclose(p1[:2] * 6.37e6, p2[:2] * 6.37e6, atol=2e-2)


def driven(w: np.ndarray, f: np.ndarray, error: np.ndarray | None, steps: int = 25) -> np.void:
    s = a_state(4)
    s["q_nv"][:] = quaternion.from_angles(0.02, -0.03, 0.5)
    s["v_n"][:] = (10.0, 4.0, 0.0)
    s["arm"][:] = 0.0
    if error is not None:
        _kernel.fold(P, s, error)
    r = np.empty((3, 3))
    for k in range(steps + 1):
        s["t"] = k * DT
        _kernel.rotation_matrix(s["q_nv"], r)
        _kernel.keep_past(s, r)
        if k < steps:
            _kernel.predict_mean(s, w, f, DT, r)
    return s
