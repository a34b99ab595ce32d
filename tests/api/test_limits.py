import re
import threading
import time
from collections.abc import Iterator

import pytest
from pydantic import SecretStr
from starlette.testclient import TestClient

from api.app import create_app
from api.services import access
from api.services.access import Principal, Role
from api.services.counts import Counts
from api.services.errors import TooManyRequestsError
from api.services.limiting import Rates
from api.settings import Settings
from tests.conftest import Clock
from tests.service import ADMIN_KEY, Api, Response

BOX = Principal(1, Role.DEVICE, "box")


class Time:
    """The clock of the counts; it stands still half a second into a minute."""

    def __init__(self) -> None:
        self.now = 60_000_000.5

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def backend() -> str:
    """Limits touch no database."""
    return "sqlite"


@pytest.fixture
def moment(monkeypatch: pytest.MonkeyPatch) -> Time:
    made = Time()
    monkeypatch.setattr("api.services.counts.time.time", made)
    return made


@pytest.fixture
def limited(settings: Settings, clock: Clock, moment: Time) -> Iterator[Api]:
    few = {"device_requests_per_minute": 3, "requests_per_minute": 5, "failures_per_minute": 4}
    with TestClient(create_app(settings.model_copy(update=few), clock), raise_server_exceptions=False) as client:
        yield Api(client)


def standing(answer: Response) -> tuple[str, int, int, int, int]:
    """Policy, quota, window, remaining, reset; in the syntax of the draft."""
    policy = re.fullmatch(r'"(\w+)";q=(\d+);w=(\d+)', answer.headers["ratelimit-policy"])
    now = re.fullmatch(r'"(\w+)";r=(\d+);t=(\d+)', answer.headers["ratelimit"])
    assert policy is not None
    assert now is not None
    assert policy[1] == now[1]
    return policy[1], int(policy[2]), int(policy[3]), int(now[2]), int(now[3])


def test_each_key_may_call_so_often(limited: Api, moment: Time) -> None:
    device, other = limited.add_device("a"), limited.add_device("b")
    for left in (2, 1, 0):
        answer = device.api.call("GET", "/devices/a/installation", 200)
        assert standing(answer) == ("device", 3, 60, left, 60)
    refused = device.api.call("GET", "/devices/a/installation", 429)
    assert refused.json()["type"] == "urn:livella:problem:too-many-requests"
    assert refused.headers["content-type"] == "application/problem+json"
    assert refused.headers["retry-after"] == "60"
    assert standing(refused) == ("device", 3, 60, 0, 60)
    other.installation()
    assert standing(limited.call("GET", "/devices", 200)) == ("person", 5, 60, 2, 60)
    moment.now += 60
    device.installation()


def test_every_answer_tells_the_limits(limited: Api) -> None:
    for path, status, policy in (
        ("/devices", 200, "person"),
        ("/devices/nobody", 404, "person"),
        ("/devices?limit=0", 422, "person"),
        ("/nothing", 404, "failures"),
    ):
        answer = limited.call("GET", path, status)
        assert standing(answer)[0] == policy, path
    assert standing(limited.as_(None).call("GET", "/devices", 401)) == ("failures", 4, 60, 4, 60)
    assert "ratelimit" not in limited.call("GET", "/healthz", 200).headers


def test_a_sign_in_counts_with_its_key(limited: Api) -> None:
    client = limited.client
    for left in (4, 3):
        assert standing(client.post("/api/v1/session", json={"key": ADMIN_KEY}))[3] == left
    assert standing(client.get("/api/v1/devices"))[3] == 2


