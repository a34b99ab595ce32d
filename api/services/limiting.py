"""How often somebody may call: every key so many times a minute, every address so many failures a minute.

Counted in the memory of a process, by the sliding window of the library `limits`: what was counted in the minute before
counts by the share of it that the last 60 s still cover.
"""

import ipaddress
from typing import NamedTuple

from limits import RateLimitItem, RateLimitItemPerMinute
from limits.strategies import SlidingWindowCounterRateLimiter

from api.services import access
from api.services.access import Principal, Role
from api.services.counts import Counts
from api.services.errors import TooManyRequestsError
from api.settings import Settings

IPV6_PREFIX = 64
"""bits of an IPv6 address that are counted as one: who has one of these addresses has them all"""


class Standing(NamedTuple):
    """How somebody stands with a limit."""

    policy: str
    quota: int
    window: int
    """s"""
    remaining: int
    reset: int
    """s: `remaining` calls are allowed for so long, or none before it has passed"""


class Rates:
    """What a server process counts. People and devices are counted by key, so that nobody is held up by a neighbour."""

    def __init__(self, settings: Settings) -> None:
        self._counts = Counts()
        self._limiter = SlidingWindowCounterRateLimiter(self._counts)
        self._device = _limit("device", settings.device_requests_per_minute)
        self._person = _limit("person", settings.requests_per_minute)
        self._failures = _limit("failures", settings.failures_per_minute)

    def __len__(self) -> int:
        return len(self._counts)

    def charge(self, principal: Principal) -> tuple[Standing, bool]:
        """Count a call; tell how its key stands then, and whether the call is allowed."""
        limit = self._device if principal.role == Role.DEVICE else self._person
        who = str(principal.key_pk)
        is_allowed = self._limiter.hit(limit, who)
        return self._standing(limit, who), is_allowed

    def of_address(self, address: str) -> Standing:
        """Tell how an address stands with its failures."""
        return self._standing(self._failures, _network(address))

    def admit(self, address: str, key: str) -> None:
        """Refuse to try a key that may be a guess from an address with too many failures.

        A key made here cannot be guessed, so it is tried always: a fleet behind one address stays connected, whatever
        its neighbours do there.
        """
        if not access.is_ours(key) and not self._limiter.test(self._failures, _network(address)):
            raise too_many(self.of_address(address))

    def failed(self, address: str) -> None:
        """Count a key that is none; refuse when there were too many."""
        if not self._limiter.hit(self._failures, _network(address)):
            raise too_many(self.of_address(address))

    def _standing(self, limit: RateLimitItem, who: str) -> Standing:
        window = limit.get_expiry()
        before, before_left, now, now_left = self._counts.get_sliding_window(limit.key_for(who), window)
        remaining = max(0, limit.amount - int(before * before_left / window) - now)
        left = now_left - window  # s of the window now
        if remaining == 0 and now < limit.amount:  # enough as soon as the window before counts for less
            left = before_left - window * (limit.amount - now) / before
        return Standing(limit.namespace, limit.amount, window, remaining, int(left) + 1)


def too_many(standing: Standing) -> TooManyRequestsError:
    """Make the refusal."""
    return TooManyRequestsError(f"At most {standing.quota} in {standing.window} s are allowed.", standing.reset)


def _limit(policy: str, amount: int) -> RateLimitItem:
    return RateLimitItemPerMinute(amount, namespace=policy)


def _network(address: str) -> str:
    try:
        parsed = ipaddress.ip_address(address)
    except ValueError:
        return address
    if parsed.version == 4:
        return address
    mapped = parsed.ipv4_mapped
    return str(mapped or ipaddress.ip_network((int(parsed), IPV6_PREFIX), strict=False))
