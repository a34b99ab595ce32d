"""A slow, obvious textbook twin of the `thesis` preset, in the frames and signs of the thesis itself.

T-frame north, east, down; V-frame forward, right, down; quaternions scalar last; yaw rate and course anticlockwise
although z points down (thesis chapter 4, with the slips of its text put right). Dense matrices, all measurements at
once, Joseph form, epochs cut with numpy. The kernel works in other frames, without matrices, scalar by scalar.
"""

from dataclasses import dataclass, field

import numpy as np
import pytest
from numpy.typing import NDArray

from core import THESIS, Samples, advance, initial_state
from core._kernel import ATTITUDE, BIAS, GRAVITY, MOUNTING
from core.quaternion import matrix
from core.simulation import Scenario, simulate

Floats = NDArray[np.float64]
N_FROM_T = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
FLU_FROM_FRD = np.diag([1.0, -1.0, -1.0])


def cross(a: Floats) -> Floats:
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


def product(q: Floats, p: Floats) -> Floats:
    """(C.6) with scalar q4 and the missing p4."""
    vector = q[3] * p[:3] + p[3] * q[:3] + np.cross(q[:3], p[:3])
    return np.append(vector, q[3] * p[3] - q[:3] @ p[:3])


def rotation(q: Floats) -> Floats:
    """(C.3)."""
    x, y, z, s = q
    return np.array(
        [
            [s * s + x * x - y * y - z * z, 2 * y * x - 2 * z * s, 2 * y * s + 2 * z * x],
            [2 * z * s + 2 * x * y, s * s - x * x + y * y - z * z, 2 * z * y - 2 * x * s],
            [2 * x * z - 2 * y * s, 2 * x * s + 2 * y * z, s * s - x * x - y * y + z * z],
        ]
    )


def rodrigues(a: Floats) -> Floats:
    """(4.26)."""
    return np.append(a, 2.0) / np.sqrt(4 + a @ a)


def process_noise(period: float, v_x: float, w_z: float) -> Floats:
    """G Q G' of (4.63) and (4.66)-(4.70), table 5.1 at 0.25 s."""
    steps = period / 0.25
    q = np.zeros((9, 9))
    q[:2, :2] = 10 * np.array([[period**3 / 3, period**2 / 2], [period**2 / 2, period]])
    q[2, 2] = 5e-3 * steps
    q[3:6, 3:6] = 1e-4 * steps * np.eye(3)
    q[6:, 6:] = 0.1 * steps * np.eye(3)
    g = np.diag([1, 1, v_x, w_z, w_z, w_z, w_z, w_z, w_z])
    return g @ q @ g.T


R_V = np.diag([15.0] * 3 + [0.3] * 3 + [2.0])