@pytest.mark.parametrize("through", ["header", "sign-in"])
def test_guessing_keys_ends_soon(limited: Api, moment: Time, through: str) -> None:
    def guess(key: str) -> Response:
        if through == "header":
            return limited.as_(key).call("GET", "/session")
        answer: Response = limited.client.post("/api/v1/session", json={"key": key})
        return answer

    device = limited.add_device("a")
    for left in (3, 2, 1, 0):
        answer = guess("guess")
        assert (answer.status_code, standing(answer)[3]) == (401, left)
    refused = guess("guess")
    assert (refused.status_code, refused.headers["retry-after"]) == (429, "60")
    assert guess(ADMIN_KEY).status_code == 429  # the chosen key is not told from a guess
    assert guess(access.new_key()).status_code == 429
    assert guess(device.key).status_code == 200  # nobody guesses what was made here
    moment.now += 60
    assert guess(ADMIN_KEY).status_code == 200
    refusals = [e for e in limited.get("/audit")["items"] if e["action"] == "session.refused"]
    assert len(refusals) == (0 if through == "header" else 4)  # the trail does not grow with the guesses


def test_a_cookie_that_ended_is_no_guess(limited: Api) -> None:
    limited.client.cookies.set("livella_session", "ended")
    for _ in range(10):
        assert limited.client.get("/api/v1/session").status_code == 401


# ---------------------------------------------------------------- the counts


def rates(**settings: int) -> Rates:
    return Rates(Settings(admin_key=SecretStr(ADMIN_KEY), **settings))  # type: ignore[arg-type]


def test_the_window_slides(moment: Time) -> None:
    made = rates(device_requests_per_minute=10)
    moment.now += 30
    for _ in range(10):
        assert made.charge(BOX)[1]
    (_, _, _, remaining, reset), is_allowed = made.charge(BOX)
    assert (remaining, reset, is_allowed) == (0, 30, False)
    moment.now += 30 + 29.0  # half of the minute before still counts
    allowed = [made.charge(BOX) for _ in range(7)]
    assert [is_allowed for _, is_allowed in allowed] == [True] * 5 + [False] * 2
    assert [now.remaining for now, _ in allowed] == [4, 3, 2, 1, 0, 0, 0]
    wait = allowed[-1][0].reset
    moment.now += wait - 1
    was_early = made.charge(BOX)[1]
    moment.now += 1
    assert made.charge(BOX)[1]
    assert wait <= 6
    assert not was_early or wait == 1


@pytest.mark.parametrize("seconds", [0.0, 1.0, 20.0, 59.0])
@pytest.mark.parametrize("quota", [1, 2, 7, 120])
def test_who_waits_as_told_is_let_in(moment: Time, seconds: float, quota: int) -> None:
    made = rates(device_requests_per_minute=quota)
    moment.now += seconds
    for _ in range(5):
        while made.charge(BOX)[1]:
            pass
        now, _ = made.charge(BOX)
        assert now.remaining == 0
        moment.now += now.reset
        assert made.charge(BOX)[1]


def test_an_ipv6_network_is_one_address(moment: Time) -> None:
    made = rates(failures_per_minute=2)
    made.failed("2001:db8::1")
    made.failed("2001:db8::ffff:2")
    with pytest.raises(TooManyRequestsError):
        made.failed("2001:db8:0:0:1::1")
    made.failed("2001:db8:0:1::1")
    made.failed("::ffff:192.0.2.1")
    made.failed("192.0.2.1")
    with pytest.raises(TooManyRequestsError):
        made.failed("192.0.2.1")


def test_what_is_counted_is_bounded(moment: Time) -> None:
    counts = Counts(most=100)
    for n in range(1000):
        assert counts.acquire_sliding_window_entry(str(n), 1, 60)
        assert not counts.acquire_sliding_window_entry(str(n), 1, 60)
    assert len(counts) == 100
    assert counts.get_sliding_window("0", 60)[2] == 0
    assert counts.get_sliding_window("999", 60)[2] == 1


def test_threads_count_together() -> None:
    made = rates(device_requests_per_minute=1000)
    allowed: list[bool] = []
    threads = [
        threading.Thread(target=lambda: allowed.extend(made.charge(BOX)[1] for _ in range(400))) for _ in range(4)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sum(allowed) == 1000


def test_counting_costs_next_to_nothing() -> None:
    made = rates(device_requests_per_minute=10**6)
    best = min(_seconds(made) for _ in range(20))
    assert best < 50e-6


def _seconds(made: Rates, calls: int = 200) -> float:
    begun = time.perf_counter()
    for _ in range(calls):
        made.charge(BOX)
    return (time.perf_counter() - begun) / calls
