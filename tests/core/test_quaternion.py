"""Rotations sampled where they hurt: near the identity, near half a turn, with the nose straight up or down."""

from math import pi, radians

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from core import quaternion

Floats = NDArray[np.float64]

settings.register_profile("unhurried", deadline=None)  # a busy machine is no failure
settings.load_profile("unhurried")

TIGHT = 1e-9
AXES = st.one_of(
    st.sampled_from([tuple(sign * row) for row in np.eye(3) for sign in (1.0, -1.0)]),
    st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda v: float(np.linalg.norm(v)) > 0.1),
)
ANGLES = st.one_of(
    st.sampled_from([0.0, 1e-300, 1e-15, 1e-9, 1e-4, pi / 2, pi - 1e-4, pi - 1e-9, pi]),
    st.floats(0.0, pi),
)
VECTORS = st.tuples(*[st.floats(-100, 100)] * 3).map(np.array)
SIGNS = st.sampled_from([1.0, -1.0])


@st.composite
def rotation_vectors(draw: st.DrawFn) -> Floats:
    axis = np.array(draw(AXES))
    return draw(ANGLES) * axis / np.linalg.norm(axis)


@st.composite
def quaternions(draw: st.DrawFn) -> Floats:
    """Quaternions of either sign: q and -q are the same rotation."""
    v = draw(rotation_vectors())
    angle = float(np.linalg.norm(v))
    axis = v / angle if angle > 0 else np.array([1.0, 0, 0])
    return draw(SIGNS) * np.concatenate([[np.cos(angle / 2)], np.sin(angle / 2) * axis])


def scipy(q: Floats) -> Rotation:
    return Rotation.from_quat(q, scalar_first=True)


def same_rotation(q: Floats, p: Floats, within: float = TIGHT) -> bool:
    return float(min(np.max(np.abs(q - p)), np.max(np.abs(q + p)))) < within


@given(quaternions())
def test_matrix_is_scipys(q: Floats) -> None:
    np.testing.assert_allclose(quaternion.matrix(q), scipy(q).as_matrix(), atol=TIGHT)


@given(quaternions(), quaternions())
def test_product_is_scipys_and_of_matrices(q: Floats, p: Floats) -> None:
    qp = quaternion.multiply(q, p)
    assert same_rotation(qp, (scipy(q) * scipy(p)).as_quat(scalar_first=True))
    np.testing.assert_allclose(quaternion.matrix(qp), quaternion.matrix(q) @ quaternion.matrix(p), atol=TIGHT)


@given(quaternions(), VECTORS)
def test_rotate_turns_as_the_matrix_does(q: Floats, v: Floats) -> None:
    np.testing.assert_allclose(quaternion.rotate(q, v), scipy(q).apply(v), atol=1e-7)


@given(quaternions())
def test_conjugate_turns_back(q: Floats) -> None:
    assert same_rotation(quaternion.multiply(q, quaternion.conjugate(q)), np.array([1.0, 0, 0, 0]))
    np.testing.assert_allclose(quaternion.matrix(quaternion.conjugate(q)), quaternion.matrix(q).T, atol=TIGHT)


@given(quaternions())
def test_from_matrix_gives_the_quaternion_back(q: Floats) -> None:
    back = quaternion.from_matrix(quaternion.matrix(q))
    assert same_rotation(back, q, 1e-7)
    assert back[0] >= 0
    assert np.linalg.norm(back) == pytest.approx(1)


@given(quaternions(), st.floats(1e-3, 1e3))
def test_normalise_keeps_the_rotation(q: Floats, length: float) -> None:
    unit = quaternion.normalise(length * q)
    assert np.linalg.norm(unit) == pytest.approx(1)
    assert unit[0] >= 0
    assert same_rotation(unit, q)


@given(rotation_vectors())
def test_rotation_vector_is_scipys_and_comes_back(v: Floats) -> None:
    q = quaternion.from_rotation_vector(v)
    assert same_rotation(q, Rotation.from_rotvec(v).as_quat(scalar_first=True))
    back = quaternion.rotation_vector(q)
    if np.linalg.norm(v) > pi - 1e-6:  # v and -v are nearly the same rotation here
        assert min(np.linalg.norm(back - v), np.linalg.norm(back + v)) < 1e-5
    else:
        np.testing.assert_allclose(back, v, rtol=1e-7, atol=1e-15)


@given(rotation_vectors())
def test_rotation_vector_of_a_small_rotation_keeps_its_digits(v: Floats) -> None:
    small = 1e-8 * v
    back = quaternion.rotation_vector(quaternion.from_rotation_vector(small))
    np.testing.assert_allclose(back, small, rtol=1e-9, atol=1e-300)


@given(quaternions(), quaternions(), SIGNS)
def test_angle_between_is_scipys_and_does_not_care_for_signs(q: Floats, p: Floats, sign: float) -> None:
    angle = quaternion.angle_between(sign * q, p)
    assert angle == pytest.approx((scipy(q) * scipy(p).inv()).magnitude(), abs=1e-7)
    assert 0 <= angle <= pi + TIGHT


@given(quaternions(), rotation_vectors())
def test_angle_between_is_the_angle_turned(q: Floats, v: Floats) -> None:
    turned = quaternion.multiply(quaternion.from_rotation_vector(v), q)
    assert quaternion.angle_between(turned, q) == pytest.approx(np.linalg.norm(v), abs=1e-7)


