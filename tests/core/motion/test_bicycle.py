import numpy as np
import pytest

from core.motion import VEHICLES
from core.motion._kernel import axle_force, axle_slip, linearise, single_track
from core.motion.bicycle import Coefficients, coefficients
from core.motion.vehicle import Vehicle, as_record

STATES = [
    (20.0, 0.0, 0.0, 0.0),
    (15.0, -0.3, 0.3, 0.8),
    (25.0, 0.8, -0.25, -0.9),
    (8.0, 0.4, 0.7, 3.0),
    (20, 1.5, 0, 0),
]


def rates(c: Vehicle, u: float, v: float, r: float, steer: float) -> np.ndarray:
    """d(v, r)/dt of the model that is not linearised."""
    force, moment, _, _ = single_track(as_record(c)[0], u, v, r, steer / c.steering_ratio)
    return np.array([force - u * r, moment])


def of_linear_form(k: Coefficients, u: float, v: float, r: float, steer: float) -> np.ndarray:
    return np.array(
        [
            k.q2 * v + k.r2 * r + k.u2 * u + k.d2 * steer + k.k2,
            k.q3 * v + k.r3 * r + k.u3 * u + k.d3 * steer + k.k3,
        ]
    )


@pytest.mark.parametrize("name", ["sedan", "truck"])
@pytest.mark.parametrize("state", STATES)
def test_coefficients_are_the_derivatives_of_the_model(name: str, state: tuple[float, float, float, float]) -> None:
    c, x = VEHICLES[name], np.array(state, float)
    k = coefficients(c, *state)
    analytic = np.array([[k.u2, k.u3], [k.q2, k.q3], [k.r2, k.r3], [k.d2, k.d3]])
    for row, h in zip(range(4), np.eye(4) * 1e-6, strict=True):
        numeric = (rates(c, *(x + h)) - rates(c, *(x - h))) / 2e-6
        np.testing.assert_allclose(analytic[row], numeric, rtol=1e-4, atol=1e-4)


@pytest.mark.parametrize("state", STATES)
def test_the_linear_form_is_exact_where_it_was_taken(state: tuple[float, float, float, float]) -> None:
    c = VEHICLES["sedan"]
    np.testing.assert_allclose(of_linear_form(coefficients(c, *state), *state), rates(c, *state), atol=1e-9)


def test_small_angles_give_the_textbook_coefficients() -> None:
    c, u = VEHICLES["sedan"], 20.0
    k = coefficients(c, u, 0.0, 0.0, 0.0)
    c1, c2 = c.cornering_stiffness_1, c.cornering_stiffness_2
    assert k.q2 == pytest.approx(-(c1 + c2) / (c.mass * u))
    assert k.r3 == pytest.approx(-(c.a1**2 * c1 + c.a2**2 * c2) / (c.yaw_inertia * u))
    assert k.r2 == pytest.approx(-(c.a1 * c1 - c.a2 * c2) / (c.mass * u) - u)
    assert (k.u2, k.u3, k.k2, k.k3) == (0.0, 0.0, 0.0, 0.0)


def test_tyres_saturate_and_the_slip_is_found_back() -> None:
    for slip in (-0.2, -0.05, 0.0, 0.01, 0.1):
        force, slope = axle_force(slip, 1e5, 6e3)
        assert abs(force) <= 6e3
        if abs(force) < 5.8e3:
            back, inverse = axle_slip(force, 1e5, 6e3)
            assert back == pytest.approx(slip, abs=1e-12)
            assert inverse * slope == pytest.approx(1.0)
    assert axle_force(0.5, 1e5, 6e3) == (6e3, 0.0)
    assert axle_slip(9e3, 1e5, 6e3)[0] == axle_slip(6e3, 1e5, 6e3)[0], "beyond the limit the force tells no slip"


def test_a_steady_turn_stays_steady() -> None:
    """The state for which both rates vanish is the understeer formula's yaw rate."""
    c, u, wheel = VEHICLES["sedan"], 15.0, 0.01
    out = np.empty(10)
    linearise(as_record(c)[0], u, 0.0, 0.0, 0.0, out)
    q2, q3, r2, r3, _, _, d2, d3, _, _ = out
    v, r = np.linalg.solve([[q2, r2], [q3, r3]], -np.array([d2, d3]) * wheel * c.steering_ratio)
    gradient = c.mass / c.wheelbase * (c.a2 / c.cornering_stiffness_1 - c.a1 / c.cornering_stiffness_2)
    assert r == pytest.approx(u * wheel / (c.wheelbase + gradient * u * u))
    rear = c.a2 / u - c.mass * c.a1 * u / (c.cornering_stiffness_2 * c.wheelbase)
    assert v / u == pytest.approx(rear * r)
