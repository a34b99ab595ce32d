"""The bridge between the thesis' angles and q_vs: everything docs/thesis.md says in degrees passes over it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks.reproduction.angles import Angles, error, from_thesis, to_thesis
from core import quaternion

DEGREES = st.one_of(st.sampled_from([0.0, 40.0, 90.0, -90.0, 180.0, -180.0, 89.9]), st.floats(-180, 180))


@given(DEGREES, DEGREES, DEGREES)
def test_matrix_is_the_printed_one(theta: float, phi: float, psi: float) -> None:
    (ct, cp, cs), (st_, sp, ss) = np.cos(np.radians([theta, phi, psi])), np.sin(np.radians([theta, phi, psi]))
    printed = [  # (3.9)
        [cp * ct, sp * ss - cp * cs * st_, cs * sp + cp * ss * st_],
        [st_, cs * ct, -ct * ss],
        [-ct * sp, cp * ss + cs * sp * st_, cp * cs - sp * ss * st_],
    ]
    forward_left_up = np.diag([1.0, -1.0, -1.0]) @ printed
    np.testing.assert_allclose(quaternion.matrix(from_thesis((theta, phi, psi))), forward_left_up, atol=1e-9)


@given(DEGREES, DEGREES, DEGREES)
def test_angles_mean_the_same_rotation(theta: float, phi: float, psi: float) -> None:
    angles = (theta, phi, psi)
    assert error(from_thesis(to_thesis(from_thesis(angles), angles)), from_thesis(angles)) < 1e-3


@pytest.mark.parametrize("angles", [(-180, 90, 0), (-90, 0, 40), (90, 10, -20), (0, 180, 0), (20, 10, -90)])
def test_of_two_sets_of_angles_the_nearer_is_told(angles: Angles) -> None:
    np.testing.assert_allclose(to_thesis(from_thesis(angles), angles), angles, atol=1e-6)


def test_a_device_along_the_vehicle_axes_of_the_thesis_reads_gravity_upwards() -> None:
    f_v = quaternion.rotate(from_thesis((0, 0, 0)), [0.0, 0.0, -9.81])
    np.testing.assert_allclose(f_v, [0, 0, 9.81], atol=1e-12)
