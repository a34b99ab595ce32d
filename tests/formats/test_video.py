import builtins
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

from api.formats import FormatError
from api.formats.video import FilmLimits, is_film, read_markers
from core.motion.steering_markers import from_markers

pytest.importorskip("cv2")

from benchmarks.motion_study.wheel_video import Film, Rendered, render


class Shot(NamedTuple):
    path: Path
    truth: Rendered


@pytest.fixture(scope="module")
def shot(tmp_path_factory: pytest.TempPathFactory) -> Shot:
    path = tmp_path_factory.mktemp("film") / "wheel.avi"
    return Shot(path, render(Film(seed=41, seconds=6.0, size=(480, 360), colour="green", light=0.2), path))


def test_the_angle_is_read_from_a_shaken_film_in_changing_light(shot: Shot) -> None:
    film = read_markers(shot.path)
    assert film.colour == "green"
    assert film.steadied > 0.5
    np.testing.assert_allclose(film.t, shot.truth.t, atol=0.002)
    found = from_markers(film.t, film.points).steering
    error = np.degrees(found.angle - shot.truth.angle)
    assert np.sqrt(np.nanmean(error**2)) < 1.0
    assert np.isfinite(error).mean() > 0.9


def test_progress_goes_to_the_end(shot: Shot) -> None:
    seen: list[tuple[float, float]] = []
    read_markers(shot.path, "green", seen=lambda t, total: seen.append((t, total)))
    assert len(seen) == shot.truth.t.size
    assert seen[-1][0] == pytest.approx(seen[-1][1], abs=0.1)


def test_films_are_told_by_their_content_or_name(shot: Shot, tmp_path: Path) -> None:
    renamed = tmp_path / "film.csv"
    renamed.write_bytes(shot.path.read_bytes()[:100])
    log = tmp_path / "log.csv"
    log.write_text("t,ax,ay,az\n")
    assert is_film(shot.path)
    assert is_film(renamed)
    assert is_film(tmp_path / "missing.MP4")
    assert not is_film(log)
    assert not is_film(tmp_path / "missing.csv")


def test_what_cannot_be_read(shot: Shot, tmp_path: Path) -> None:
    broken = tmp_path / "broken.avi"
    broken.write_bytes(shot.path.read_bytes()[:64])
    with pytest.raises(FormatError, match="a film"):
        read_markers(broken)
    with pytest.raises(FileNotFoundError):
        read_markers(tmp_path / "missing.avi")
    with pytest.raises(FormatError, match="at most 1000 pixels"):
        read_markers(shot.path, limits=FilmLimits(pixels=1000))
    with pytest.raises(FormatError, match="three round coloured markers"):
        read_markers(shot.path, "cyan")


def test_without_opencv_it_is_said_what_to_install(shot: Shot, monkeypatch: pytest.MonkeyPatch) -> None:
    real = builtins.__import__

    def missing(name: str, *rest: Any) -> Any:
        if name == "cv2":
            raise ImportError(name)
        return real(name, *rest)

    monkeypatch.setattr(builtins, "__import__", missing)
    with pytest.raises(FormatError, match=r"pip install 'livella\[video\]'"):
        read_markers(shot.path)
