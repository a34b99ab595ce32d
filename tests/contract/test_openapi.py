"""Requests made from the API's own description, sound ones and wrong ones, in every role: the answers are as described.

Nothing here knows the resources: what is added to the API is called too. `make fuzz-api` runs it for long.
"""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, NamedTuple

import pytest
import schemathesis
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from schemathesis import Case
from schemathesis.checks import not_a_server_error
from schemathesis.core.result import Ok
from schemathesis.specs.openapi.checks import (
    content_type_conformance,
    response_headers_conformance,
    response_schema_conformance,
    status_code_conformance,
)

from api.app import create_app
from api.formats import MEDIA_TYPES
from api.services import access
from storage import keys
from storage.database import Database
from tests.fuzz.seeds import SEEDS
from tests.postgres import running_server
from tests.server import ServerProcess, running
from tests.service import ADMIN_KEY

EXAMPLES = int(os.environ.get("LIVELLA_API_EXAMPLES", "8"))
"""requests of each operation, in each role, on each database"""
ROLES = ("nobody", "device", "installer", "manager", "admin")
KNOWN_DEVICE = "box-1"
PROBLEM = "application/problem+json"
CHECKS = [
    not_a_server_error,
    status_code_conformance,
    content_type_conformance,
    response_headers_conformance,
    response_schema_conformance,
]

pytestmark = pytest.mark.slow

METHODS = {"get", "put", "post", "patch", "delete", "head", "options"}
DOCUMENT = create_app().openapi()
SCHEMA = schemathesis.openapi.from_dict(DOCUMENT)
for kind, target in zip(MEDIA_TYPES, ("native_csv", "thesis_log", "arrow_stream"), strict=True):
    schemathesis.openapi.media_type(kind, st.sampled_from(SEEDS[target]) | st.binary(max_size=300))


def _is_endless(operation: Any) -> bool:
    """An event stream does not end; the tests of the stream read it."""
    answers = operation.definition.raw.get("responses", {}).values()
    return any("text/event-stream" in answer.get("content", {}) for answer in answers)


def _operations() -> dict[str, Any]:
    found = [result.ok() for result in SCHEMA.get_all_operations() if isinstance(result, Ok)]
    assert len(found) == sum(len(path.keys() & METHODS) for path in DOCUMENT["paths"].values()), "not sound"
    return {operation.label: operation for operation in found if not _is_endless(operation)}


OPERATIONS = _operations()


class Service(NamedTuple):
    """A running service, and a key of each role."""

    url: str
    keys: dict[str, str | None]


@pytest.fixture(scope="module", params=["sqlite", pytest.param("postgresql", marks=pytest.mark.postgres)])
def service(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    directory = tmp_path_factory.mktemp("service")
    if request.param == "sqlite":
        with _serving(f"sqlite:///{directory / 'livella.db'}", directory) as made:
            yield made
        return
    with running_server() as postgres, _serving(postgres.database(), directory) as made:
        yield made


@contextmanager
def _serving(database_url: str, directory: Path) -> Iterator[Service]:
    with running(ServerProcess(database_url, directory)) as api:
        device = api.add_device(KNOWN_DEVICE)
        made: dict[str, str | None] = {role: _make_key(database_url, role) for role in ("installer", "manager")}
        yield Service(str(api.client.base_url).rstrip("/"), made | {"device": device.key, "admin": ADMIN_KEY})


def _make_key(database_url: str, role: str) -> str:
    key, database = access.new_key(), Database(database_url)
    with database.write() as tx:
        keys.add(tx, access.digest(key), role, role, datetime.now(UTC))
    database.close()
    return key


def _aim(case: Case[Any], at_known: bool) -> None:
    """Let half of the requests meet a device that exists; it stays there."""
    if at_known and case.method != "DELETE" and "device_id" in (case.path_parameters or {}):
        case.path_parameters["device_id"] = KNOWN_DEVICE


def _revokes_a_key(case: Case[Any]) -> bool:
    """The keys of the test itself have to last."""
    return case.method == "DELETE" and "/keys/" in case.path


@pytest.mark.parametrize("role", ROLES)
@pytest.mark.parametrize("label", OPERATIONS)
def test_answers_are_as_described(service: Service, label: str, role: str) -> None:
    key = service.keys.get(role)
    headers = {"Authorization": f"Bearer {key}"} if key else {}

    @settings(max_examples=EXAMPLES, deadline=None, database=None, suppress_health_check=list(HealthCheck))
    @given(case=OPERATIONS[label].as_strategy() | _wrong(label), at_known=st.booleans())
    def check(case: Case[Any], at_known: bool) -> None:
        if key and _revokes_a_key(case):
            return
        _aim(case, at_known)
        response = case.call(base_url=service.url, headers=headers, timeout=30)
        case.validate_response(response, checks=CHECKS)
        if response.status_code >= 400 and case.method != "HEAD":
            assert response.headers["content-type"][0] == PROBLEM
            assert response.json()["status"] == response.status_code

    check()


def _wrong(label: str) -> st.SearchStrategy[Case[Any]]:
    return OPERATIONS[label].as_strategy(generation_mode=schemathesis.GenerationMode.NEGATIVE)  # type: ignore[no-any-return]
