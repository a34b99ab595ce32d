"""Speaking to the service in tests."""

import time
from typing import Any, Protocol

ADMIN_KEY = "admin-key-of-the-tests-0123456789abcdef"
API = "/api/v1"
COMPILE_SECONDS = 300.0
"""s at most until a busy machine has compiled the estimator, when no cache has it"""
NO_LIMITS: dict[str, Any] = dict.fromkeys(
    ("device_requests_per_minute", "requests_per_minute", "failures_per_minute"), 1000000
)
"""Tests call more often than people and devices."""
Json = dict[str, Any]


class Response(Protocol):
    """What the HTTP clients' answers have in common."""

    status_code: int
    headers: Any
    content: bytes
    text: str

    def json(self) -> Any: ...


class Api:
    """The service as one caller sees it."""

    def __init__(self, client: Any, key: str | None = ADMIN_KEY) -> None:  # a TestClient or an httpx.Client
        self.client = client
        self.key = key

    def as_(self, key: str | None) -> "Api":
        return Api(self.client, key)

    def call(self, method: str, path: str, expect: int | None = None, **options: Any) -> Response:
        headers = {"Authorization": f"Bearer {self.key}"} if self.key else {}
        headers |= options.pop("headers", {})
        url = path if path.startswith(("/api", "/health", "/ready")) else API + path
        response: Response = self.client.request(method, url, headers=headers, **options)
        assert expect is None or response.status_code == expect, response.text
        return response

    def get(self, path: str, expect: int = 200, **options: Any) -> Any:
        return self.call("GET", path, expect, **options).json()

    def post(self, path: str, json: Any = None, expect: int = 200) -> Any:
        return self.call("POST", path, expect, json=json).json()

    def wait_until_ready(self, seconds: float = COMPILE_SECONDS) -> None:
        deadline = time.monotonic() + seconds
        while self.call("GET", "/readyz").status_code != 200:
            assert time.monotonic() < deadline, "the service does not become ready"
            time.sleep(0.02)

    def add_device(self, device_id: str = "box-1", **texts: Any) -> "Device":
        made = self.post("/devices", {"id": device_id, "name": f"Box {device_id}"} | texts, 201)
        return Device(self, device_id, made["key"])


class Device:
    """A device that sends chunks."""

    def __init__(self, api: Api, device_id: str, key: str) -> None:
        self.admin = api
        self.api = api.as_(key)
        self.id = device_id
        self.key = key

    def send(self, body: bytes, seq: int, session: str = "a", expect: int | None = None, **headers: str) -> Response:
        kind = {"Content-Type": "text/csv"} | {name.replace("_", "-"): value for name, value in headers.items()}
        query = {"session": session, "seq": seq}
        path = f"/devices/{self.id}/chunks"
        return self.api.call("POST", path, expect, params=query, content=body, headers=kind)

    def send_all(self, bodies: tuple[bytes, ...], session: str = "a", start: int = 0) -> Json:
        answer: Json = {}
        for seq, body in enumerate(bodies, start):
            answer = self.send(body, seq, session, expect=200).json()
        return answer

    def installation(self) -> Json:
        shown: Json = self.api.get(f"/devices/{self.id}/installation")
        return shown

    def get(self, path: str, expect: int = 200, **options: Any) -> Any:
        return self.api.get(f"/devices/{self.id}/{path}", expect, **options)
