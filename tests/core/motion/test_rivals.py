"""Rivals' formula against the second derivative of the path of a point on a tumbling body."""

import numpy as np
from scipy.spatial.transform import Rotation

from core.motion.rivals import transfer

W0, W1 = np.array([0.4, -0.7, 0.9]), np.array([-0.5, 0.3, 0.8])
D = np.array([1.3, -0.6, 0.4])


def attitude(t: float) -> np.ndarray:
    return (Rotation.from_rotvec(W0 * t) * Rotation.from_rotvec(W1 * t * t)).as_matrix()


def rate(t: float, h: float = 1e-5) -> np.ndarray:
    """Angular rate in body axes."""
    return (Rotation.from_matrix(attitude(t - h)).inv() * Rotation.from_matrix(attitude(t + h))).as_rotvec() / (2 * h)


def test_the_acceleration_of_another_point_of_a_tumbling_body() -> None:
    h = 1e-3
    for t in (0.0, 0.4, 1.1):
        second = (attitude(t + h) - 2 * attitude(t) + attitude(t - h)) @ D / h**2
        dw = (rate(t + h) - rate(t - h)) / (2 * h)
        moved = transfer(np.zeros((1, 3)), rate(t)[None], dw[None], D)[0]
        np.testing.assert_allclose(attitude(t) @ moved, second, atol=2e-4)


def test_rows_are_independent_and_there_and_back_is_nothing() -> None:
    rng = np.random.default_rng(1)
    a, w, dw = rng.normal(size=(3, 7, 3))
    there = transfer(a, w, dw, D)
    np.testing.assert_allclose(transfer(there, w, dw, -D), a, atol=1e-12)
    np.testing.assert_allclose(there[3], transfer(a[3:4], w[3:4], dw[3:4], D)[0])


def test_a_steady_turn_pulls_inwards() -> None:
    """The seed's equation (5) has this sign: a point ahead feels an acceleration backwards, -r^2 x."""
    moved = transfer(np.zeros((1, 3)), [[0.0, 0.0, 0.5]], np.zeros((1, 3)), [2.0, 0.0, 0.0])
    np.testing.assert_allclose(moved, [[-0.5, 0.0, 0.0]])
