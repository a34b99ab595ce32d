import numpy as np
import pytest

from api.services.words import movement, side
from core import quaternion

ALONG = {
    (0, 0, 1): "turned 14 degrees to the left",
    (0, 0, -1): "turned 14 degrees to the right",
    (0, 1, 0): "tipped 14 degrees nose down",
    (0, -1, 0): "tipped 14 degrees nose up",
    (1, 0, 0): "leaned 14 degrees to the right",
    (-1, 0, 0): "leaned 14 degrees to the left",
    (0.2, -0.2, 0.96): "turned 14 degrees to the left",
}


@pytest.mark.parametrize("axis", ALONG)
def test_an_axis_near_one_of_the_vehicles_gives_one_verb(axis: tuple[float, float, float]) -> None:
    assert movement(np.radians(14), np.array(axis)) == ALONG[axis]
    assert movement(np.radians(-14), -np.array(axis)) == ALONG[axis], "the same rotation"


@pytest.mark.parametrize(
    ("rotation", "said"),
    [
        ((4.1, 0, 9.8), "turned 9.8 degrees to the left and leaned 4.1 degrees to the right (11 degrees in all)"),
        ((0.4, -5, 6), "turned 6.0 degrees to the left and tipped 5.0 degrees nose up (7.8 degrees in all)"),
        (
            (-30, 20, -40),
            "turned 40 degrees to the right, leaned 30 degrees to the left and tipped 20 degrees nose down "
            "(54 degrees in all)",
        ),
    ],
)
def test_a_mix_tells_each_part_and_the_whole(rotation: tuple[float, float, float], said: str) -> None:
    size = np.linalg.norm(rotation)
    assert movement(np.radians(size), np.array(rotation) / size) == said


def test_what_is_not_known_is_not_said() -> None:
    assert movement(np.radians(9.96), None) == "moved by 10 degrees"
    assert movement(np.radians(9.94), None) == "moved by 9.9 degrees"
    assert movement(None, None) == "moved"
    assert movement(None, np.array([0.0, 0.0, 1.0])) == "moved"


@pytest.mark.parametrize(
    ("axis", "arrow", "goes", "word"),
    [
        ((0, 0, 1), (1, 0, 0), (0, 1, 0), "to the left"),
        ((0, 1, 0), (1, 0, 0), (0, 0, -1), "nose down"),
        ((1, 0, 0), (0, 0, 1), (0, -1, 0), "to the right"),
    ],
)
def test_the_words_are_those_of_the_vehicle_frame(
    axis: tuple[int, int, int], arrow: tuple[int, int, int], goes: tuple[int, int, int], word: str
) -> None:
    """Turned by +90 degrees, the device's arrow (forward, up) goes where the word says: left, down, right."""
    q = np.array([np.sqrt(0.5), *(np.sqrt(0.5) * np.array(axis))])
    np.testing.assert_allclose(quaternion.matrix(q) @ arrow, goes, atol=1e-12)
    assert word in movement(np.pi / 2, np.array(axis, dtype=float))


@pytest.mark.parametrize(
    ("degrees", "said"),
    [
        *((0, "front"), (22, "front"), (38, "front left"), (90, "left"), (135, "rear left"), (180, "rear")),
        *((-180, "rear"), (-160, "rear"), (-130, "rear right"), (-90, "right"), (-23, "front right"), (-22, "front")),
    ],
)
def test_where_a_push_came_from(degrees: float, said: str) -> None:
    assert side(np.radians(degrees)) == said
