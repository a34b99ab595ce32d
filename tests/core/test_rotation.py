"""The whole answer turns with the log: how the device's axes happen to lie in the vehicle must not matter."""

from functools import cache

import numpy as np
import pytest

from core import Outcome
from core.quaternion import angle_between, conjugate, from_rotation_vector, multiply, random
from tests.core.drives import Floats, drive, result, run, turned

pytestmark = pytest.mark.compiled

DEGREE = np.pi / 180
X, Y, Z = np.eye(3)
OBLIQUE = np.array([0.36, -0.48, 0.8])
ABOUT_AXES = [
    (angle, axis) for angle, axis in ((89.9, X), (90.0, Y), (90.0, Z), (179.9, Y), (180.0, X), (180.0, Y), (180.0, Z))
]
ABOUT_OBLIQUE = [(angle, OBLIQUE) for angle in (0.01, 89.9, 179.9, 180.0)]
ROTATIONS = [from_rotation_vector(angle * DEGREE * axis) for angle, axis in ABOUT_AXES + ABOUT_OBLIQUE]
ROTATIONS += list(random(np.random.default_rng(77), 9))


@cache
def turned_result(name: str, i: int) -> Outcome:
    return run(turned(drive(name).samples, ROTATIONS[i]))[1]


def expected(q_vs: Floats, i: int) -> Floats:
    """A sensor turned by q reads f_q = R(q) f_s, so that f_v = R(q_vs q*) f_q."""
    return multiply(q_vs, conjugate(ROTATIONS[i]))


@pytest.mark.parametrize("i", range(len(ROTATIONS)))
@pytest.mark.parametrize("name", ["city", "city without gyro"])
def test_the_whole_answer_turns_with_the_log(name: str, i: int) -> None:
    plain, moved = result(name)[1], turned_result(name, i)

    np.testing.assert_array_equal(moved.estimates.t, plain.estimates.t)
    assert angle_between(moved.estimates.quaternion, expected(plain.estimates.quaternion, i)).max() < 0.05 * DEGREE
    np.testing.assert_allclose(moved.estimates.sigma, plain.estimates.sigma, rtol=0.01)
    np.testing.assert_array_equal(moved.estimates.stage, plain.estimates.stage)
    np.testing.assert_array_equal(moved.estimates.needs, plain.estimates.needs)
    np.testing.assert_allclose(moved.estimates.progress, plain.estimates.progress, atol=0.01)
    assert np.all(moved.estimates.quaternion[:, 0] >= 0)

    assert [event.kind for event in moved.events] == [event.kind for event in plain.events]
    for event, before in zip(moved.events, plain.events, strict=True):
        assert event.t == before.t
        assert event.quaternion is not None
        assert before.quaternion is not None
        assert angle_between(event.quaternion, expected(before.quaternion, i)) < 0.05 * DEGREE
        assert event.sigma == pytest.approx(before.sigma, rel=0.01)

    assert moved.status.mount is not None
    assert plain.status.mount is not None
    mount = plain.status.mount.quaternion
    assert angle_between(moved.status.mount.quaternion, expected(mount, i)) < 0.05 * DEGREE
