import numpy as np
import pytest

from core import quaternion
from core.motion import static_start

G = 9.80665
ANGLES = [(0.0, 0.0, 0.0), (0.3, -0.2, 1.0), (3.1, 0.1, -2.0), (-1.5, 1.2, 0.5), (np.pi, 0.0, 0.0), (0.2, -1.57, 0.0)]


@pytest.mark.parametrize("angles", ANGLES)
@pytest.mark.parametrize("known", [False, True])
def test_gravity_points_up_in_the_vehicle(angles: tuple[float, float, float], known: bool) -> None:
    q_vs = quaternion.from_angles(*angles)
    f_s = quaternion.rotate(quaternion.conjugate(q_vs), [0.0, 0.0, G])
    readings = f_s + 0.05 * np.random.default_rng(1).normal(size=(500, 3))
    start = static_start(readings, q_vs if known else None)
    up = quaternion.rotate(start.q_vs, f_s)
    np.testing.assert_allclose(up, [0.0, 0.0, G], atol=0.03)
    assert start.objective < 0.01
    assert start.yaw_known is known
    assert start.reason
    np.testing.assert_allclose(quaternion.from_angles(*start.angles), start.q_vs, atol=1e-9)


def test_the_yaw_of_the_mounting_is_kept_and_its_tilt_put_right() -> None:
    truth = quaternion.from_angles(0.3, -0.2, 1.0)
    f_s = quaternion.rotate(quaternion.conjugate(truth), [0.0, 0.0, G])
    before = quaternion.from_angles(0.25, -0.16, 1.0)
    start = static_start(f_s[None], before)
    np.testing.assert_allclose(start.q_vs, truth, atol=1e-6)


def test_what_no_rotation_explains_is_told() -> None:
    assert static_start([[0.0, 0.0, G + 0.3]]).objective == pytest.approx(0.3, abs=1e-6)
