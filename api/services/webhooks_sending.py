"""One call of a webhook: signed, bounded in time and size, no redirects, no proxies."""

import re
import time
from datetime import UTC, datetime, timedelta
from email.utils import parsedate_to_datetime
from types import TracebackType
from typing import NamedTuple, Self

import httpcore
import httpx
from standardwebhooks import Webhook as Signer

from api.services.webhooks_network import Backend
from storage.webhooks import Webhook

SECONDS = 10.0
"""s a call may take in all, from the connection to the end of the answer"""
MAX_ANSWER = 64 * 1024
"""bytes of answer read at most, with its headers; nothing but the status matters"""
LONGEST_WAIT = timedelta(hours=24)
"""A receiver cannot ask for a longer pause."""
GONE = 410
BUSY = (429, 503)


class Result(NamedTuple):
    """How a call ended."""

    status: int | None
    error: str | None
    duration_ms: int
    retry_after: timedelta | None = None

    @property
    def delivered(self) -> bool:
        """Whether the receiver has taken it."""
        return self.error is None


class Transport(httpx.HTTPTransport):
    """HTTP over checked addresses; every call has a connection of its own."""

    def __init__(self, allow_private: bool) -> None:
        context = httpx.create_ssl_context()
        super().__init__(verify=context, trust_env=False)
        self._pool.close()
        backend = Backend(allow_private, SECONDS, MAX_ANSWER)
        self._pool = httpcore.ConnectionPool(
            ssl_context=context, max_connections=None, max_keepalive_connections=0, network_backend=backend
        )


class Sender:
    """Makes calls; one for all threads of a process."""

    def __init__(self, allow_private: bool) -> None:
        self.client = httpx.Client(
            transport=Transport(allow_private),
            timeout=SECONDS,
            trust_env=False,
            follow_redirects=False,
            headers={"User-Agent": "Livella-Webhooks/1", "Content-Type": "application/json"},
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.client.close()

    def send(self, webhook: Webhook, message_id: str, payload: str, now: datetime) -> Result:
        """Call a webhook; what goes wrong is a result, not an exception."""
        begun = time.monotonic()
        try:
            status, retry_after = self._post(webhook, message_id, payload, now)
        except (httpx.HTTPError, httpx.InvalidURL, httpcore.ReadError, OSError, ValueError) as error:
            return Result(None, _words(error), _since(begun))
        return Result(status, _complaint(status), _since(begun), wait_asked_for(status, retry_after, now))

    def _post(self, webhook: Webhook, message_id: str, payload: str, now: datetime) -> tuple[int, str | None]:
        headers = signed_headers(webhook.secret, message_id, payload, now)
        with self.client.stream("POST", webhook.url, content=payload.encode(), headers=headers) as answer:
            return answer.status_code, answer.headers.get("retry-after")


def signed_headers(secret: str, message_id: str, payload: str, now: datetime) -> dict[str, str]:
    """Sign as Standard Webhooks has it; the time is that of the attempt."""
    return {
        "webhook-id": message_id,
        "webhook-timestamp": str(int(now.timestamp())),
        "webhook-signature": Signer(secret).sign(message_id, now, payload),
    }


def wait_asked_for(status: int, retry_after: str | None, now: datetime) -> timedelta | None:
    """Read Retry-After, seconds or a date, of a receiver that is busy."""
    if status not in BUSY or retry_after is None:
        return None
    if re.fullmatch(r"[0-9]{1,9}", retry_after.strip()):
        return min(timedelta(seconds=int(retry_after)), LONGEST_WAIT)
    try:
        until = parsedate_to_datetime(retry_after)
    except ValueError:
        return None
    until = until if until.tzinfo else until.replace(tzinfo=UTC)
    return min(max(until - now, timedelta(0)), LONGEST_WAIT)


def _complaint(status: int) -> str | None:
    """Say what is wrong with a status, if anything."""
    if 200 <= status < 300:
        return None
    if 300 <= status < 400:
        return f"the receiver answered {status}; redirects are not followed"
    return f"the receiver answered {status}"


def _words(error: Exception) -> str:
    """Say what went wrong, in a line."""
    if isinstance(error, httpx.TimeoutException):
        return f"no answer within {SECONDS:.0f} s"
    return (" ".join(str(error).split()) or type(error).__name__)[:300]


def _since(begun: float) -> int:
    return round((time.monotonic() - begun) * 1000)
