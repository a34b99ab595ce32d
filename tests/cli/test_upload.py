"""The commands `upload` and `serve` together, both real."""

import gzip
import signal
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest

from tests.cli import livella
from tests.cli.conftest import Log
from tests.cli.test_replay import thesis_log

pytestmark = pytest.mark.slow

ADMIN = "admin-key-of-the-tests-0123456789abcdef"


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    with livella.serving(tmp_path_factory.mktemp("service"), LIVELLA_ADMIN_KEY=ADMIN) as (url, _):
        yield url


def upload(log: Path, server: str, device: str, *more: object, key: str = ADMIN) -> livella.Result:
    return livella.run("upload", log, "--server", server, "--device", device, *more, LIVELLA_KEY=key)


def installation(server: str, device: str) -> dict[str, Any]:
    url = f"{server}/api/v1/devices/{device}/installation"
    shown: dict[str, Any] = httpx.get(url, headers={"Authorization": f"Bearer {ADMIN}"}).json()
    return shown


def test_a_drive_is_sent_and_confirmed(server: str, drive: Log) -> None:
    done = upload(drive.path, server, "box-1", "--register")
    assert (done.status, done.err) == (0, "")
    assert "6 chunks sent to box-1" in done.out
    assert "stage: confirmed" in done.out
    assert "mount: roll" in done.out
    assert installation(server, "box-1")["mount"]["angles_deg"]["yaw"] == pytest.approx(100, abs=5)

    revision = installation(server, "box-1")["revision"]
    again = upload(drive.path, server, "box-1")
    assert again.status == 0
    assert "6 of them were there already" in again.out
    assert installation(server, "box-1")["revision"] == revision

    registered = livella.KEY.search(done.out)
    assert registered, "the new device's key is shown"
    own = upload(drive.path, server, "box-1", "--session", "second", "--chunk-seconds", 120, key=registered.group())
    assert own.status == 0
    assert "3 chunks" in own.out


def test_refusals(server: str, drive: Log, tmp_path: Path) -> None:
    unknown = upload(drive.path, server, "nobody")
    assert unknown.status == 1
    assert "404" in unknown.err
    stranger = upload(drive.path, server, "box-2", key="livella_wrong")
    assert stranger.status == 1
    assert "401" in stranger.err
    bad = tmp_path / "bad.csv"
    bad.write_text("t,ax,ay,az,fix,speed,course\n0,0,0,9.8,7,3,90\n")
    unreadable = upload(bad, server, "box-1")
    assert unreadable.status == 2
    assert f"{bad}: line 2, column fix: expected 1, 0 or an empty cell, found '7'" in unreadable.err


@pytest.mark.parametrize("address", ["localhost:8000", "ftp://127.0.0.1", "http://", "http://[::"])
def test_an_address_that_is_none(drive: Log, address: str) -> None:
    done = upload(drive.path, address, "box-1")
    assert done.status == 2
    assert done.err.startswith(f"{address}: ")


def test_a_thesis_log(server: str, drive: Log, tmp_path: Path) -> None:
    log = tmp_path / "log.txt"
    log.write_text(thesis_log(gzip.decompress(drive.path.read_bytes()).decode()))
    done = upload(log, server, "box-4", "--register", "--chunk-seconds", 20)
    assert done.status == 0, done.err
    assert "stage: confirmed" in done.out
    assert installation(server, "box-4")["mount"]["angles_deg"]["yaw"] == pytest.approx(100, abs=5)


def test_played_in_real_time(server: str, tmp_path: Path) -> None:
    log = tmp_path / "log.csv"
    livella.run("simulate", log, "--seconds", 9)
    begin = time.monotonic()
    done = upload(log, server, "box-3", "--register", "--chunk-seconds", 3, "--realtime", 0.6)
    assert time.monotonic() - begin > 9 / 0.6
    assert "3 chunks sent" in done.out


def test_a_device_waits_for_the_service_and_goes_on_after_a_restart(tmp_path: Path, drive: Log) -> None:
    port = livella.free_port()
    url = f"http://127.0.0.1:{port}"
    arguments = ("upload", drive.path, "--server", url, "--device", "box-1", "--register", "--realtime", 60)
    with livella.running(*arguments, log=tmp_path / "device", LIVELLA_KEY=ADMIN) as device:
        with livella.serving(tmp_path, port, LIVELLA_ADMIN_KEY=ADMIN) as (_, first):
            while not installation(url, "box-1").get("last_data_at"):
                assert device.process.poll() is None, device.output()
            assert first.end(signal.SIGTERM) in {0, -signal.SIGTERM}
        with livella.serving(tmp_path, port, LIVELLA_ADMIN_KEY=ADMIN):
            assert device.process.wait(timeout=90) == 0, device.output()
            assert installation(url, "box-1")["stage"] == "confirmed"
    assert "trying again" in device.output()
    assert "were there already" not in device.output()


def test_the_first_start_shows_an_admin_key_once(tmp_path: Path) -> None:
    with livella.serving(tmp_path) as (url, service):
        found = livella.KEY.findall(service.output())
        assert len(found) == 1
        assert url in service.output()
        bearer = {"Authorization": f"Bearer {found[0]}"}
        assert httpx.get(f"{url}/api/v1/devices", headers=bearer).status_code == 200
        assert service.end(signal.SIGINT) == 0
    with livella.serving(tmp_path) as (url, service):
        assert livella.KEY.findall(service.output()) == found
        assert httpx.get(f"{url}/api/v1/devices", headers=bearer).status_code == 200
    stored = b"".join(path.read_bytes() for path in (tmp_path / "data").iterdir())
    assert found[0].encode() not in stored


@pytest.mark.parametrize(
    ("arguments", "setting", "status", "words"),
    [
        (["--port", "99999"], {}, 2, "LIVELLA_PORT"),
        ([], {"LIVELLA_PRESET": "magic"}, 2, "LIVELLA_PRESET"),
        (["--database-url", "sqlite:////nowhere/at/all.db"], {}, 1, "database cannot be used"),
        (["--database-url", "postgresql://u:secret-word@127.0.0.1:1/x"], {}, 1, "database cannot be used"),
    ],
)
def test_serve_says_what_is_wrong(
    tmp_path: Path, arguments: list[str], setting: dict[str, str], status: int, words: str
) -> None:
    done = livella.run("serve", *arguments, "--data-dir", tmp_path, **setting)
    assert done.status == status
    assert words in done.err
    assert "secret-word" not in done.err
