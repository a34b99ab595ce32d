"""The formulas as implemented, against finite differences, definitions and plain numpy."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from core import quaternion
from core.attitude import DEFAULT, _kernel, initial_state
from core.attitude.params import as_record

Floats = NDArray[np.float64]
P = as_record(DEFAULT)[0]
AXES = np.eye(3)
RNG = np.random.default_rng(7)
HURTING = [
    quaternion.from_rotation_vector(v)
    for v in (
        [0.0, 0.0, 0.0],
        [1e-9, 0.0, 0.0],
        [np.pi - 1e-7, 0.0, 0.0],
        [0.0, np.pi / 2, 0.0],
        [0.0, -np.pi / 2, 0.0],
    )
]
ROTATIONS = [*HURTING, *quaternion.random(RNG, 8)]


def scratch() -> Floats:
    return np.zeros(_kernel.SCRATCH)


def differences(function: Callable[[Floats], Floats], x: Floats, h: float = 1e-6) -> Floats:
    """Central differences, a column for each element of x."""
    steps = h * np.eye(x.size)
    return np.stack([(function(x + step) - function(x - step)) / (2 * h) for step in steps], axis=-1)


def state_at(q: Floats) -> np.void:
    state = initial_state(DEFAULT)
    state["q"] = q
    record: np.void = state[0]
    return record


@pytest.mark.parametrize("q", ROTATIONS)
def test_vectors_are_turned_as_by_the_matrix(q: Floats) -> None:
    v, out = RNG.normal(size=3), np.empty(3)
    _kernel.into_level(q, v, out)
    np.testing.assert_allclose(out, quaternion.matrix(q) @ v, atol=1e-14)
    _kernel.into_sensor(q, v, out)
    np.testing.assert_allclose(out, quaternion.matrix(q).T @ v, atol=1e-14)


@pytest.mark.parametrize("angle", [0.0, 1e-12, 1e-4, 9.99e-5, 1.0, np.pi, 6.0])
def test_rotation_vectors_and_angles(angle: float) -> None:
    v, out = angle * np.array([0.48, -0.6, 0.64]), np.empty(4)
    _kernel.rotation(v[0], v[1], v[2], out)
    np.testing.assert_allclose(out, quaternion.from_rotation_vector(v), atol=1e-15)
    _kernel.from_angles(0.3, -0.2, angle, out)
    np.testing.assert_allclose(quaternion.normalise(out), quaternion.from_angles(0.3, -0.2, angle), atol=1e-15)


@pytest.mark.parametrize("q", ROTATIONS)
def test_jacobian_of_the_specific_force(q: Floats) -> None:
    def rows(x: Floats) -> Floats:
        return np.array([_kernel.gravity_row(x, row, np.empty(7)) for row in range(3)])

    np.testing.assert_allclose(rows(q), quaternion.matrix(q).T @ AXES[2], atol=1e-14)
    wanted, h = differences(rows, q), np.empty(7)
    for row in range(3):
        _kernel.gravity_row(q, row, h)
        np.testing.assert_allclose(h, [*wanted[row], 0.0, 0.0, 0.0], atol=1e-8)


@pytest.mark.parametrize("q", ROTATIONS)
@pytest.mark.parametrize("dip", [-1.3, 0.0, 1.1])
def test_jacobian_of_the_heading_of_the_field(q: Floats, dip: float) -> None:
    """A small rotation of the attitude changes the heading error the field tells of by the row times its quaternion."""
    field = np.array([0.0, np.cos(dip), -np.sin(dip)])

    def heading(turn: Floats) -> Floats:
        state = state_at(quaternion.multiply(quaternion.from_rotation_vector(turn), q))
        state["field"] = 48.0 * quaternion.rotate(quaternion.conjugate(q), field)
        return np.array([_kernel.field_row(state, np.empty(3), np.empty(7))])

    state, h = state_at(q), np.empty(7)
    state["field"] = 48.0 * quaternion.rotate(quaternion.conjugate(q), field)
    assert abs(_kernel.field_row(state, np.empty(3), h)) < 1e-12
    turns = [0.5 * quaternion.multiply([0.0, *axis], q) for axis in AXES]
    np.testing.assert_allclose([h[:4] @ turn for turn in turns], -differences(heading, np.zeros(3))[0], atol=1e-7)


@pytest.mark.parametrize("q", ROTATIONS)
def test_gradient_of_madgwick(q: Floats) -> None:
    """003 eq. 28-30: gradient of half the square of R(q)'d - v, the diagonal of R as there, 1 - 2 (y^2 + z^2)."""
    d, v = (x / np.linalg.norm(x) for x in RNG.normal(size=(2, 3)))

    def half_square(x: Floats) -> Floats:
        f = quaternion.matrix(x).T @ d - v
        return np.array([0.5 * f @ f])

    out = np.empty(4)
    _kernel.gradient(q, d, v, out)
    np.testing.assert_allclose(out, differences(half_square, q)[0], atol=1e-8)