HURTING_ANGLES = st.one_of(st.sampled_from([0.0, pi / 2, -pi / 2, pi - 1e-9, -pi + 1e-9, 1e-9]), st.floats(-pi, pi))
PITCHES = st.one_of(
    st.sampled_from([0.0, 1e-9, radians(89.999), radians(-89.999), pi / 2 - 1e-5, pi / 2, -pi / 2]),
    st.floats(-pi / 2, pi / 2),
)


@given(HURTING_ANGLES, PITCHES, HURTING_ANGLES)
def test_angles_are_intrinsic_yaw_pitch_roll(roll: float, pitch: float, yaw: float) -> None:
    q = quaternion.from_angles(roll, pitch, yaw)
    assert same_rotation(q, Rotation.from_euler("ZYX", [yaw, pitch, roll]).as_quat(scalar_first=True))


@given(HURTING_ANGLES, PITCHES, HURTING_ANGLES)
def test_angles_give_the_same_rotation_back(roll: float, pitch: float, yaw: float) -> None:
    q = quaternion.from_angles(roll, pitch, yaw)
    assert quaternion.angle_between(quaternion.from_angles(*quaternion.angles(q)), q) < 3e-6


@given(quaternions())
def test_angles_of_any_rotation_are_in_range_and_true(q: Floats) -> None:
    roll, pitch, yaw = quaternion.angles(q)
    assert -pi <= roll <= pi
    assert -pi / 2 <= pitch <= pi / 2
    assert -pi <= yaw <= pi
    assert quaternion.angle_between(quaternion.from_angles(roll, pitch, yaw), q) < 3e-6


@given(
    st.lists(
        st.one_of(quaternions(), st.tuples(HURTING_ANGLES, PITCHES).map(lambda a: quaternion.from_angles(*a, 0.3)))
    )
)
def test_angles_of_many_rotations_are_those_of_each(several: list[Floats]) -> None:
    each = np.array([quaternion.angles(q) for q in several]).reshape(-1, 3)
    np.testing.assert_allclose(quaternion.all_angles(several), each, rtol=0, atol=1e-12)


@pytest.mark.parametrize("pitch", [pi / 2, -pi / 2])
@pytest.mark.parametrize(("roll", "yaw"), [(0.3, 0.0), (0.0, -1.2), (0.7, 0.9), (3.0, 3.0)])
def test_straight_up_or_down_roll_is_zero_and_the_rotation_true(roll: float, yaw: float, pitch: float) -> None:
    q = quaternion.from_angles(roll, pitch, yaw)
    told_roll, told_pitch, _ = told = quaternion.angles(q)
    assert told_roll == 0
    assert told_pitch == pytest.approx(pitch, abs=1e-7)
    assert quaternion.angle_between(quaternion.from_angles(*told), q) < 1e-6


@pytest.mark.parametrize(
    ("angles", "forward", "left", "up"),
    [
        ((0, 0, 90), [0, 1, 0], [-1, 0, 0], [0, 0, 1]),  # yaw to the left
        ((0, 90, 0), [0, 0, -1], [0, 1, 0], [1, 0, 0]),  # pitch: nose down
        ((90, 0, 0), [1, 0, 0], [0, 0, 1], [0, -1, 0]),  # roll: left side up
    ],
)
def test_signs_of_iso_8855(angles: tuple[float, ...], forward: list[int], left: list[int], up: list[int]) -> None:
    q = quaternion.from_angles(*np.radians(angles))
    np.testing.assert_allclose(quaternion.rotate(q, np.eye(3)), [forward, left, up], atol=TIGHT)


@given(st.lists(quaternions(), min_size=1, max_size=5), VECTORS)
def test_many_rotations_at_once_are_each_alone(qs: list[Floats], v: Floats) -> None:
    stack, first = np.array(qs), qs[0]
    for function in (quaternion.normalise, quaternion.conjugate, quaternion.matrix, quaternion.rotation_vector):
        np.testing.assert_array_equal(function(stack), [function(q) for q in qs])
    np.testing.assert_array_equal(quaternion.multiply(stack, first), [quaternion.multiply(q, first) for q in qs])
    np.testing.assert_allclose(quaternion.rotate(stack, v), [quaternion.rotate(q, v) for q in qs], atol=TIGHT)
    np.testing.assert_array_equal(
        quaternion.angle_between(stack, first), [quaternion.angle_between(q, first) for q in qs]
    )


def test_random_rotations_are_uniform() -> None:
    q = quaternion.random(np.random.default_rng(1), 20_000)
    np.testing.assert_allclose(np.linalg.norm(q, axis=1), 1)
    assert np.all(q[:, 0] >= 0)
    turned = quaternion.rotate(q, [1.0, 0, 0])
    np.testing.assert_allclose(turned.mean(axis=0), 0, atol=0.02)
    np.testing.assert_allclose(np.cov(turned.T), np.eye(3) / 3, atol=0.02)
    angle = quaternion.angle_between(q, np.array([1.0, 0, 0, 0]))
    assert angle.mean() == pytest.approx(pi / 2 + 2 / pi, abs=0.02)  # density (1 - cos) / pi on [0, pi]


def test_one_random_rotation_is_one_quaternion() -> None:
    assert quaternion.random(np.random.default_rng(1)).shape == (4,)
