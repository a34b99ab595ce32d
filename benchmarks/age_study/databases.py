"""Pairs of equal databases: one is given a past, the other stays fresh."""

import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from sqlalchemy.engine import make_url

from benchmarks.load_study.cells import SQLITE
from storage.database import Database
from tests.postgres import Server, find_program, running_server


class Maker(NamedTuple):
    """Makes databases."""

    empty: Callable[[], str]
    """gives the URL of a new one"""
    twin: Callable[[str], str]
    """gives the URL of a copy of one that nobody has open"""


def why_not(kind: str) -> str | None:
    """Say why a kind of database cannot be had here, None when it can."""
    if kind != SQLITE and None in {find_program("initdb"), find_program("pg_ctl")}:
        return "PostgreSQL is not installed"
    return None


@contextmanager
def maker(kind: str, directory: Path) -> Iterator[Maker]:
    """Make databases of a kind, which go when the block ends."""
    if kind == SQLITE:
        yield Maker(lambda: _sqlite(directory / "fresh.db"), lambda url: _sqlite_twin(url, directory / "old.db"))
        return
    with running_server() as server:
        yield Maker(server.empty_database, lambda url: _postgresql_twin(server, url))


def _sqlite(path: Path) -> str:
    return f"sqlite:///{path}"


def _sqlite_twin(url: str, path: Path) -> str:
    shutil.copyfile(str(make_url(url).database), path)
    return _sqlite(path)


def _postgresql_twin(server: Server, url: str) -> str:
    name = make_url(url).database
    server.execute(f"CREATE DATABASE {name}_twin TEMPLATE {name}")
    return server.url(f"{name}_twin")


def settle_down(database: Database) -> None:
    """Do what the database does by itself some minutes after much was written: PostgreSQL counts and cleans up."""
    if not database.is_sqlite:
        with database.engine.connect().execution_options(isolation_level="AUTOCOMMIT") as connection:
            connection.exec_driver_sql("VACUUM ANALYZE")
