"""A PostgreSQL server of the tests' own, and databases on it made by the migrations."""

import glob
import os
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import count
from pathlib import Path

import psycopg
import pytest

from storage.database import Database
from storage.migrate import upgrade
from tests.ports import free_port

_numbers = count(1)


def find_program(name: str) -> str | None:
    places = [shutil.which(name), *sorted(glob.glob(f"/usr/lib/postgresql/*/bin/{name}"), reverse=True)]
    return next((place for place in places if place), None)


class Server:
    """A running server on 127.0.0.1."""

    def __init__(self, port: int, directory: Path, control: Callable[..., None]) -> None:
        self.port = port
        self._directory = directory
        self._control = control
        self._template: str | None = None

    def start(self) -> None:
        """Start it and wait until it answers."""
        options = f"-p {self.port} -c listen_addresses=127.0.0.1 -c unix_socket_directories='' -c max_connections=200"
        self._control("-o", options, "start")

    def stop(self) -> None:
        """End it at once, as a crash does; what was committed is in its log."""
        self._control("-m", "immediate", "stop")

    @property
    def pid(self) -> int:
        """The process that the others are children of."""
        return int((self._directory / "postmaster.pid").read_text().split()[0])

    def url(self, name: str) -> str:
        return f"postgresql://livella@127.0.0.1:{self.port}/{name}"

    def execute(self, statement: str) -> None:
        with psycopg.connect(self.url("postgres"), autocommit=True) as connection:
            connection.execute(statement.encode())

    def empty_database(self) -> str:
        """Make a database without tables; give its URL."""
        name = f"test_{next(_numbers)}"
        self.execute(f"CREATE DATABASE {name}")
        return self.url(name)

    def database(self) -> str:
        """Make a database with the tables of the newest migration; give its URL."""
        if self._template is None:
            self._template = self._make_template()
        name = f"test_{next(_numbers)}"
        self.execute(f"CREATE DATABASE {name} TEMPLATE {self._template}")
        return self.url(name)

    def _make_template(self) -> str:
        url = self.empty_database()
        database = Database(url)
        upgrade(database)
        database.close()
        return url.rsplit("/", 1)[-1]


@contextmanager
def running_server() -> Iterator[Server]:
    """Start a server in a new directory, as a user it accepts, and stop it."""
    initdb, pg_ctl = find_program("initdb"), find_program("pg_ctl")
    if initdb is None or pg_ctl is None:
        pytest.skip("PostgreSQL is not installed: initdb and pg_ctl are needed")
    user = "postgres" if os.geteuid() == 0 else None
    directory = Path(tempfile.mkdtemp(prefix="livella-postgres-"))
    if user is not None:
        shutil.chown(directory, user)
    data = directory / "data"

    def control(*arguments: str) -> None:
        _run(user, pg_ctl, "-D", str(data), "-w", "-l", str(directory / "log"), *arguments)

    server = Server(free_port(), data, control)
    try:
        _run(user, initdb, "-D", str(data), "-U", "livella", "-A", "trust", "-E", "UTF8", "--no-sync")
        server.start()
        try:
            yield server
        finally:
            server.stop()
    finally:
        shutil.rmtree(directory)


def _run(user: str | None, *command: str) -> None:
    subprocess.run(command, check=True, user=user, cwd="/", stdout=subprocess.DEVNULL, stderr=subprocess.STDOUT)
