"""One leader among processes, told apart by their contexts."""

import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor

import pytest
from starlette.testclient import TestClient

from api.app import create_app
from api.services import housekeeping, startup
from api.services.context import Context
from api.services.housekeeping import Job
from api.services.leading import LEASE, RENEWAL, Leadership
from api.settings import Settings
from storage import leases
from storage.database import Database
from tests.conftest import Clock


@pytest.fixture
def pair(settings: Settings, clock: Clock) -> Iterator[tuple[Leadership, Leadership]]:
    """Two processes on one database."""
    contexts = [Context.make(settings, clock) for _ in range(2)]
    startup.prepare(contexts[0])
    yield Leadership(contexts[0]), Leadership(contexts[1])
    for context in contexts:
        context.database.close()


def test_one_leads_as_long_as_it_lives(pair: tuple[Leadership, Leadership], clock: Clock) -> None:
    first, second = pair
    for _ in range(50):
        assert (first.held(), second.held()) == (True, False)
        clock.advance(5)


def test_after_a_death_another_one_takes_over(pair: tuple[Leadership, Leadership], clock: Clock) -> None:
    first, second = pair
    assert first.held()
    clock.advance(LEASE.total_seconds() - 1)
    assert not second.held()
    clock.advance(1)
    assert second.held()
    assert not first.held()
    clock.advance(RENEWAL.total_seconds() + 1)
    assert (second.held(), first.held()) == (True, False)


def test_who_ends_lets_another_one_lead_at_once(pair: tuple[Leadership, Leadership]) -> None:
    first, second = pair
    assert first.held()
    second.give_up()
    assert not second.held()
    first.give_up()
    assert second.held()
    assert not first.held()


@pytest.mark.parametrize("back", [20.0, 3600.0, 86400.0])
def test_a_clock_set_back_leaves_nobody_without_a_leader(
    pair: tuple[Leadership, Leadership], clock: Clock, back: float
) -> None:
    first, second = pair
    assert first.held()
    clock.advance(-back)
    assert first.held() != second.held()
    clock.advance(-back)  # and the leader is dead
    assert _leads_soon(second, clock)


def _leads_soon(leadership: Leadership, clock: Clock) -> bool:
    for _ in range(30):
        if leadership.held():
            return True
        clock.advance(5)
    return False


def test_only_the_leader_does_what_is_for_the_leader(pair: tuple[Leadership, Leadership]) -> None:
    done: list[tuple[str, Context]] = []
    for_one = Job("for one", 1.0, lambda context: done.append(("one", context)))
    for_all = Job("for all", 1.0, lambda context: done.append(("all", context)), leader_only=False)
    for leadership in pair:
        for job in (for_one, for_all):
            housekeeping.do(job, leadership.context, leadership)
    first, second = (leadership.context for leadership in pair)
    assert done == [("one", first), ("all", first), ("all", second)]


def test_a_job_says_whether_there_is_more(pair: tuple[Leadership, Leadership]) -> None:
    first, second = pair
    more = Job("more", 1.0, lambda _: True)
    assert housekeeping.do(more, first.context, first) is True
    assert housekeeping.do(more, second.context, second) is False
    assert housekeeping.do(more._replace(work=lambda _: None), first.context, first) is False


def test_a_service_that_is_stopped_gives_its_lease_up(settings: Settings, clock: Clock, database: Database) -> None:
    with TestClient(create_app(settings, clock)):
        deadline = time.monotonic() + 30
        while _holder(database) is None:
            assert time.monotonic() < deadline
            time.sleep(0.01)
    assert _holder(database) is None


def _holder(database: Database) -> str | None:
    with database.read() as tx:
        found = leases.find(tx, "housekeeping")
    return None if found is None else found.holder


def test_jobs_that_ask_at_once_agree(pair: tuple[Leadership, Leadership]) -> None:
    context = pair[0].context
    for _ in range(10):
        leadership = Leadership(context)
        with ThreadPoolExecutor(5) as threads:
            held = [threads.submit(leadership.held) for _ in range(5)]
        assert all(one.result() for one in held)
        leadership.give_up()
        with context.database.read() as tx:
            assert leases.find(tx, "housekeeping") is None