@pytest.mark.parametrize("q", ROTATIONS)
def test_covariance_follows_the_jacobian_of_the_prediction(q: Floats) -> None:
    """001 eq. 6.15 and 6.16, both for the exact rotation."""
    T, w = 0.02, np.array([0.1, -0.2, 0.3])

    def predicted(x: Floats) -> Floats:
        turned = quaternion.multiply(x[:4], quaternion.from_rotation_vector((w - x[4:]) * T))
        return np.concatenate([turned, x[4:]])

    root = 0.01 * RNG.normal(size=(7, 7))
    before = root @ root.T
    F = differences(predicted, np.concatenate([q, np.zeros(3)]))
    state = state_at(predicted(np.concatenate([q, np.zeros(3)]))[:4])
    state["covariance"], state["pending"] = before, T
    state["turned"] = quaternion.from_rotation_vector(w * T)
    _kernel.predict(P, state, scratch())
    noise = np.zeros((7, 7))
    Xi = np.stack([0.5 * quaternion.multiply(state["q"], [0.0, *axis]) for axis in AXES], axis=-1)
    noise[:4, :4] = DEFAULT.rate_noise**2 * T * Xi @ Xi.T
    noise[4:, 4:] = DEFAULT.bias_walk**2 * T * np.eye(3)
    after = state["covariance"]
    np.testing.assert_allclose(after, after.T, atol=1e-18)
    np.testing.assert_allclose(after, F @ before @ F.T + noise, atol=1e-7)


def davenport(w: Floats, v: Floats, weights: Floats) -> Floats:
    """Attitude of Wahba's problem by its definition: eigenvector of the largest eigenvalue, here of R(q) w = v."""
    B = sum(a * np.outer(x, y) for a, x, y in zip(weights, v, w, strict=True))
    assert isinstance(B, np.ndarray)
    z = np.array([B[2, 1] - B[1, 2], B[0, 2] - B[2, 0], B[1, 0] - B[0, 1]])
    K = np.block([[np.array([[np.trace(B)]]), z[None, :]], [z[:, None], B + B.T - np.trace(B) * np.eye(3)]])
    return quaternion.normalise(np.linalg.eigh(K)[1][:, -1])


@pytest.mark.parametrize("q", ROTATIONS)
@pytest.mark.parametrize("off", [0.01, 1.0, 3.0])
def test_quest_solves_wahbas_problem(q: Floats, off: float) -> None:
    """From any attitude at hand, `off` rad away, QUEST finds what the eigenvector of Davenport's matrix is."""
    dip, tilt, heading = 0.9, 0.01, 0.03
    v = np.array([[0.0, 0.0, 1.0], [0.0, np.sqrt(1 - dip**2), -dip]])
    w = quaternion.rotate(quaternion.conjugate(q), v) + 0.02 * RNG.normal(size=(2, 3))
    w /= np.linalg.norm(w, axis=1, keepdims=True)
    hand = quaternion.multiply(q, quaternion.from_rotation_vector([0.0, off * 0.6, off * 0.8]))
    state = state_at(hand)
    state["mean_force"], state["field"], state["field_dip"] = 9.81 * w[0], 48.0 * w[1], dip
    out = np.empty(4)
    assert _kernel.quest(P, state, scratch(), 9.81, True, tilt, heading, out)
    wanted = davenport(w, v, np.array([heading, tilt]) / (tilt + heading))
    assert quaternion.angle_between(quaternion.multiply(hand, out), wanted) < 1e-6


def test_a_measurement_makes_the_covariance_that_of_the_joseph_form() -> None:
    state = state_at(quaternion.random(RNG))
    root = 0.01 * RNG.normal(size=(7, 7))
    before, h, variance = root @ root.T, RNG.normal(size=7), 1e-3
    state["covariance"] = before
    x = np.concatenate([state["q"], state["bias"]])
    _kernel.update(state, h, 0.01, variance, scratch())
    K = before @ h / (h @ before @ h + variance)
    left = np.eye(7) - np.outer(K, h)
    np.testing.assert_allclose(state["covariance"], left @ before @ left.T + variance * np.outer(K, K), atol=1e-15)
    np.testing.assert_allclose(np.concatenate([state["q"], state["bias"]]), x + 0.01 * K, atol=1e-15)
