"""Fixtures: databases (SQLite and PostgreSQL), a clock that stands still, the service with its client."""

from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest
from pydantic import SecretStr
from starlette.testclient import TestClient

from api.app import create_app
from api.settings import Settings
from storage.database import Database
from tests.postgres import Server, running_server
from tests.service import ADMIN_KEY, NO_LIMITS, Api

BACKENDS = ["sqlite", pytest.param("postgresql", marks=pytest.mark.postgres)]


class Clock:
    """Tells a time that moves only when told to."""

    def __init__(self) -> None:
        self.now = datetime(2024, 5, 6, 7, 8, 9, tzinfo=UTC)

    def __call__(self) -> datetime:
        return self.now

    def advance(self, seconds: float) -> None:
        self.now += timedelta(seconds=seconds)


@pytest.fixture(scope="session")
def postgres() -> Iterator[Server]:
    with running_server() as server:
        yield server


@pytest.fixture(params=BACKENDS)
def backend(request: pytest.FixtureRequest) -> str:
    """Run the test on every database."""
    return str(request.param)


@pytest.fixture
def database_url(backend: str, request: pytest.FixtureRequest, tmp_path: Path) -> str:
    """URL of a database of the test's own."""
    if backend == "sqlite":
        return f"sqlite:///{tmp_path / 'livella.db'}"
    server: Server = request.getfixturevalue("postgres")
    return server.database()


@pytest.fixture
def database(database_url: str) -> Iterator[Database]:
    """Look at what the service stored."""
    opened = Database(database_url)
    yield opened
    opened.close()


@pytest.fixture
def settings(database_url: str, tmp_path: Path) -> Settings:
    return Settings(
        database_url=SecretStr(database_url),
        data_dir=tmp_path,
        admin_key=SecretStr(ADMIN_KEY),
        estimate_interval=5.0,
        **NO_LIMITS,
    )


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def client(settings: Settings, clock: Clock) -> Iterator[TestClient]:
    """The service, ready, without any key."""
    with TestClient(create_app(settings, clock), raise_server_exceptions=False) as running:
        yield running


@pytest.fixture
def api(client: TestClient) -> Api:
    """The service for an administrator."""
    made = Api(client)
    made.wait_until_ready()
    return made
