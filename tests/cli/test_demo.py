import signal
import socket
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest

from api.commands.demo_fleet import FLEET, drives, pieces
from tests.cli import livella


@pytest.fixture
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder for temporary files of this test's commands alone, because others run beside it."""
    folder = tmp_path / "temporary"
    folder.mkdir()
    monkeypatch.setenv("TMPDIR", str(folder))
    return folder


def wait_until(condition: Callable[[], bool], seconds: float = 120.0) -> None:
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.5)


@pytest.mark.slow
@pytest.mark.parametrize("ending", [signal.SIGINT, signal.SIGTERM])
def test_the_fleet_is_on_the_road_until_the_demo_is_ended(tmp_path: Path, temporary: Path, ending: int) -> None:
    port = livella.free_port()
    url = f"http://127.0.0.1:{port}"
    with livella.running("demo", "--port", port, log=tmp_path / "log") as demo:
        demo.wait_for(f"{url}/readyz")
        wait_until(lambda: livella.KEY.search(demo.output()) is not None)
        found = livella.KEY.search(demo.output())
        assert found
        assert url in demo.output()
        with httpx.Client(base_url=f"{url}/api/v1/", headers={"Authorization": f"Bearer {found.group()}"}) as client:

            def devices() -> list[dict[str, Any]]:
                listed: list[dict[str, Any]] = client.get("devices").json()["items"]
                return listed

            wait_until(lambda: {d["id"] for d in devices()} == {vehicle.device_id for vehicle in FLEET})
            wait_until(lambda: {"waiting", "confirmed"} < {d["stage"] for d in devices()})
        assert demo.end(ending) == 0, demo.output()
        assert "Traceback" not in demo.output()
    assert not list(temporary.glob("livella-demo-*"))


@pytest.mark.slow
def test_a_port_that_is_taken(temporary: Path) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        done = livella.run("demo", "--port", taken.getsockname()[1])
    assert done.status != 0
    assert "address already in use" in done.err.lower()
    assert not list(temporary.glob("livella-demo-*"))


@pytest.mark.parametrize("vehicle", FLEET, ids=lambda vehicle: vehicle.device_id)
def test_each_vehicle_drives_as_it_should(vehicle: Any) -> None:
    samples = next(drives(vehicle))
    valid = samples.fix[samples.fix_valid]
    assert samples.t[-1] == pytest.approx(vehicle.drive, abs=0.1)
    assert bool(valid.size) is not vehicle.no_fix
    if vehicle.route == "parked":
        assert valid[:, 3].max() < 1.5


def test_a_turned_device_stays_turned_in_the_next_drive() -> None:
    vehicle, turned_at = next((vehicle, vehicle.turned_at) for vehicle in FLEET if vehicle.turned_at)
    following = drives(vehicle)
    first, second = next(following), next(following)

    def gravity(samples: Any, when: Any) -> Any:
        mean = samples.f_s[when].mean(axis=0)
        return mean / np.linalg.norm(mean)

    before, after = gravity(first, first.t < turned_at), gravity(first, first.t > turned_at + 2)
    then = gravity(second, second.t < turned_at)
    assert np.degrees(np.arccos(before @ after)) > 5
    assert np.degrees(np.arccos(then @ after)) < 5


def test_pieces_are_the_drive() -> None:
    samples = next(drives(FLEET[0]))
    cut = list(pieces(samples, 7.0))
    np.testing.assert_array_equal(np.concatenate([piece.t for piece in cut]), samples.t)
    assert all(piece.t[-1] - piece.t[0] < 7 for piece in cut)
