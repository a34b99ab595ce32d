"""A device as the service sees it: sends chunks one after the other, and tries again as long as that can help."""

import gzip
import threading
from collections.abc import Callable
from datetime import UTC, datetime
from email.utils import parsedate_to_datetime
from typing import Any, Self
from urllib.parse import quote

import httpx
from tenacity import (
    RetryCallState,
    Retrying,
    retry_if_exception_type,
    sleep_using_event,
    stop_after_delay,
    stop_any,
    stop_when_event_set,
    wait_random_exponential,
)

PATIENCE = 300.0
"""s one request is tried again before the device gives up"""
LONGEST_WAIT = 60.0
"""s between two tries, also when the service asks for more"""

_BACKOFF = wait_random_exponential(multiplier=0.5, max=30.0)
_TRY_AGAIN = frozenset({httpx.codes.REQUEST_TIMEOUT, httpx.codes.TOO_MANY_REQUESTS})
"""The network was too slow for the body, or too much was sent; 5xx too are worth another try."""


class RefusedError(Exception):
    """The service refused; trying again would not help. The text is what it answered."""

    def __init__(self, status: int, text: str) -> None:
        super().__init__(text)
        self.status = status


class UnavailableError(Exception):
    """The service cannot be reached or is busy; trying again may help."""

    def __init__(self, text: str, retry_after: float = 0.0) -> None:
        super().__init__(text)
        self.retry_after = retry_after


class Service:
    """The service at an address, asked with a key. A context manager."""

    def __init__(
        self,
        server: str,
        key: str,
        say: Callable[[str], None],
        patience: float = PATIENCE,
        end: threading.Event | None = None,
    ) -> None:
        """Prepare to talk to `server`; `say` is told when a request is tried again, which `end` cuts short."""
        self._http = httpx.Client(
            base_url=f"{server.rstrip('/')}/api/v1/",
            headers={"Authorization": f"Bearer {key}"},
            timeout=httpx.Timeout(60.0, connect=10.0),
            follow_redirects=False,
        )
        self._say = say
        self._end = end or threading.Event()
        self._stop = stop_any(stop_after_delay(patience), stop_when_event_set(self._end))

    def __enter__(self) -> Self:
        """Keep the connections open."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close the connections."""
        self._http.close()

    def request(self, method: str, path: str, **more: Any) -> Any:
        """Make a request, if need be several times, and give the document of the answer.

        Raises
        ------
        RefusedError
            the service refused
        UnavailableError
            the service could not be reached for `patience` seconds
        """
        retrying = Retrying(
            retry=retry_if_exception_type(UnavailableError),
            wait=_wait,
            stop=self._stop,
            sleep=sleep_using_event(self._end),
            before_sleep=self._announce,
            reraise=True,
        )
        return retrying(self._once, method, path, **more)

    def _once(self, method: str, path: str, **more: Any) -> Any:
        try:
            response = self._http.request(method, path, **more)
        except httpx.TransportError as error:
            raise UnavailableError(f"{self._http.base_url.host} cannot be reached: {error}") from error
        if response.is_success:
            return response.json() if response.content else None
        text = _explanation(response)
        if response.status_code in _TRY_AGAIN or response.is_server_error:
            raise UnavailableError(text, _retry_after(response))
        raise RefusedError(response.status_code, text)

    def _announce(self, tried: RetryCallState) -> None:
        error = tried.outcome.exception() if tried.outcome else None
        seconds = tried.next_action.sleep if tried.next_action else 0.0
        self._say(f"{error}; trying again in {seconds:.1f} s")


class Device:
    """One device in one session."""

    def __init__(self, service: Service, device_id: str, session: str, media_type: str, course: str = "auto") -> None:
        """Begin a session, whose chunks are numbered from 0."""
        self._service = service
        self._path = f"devices/{quote(device_id, safe='')}"
        self._session = session
        self._headers = {"Content-Type": media_type, "Content-Encoding": "gzip"}
        self._course = course
        self._seq = 0

    def send(self, content: bytes) -> dict[str, Any]:
        """Send the next chunk; give the answer with the receipt and the installation."""
        parameters = {"session": self._session, "seq": self._seq, "course": self._course}
        body = gzip.compress(content, 6, mtime=0)
        answer: dict[str, Any] = self._service.request(
            "POST", f"{self._path}/chunks", params=parameters, content=body, headers=self._headers
        )
        self._seq += 1
        return answer


def register(service: Service, device_id: str, name: str, vehicle: str | None = None) -> str | None:
    """Register a device unless it is there; give its key, or None when it was there."""
    try:
        service.request("GET", f"devices/{quote(device_id, safe='')}")
    except RefusedError as error:
        if error.status != httpx.codes.NOT_FOUND:
            raise
    else:
        return None
    key: str = service.request("POST", "devices", json={"id": device_id, "name": name, "vehicle": vehicle})["key"]
    return key


def _explanation(response: httpx.Response) -> str:
    """Give what the service says, which is a problem document (RFC 9457) unless something else answered for it."""
    try:
        problem = response.json()
        return f"{response.status_code} {problem['title']}: {problem['detail']}"
    except (ValueError, KeyError, TypeError):
        return f"{response.status_code} {response.reason_phrase}"


def _retry_after(response: httpx.Response) -> float:
    """Give the seconds the service asks to wait, from a number or a date."""
    value = response.headers.get("Retry-After", "0")
    try:
        return max(0.0, float(value))
    except ValueError:
        pass
    try:
        return max(0.0, (parsedate_to_datetime(value) - datetime.now(UTC)).total_seconds())
    except (ValueError, TypeError):
        return 0.0


def _wait(tried: RetryCallState) -> float:
    error = tried.outcome.exception() if tried.outcome else None
    asked = error.retry_after if isinstance(error, UnavailableError) else 0.0
    return min(max(_BACKOFF(tried), asked), LONGEST_WAIT)