@dataclass
class Twin:
    x: Floats = field(default_factory=lambda: np.zeros(3))  # v_x, a_x, w_z
    q_v: Floats = field(default_factory=lambda: np.array([0.0, 0.0, 0.0, 1.0]))
    q_a: Floats = field(default_factory=lambda: np.array([0.0, 0.0, 0.0, 1.0]))
    p: Floats = field(default_factory=lambda: process_noise(0.25, 1.0, 1.0))

    def predict(self, period: float) -> None:
        v_x, a_x, w_z = self.x
        angle = -w_z * period  # about z, which points down
        f = np.eye(9)
        f[0, 1] = period
        turn = 2 * np.arctan(angle / 2)  # what the Rodrigues vector of (4.26) turns by
        f[3:5, 3:5] = [[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]
        f[5, 2] = -period
        self.x = np.array([v_x + period * a_x, a_x, w_z])
        self.q_v = product(rodrigues(np.array([0.0, 0.0, angle])), self.q_v)
        self.p = f @ self.p @ f.T + process_noise(period, self.x[0], w_z)

    def update(self, y: Floats) -> None:
        v_x, a_x, w_z = self.x
        r_v, r_a = rotation(self.q_v), rotation(self.q_a)
        gravity = np.array([0.0, 0.0, -GRAVITY])
        u = r_v.T @ gravity + np.array([a_x, -w_z * v_x, 0.0])
        velocity = r_v @ np.array([v_x, 0.0, 0.0])
        h = np.zeros((7, 9))
        h[:3, 0] = r_a.T @ [0.0, -w_z, 0.0]
        h[:3, 1] = r_a.T @ [1.0, 0.0, 0.0]
        h[:3, 2] = r_a.T @ [0.0, -v_x, 0.0]
        h[:3, 3:6] = r_a.T @ r_v.T @ cross(gravity)
        h[:3, 6:] = r_a.T @ cross(u)
        h[3:6, 0] = r_v[:, 0]
        h[3:6, 3:6] = -cross(velocity)
        h[6, 2] = 1.0
        innovation = y - np.concatenate([r_a.T @ u, velocity, [w_z]])
        k = self.p @ h.T @ np.linalg.inv(h @ self.p @ h.T + R_V)
        dx = k @ innovation
        rest = np.eye(9) - k @ h
        self.p = rest @ self.p @ rest.T + k @ R_V @ k.T
        self.x = self.x + dx[:3]
        self.x[0] = max(self.x[0], 0.0)
        self.q_v = product(rodrigues(dx[3:6]), self.q_v)
        self.q_a = product(rodrigues(dx[6:]), self.q_a)


def epochs(samples: Samples) -> list[tuple[float, Floats, bool, float]]:
    """Period, measurements (4.62), in motion, course of each epoch, from plain arrays."""
    result = []
    rows = samples.fix_row[samples.fix_valid]
    altitude, speed, course = samples.fix[samples.fix_valid].T[2:5]
    for i in range(1, rows.size):
        inside = slice(rows[i - 1], rows[i] + 1)
        t = samples.t[inside]
        period = t[-1] - t[0]
        mean_force = np.trapezoid(samples.f_s[inside], t, axis=0) / period
        turn = np.angle(np.exp(1j * (course[i] - course[i - 1])))  # clockwise, unwrapped
        velocity = [
            speed[i] * np.cos(course[i]),
            speed[i] * np.sin(course[i]),
            -(altitude[i] - altitude[i - 1]) / period,
        ]
        y = np.concatenate([mean_force, velocity, [-turn / period]])
        result.append((period, y, min(speed[i], speed[i - 1]) >= 1.0, course[i]))
    return result


def run_twin(samples: Samples) -> Twin:
    twin, aligned = Twin(), False
    for period, y, moving, course in epochs(samples):
        if moving and not aligned:
            twin.q_v = np.array([0.0, 0.0, np.sin(course / 2), np.cos(course / 2)])
            aligned = True
        twin.predict(period)
        twin.update(y)
    return twin


@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.compiled)])
def test_kernel_agrees_with_the_textbook(seed: int) -> None:
    seconds = 120.0 if seed == 1 else 300.0
    samples = simulate(Scenario(route="city", seconds=seconds, seed=seed, imu_rate=40.0, sensor="tmd2")).samples
    twin = run_twin(samples)
    state, _ = advance(THESIS, initial_state(THESIS), samples)
    kernel = state.filter[0]

    np.testing.assert_allclose([kernel["speed"], kernel["acceleration"], kernel["yaw_rate"]], twin.x, atol=1e-9)
    np.testing.assert_allclose(matrix(kernel["q_vs"]), FLU_FROM_FRD @ rotation(twin.q_a), atol=1e-9)
    np.testing.assert_allclose(matrix(kernel["q_nv"]), N_FROM_T @ rotation(twin.q_v) @ FLU_FROM_FRD, atol=1e-9)
    to_kernel = np.zeros((9, 9))  # error vectors of the thesis frames in ours, of the attitude in the vehicle's axes
    to_kernel[:3, :3] = np.eye(3)
    to_kernel[3:6, 3:6] = matrix(kernel["q_nv"]).T @ N_FROM_T
    to_kernel[6:, 6:] = FLU_FROM_FRD
    states = np.r_[0:3, ATTITUDE : ATTITUDE + 3, MOUNTING : MOUNTING + 3]
    covariance = kernel["covariance"]
    np.testing.assert_allclose(covariance[np.ix_(states, states)], to_kernel @ twin.p @ to_kernel.T, atol=1e-9)
    assert not covariance[BIAS : BIAS + 3].any(), "the biases are no states of the thesis filter"
