"""The disk is full: uploads are put off, nothing is lost, and everything goes on when there is room again."""

import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from storage.database import Database
from tests.drives import remounted
from tests.faults import stored
from tests.postgres import Server
from tests.server import ServerProcess, running

SIZE = {"sqlite": "6m", "postgresql": "28m"}
"""of a disk on which a few uploads have room"""
LEFT_AFTER = 3
"""chunks that are sent before the disk is full"""


@pytest.fixture
def disk(backend: str) -> Iterator[Path]:
    """A small disk of the test's own, where PostgreSQL's user may go too."""
    place = Path(tempfile.mkdtemp(prefix="livella-disk-"))
    options = ["-t", "tmpfs", "-o", f"size={SIZE[backend]},mode=0777"]
    if os.geteuid() != 0 or subprocess.run(["mount", *options, "none", place], check=False).returncode:
        place.rmdir()
        pytest.skip("a disk cannot be mounted here")
    try:
        yield place
    finally:
        subprocess.run(["umount", "--lazy", place], check=True)
        place.rmdir()


@pytest.fixture
def url_on_disk(disk: Path, backend: str, request: pytest.FixtureRequest) -> Iterator[str]:
    """URL of a database whose tables are on the small disk."""
    if backend == "sqlite":
        yield f"sqlite:///{disk / 'livella.db'}"
        return
    server: Server = request.getfixturevalue("postgres")
    inner = disk / "tablespace"
    inner.mkdir(mode=0o700)
    shutil.chown(inner, "postgres")
    url = server.empty_database()
    name = url.rsplit("/", 1)[-1]
    server.execute(f"CREATE TABLESPACE small LOCATION '{inner}'")
    server.execute(f"ALTER DATABASE {name} SET TABLESPACE small")
    yield url
    server.execute(f"DROP DATABASE {name} WITH (FORCE)")
    server.execute("DROP TABLESPACE small")


@contextmanager
def filled(disk: Path) -> Iterator[None]:
    """Take all the room that is left."""
    filler = disk / "filler"
    try:
        with filler.open("wb", buffering=0) as file:
            while file.write(bytes(4096)):
                pass
    except OSError:
        pass
    try:
        yield
    finally:
        filler.unlink()


@pytest.mark.slow
def test_a_full_disk_puts_uploads_off(url_on_disk: str, disk: Path, tmp_path: Path) -> None:
    bodies = remounted().chunks
    server = ServerProcess(url_on_disk, tmp_path)
    with running(server) as api:
        calm, full = api.add_device("calm"), api.add_device("full")
        full.send_all(bodies[:LEFT_AFTER])
        seq, refused = LEFT_AFTER, 0
        with filled(disk):
            while refused < 5:
                answer = full.send(bodies[seq], seq)
                assert answer.status_code in {200, 503}, server.log.read_text()
                if answer.status_code == 200:
                    seq, refused = seq + 1, 0
                else:
                    assert int(answer.headers["retry-after"]) > 0
                    assert answer.json()["type"].endswith("unavailable")
                    refused += 1
            shown = full.installation()
            assert api.call("POST", "/devices", json={"name": "x"}).status_code in {201, 503}
        assert full.installation() == shown
        assert seq < len(bodies) - 2, "the disk was never full"
        full.send_all(bodies[seq:], start=seq)
        calm.send_all(bodies)
    database = Database(url_on_disk)
    assert stored.of_device(database, "full") == stored.of_device(database, "calm")
    database.close()
