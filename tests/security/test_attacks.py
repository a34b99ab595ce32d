"""What somebody who means harm may send."""

import gzip
import json
import logging
import socket
import tracemalloc
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import httpx
import pytest
import zstandard
from starlette.applications import Starlette
from starlette.testclient import TestClient

from api import page
from api.headers import HEADERS
from tests.drives import chunks
from tests.server import ServerProcess, running
from tests.service import Api

MIB = 2**20
MARKUP = '<img src=x onerror="alert(1)">'
ODD_IDS = [
    "..", "%2e%2e", "a/../../b", "..%2f..%2fetc%2fpasswd", "a%00b", "a%0d%0aSet-Cookie:x=1", "%c0%ae", "%ff",
    "a" * 5000, "\u202ebox", "b\u043ex-1", "box-1%20", "' OR '1'='1", "%25", "_",
]  # fmt: skip
ODD_SESSIONS = ["a\nERROR forged", "a\r\nSet-Cookie: x=1", "\x1b[31m", "a\x00b", "", "a b", "é", "\u202e", "x" * 129]


# ---------------------------------------------------------------- the wire


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ServerProcess]:
    directory = tmp_path_factory.mktemp("service")
    made = ServerProcess(f"sqlite:///{directory / 'livella.db'}", directory)
    with running(made):
        yield made


def exchange(server: ServerProcess, request: bytes) -> bytes:
    """Send bytes; give what comes back until the server hangs up or says no more."""
    answer = b""
    with socket.create_connection(("127.0.0.1", server.port), timeout=3) as connection:
        try:
            connection.sendall(request)
            while part := connection.recv(65536):
                answer += part
        except (TimeoutError, ConnectionError):
            pass
    return answer


@pytest.mark.parametrize(
    "request_",
    [
        b"GET /healthz HTTP/1.1\r\nHost: x\r\nX-Long: " + b"a" * 2 * MIB + b"\r\nConnection: close\r\n\r\n",
        b"GET /healthz HTTP/1.1\r\nHost: x\r\n" + b"X-Many: a\r\n" * 50_000 + b"Connection: close\r\n\r\n",
        b"POST /api/v1/session HTTP/1.1\r\nHost: x\r\nContent-Length: \xb2\r\nConnection: close\r\n\r\n",
        b"POST /api/v1/session HTTP/1.1\r\nHost: x\r\nContent-Length: -1\r\nConnection: close\r\n\r\n",
        b"POST /api/v1/session HTTP/1.1\r\nHost: x\r\nContent-Length: 5\r\n"
        b"Transfer-Encoding: chunked\r\n\r\n0\r\n\r\nGET",
        b"GET /../../../../etc/passwd HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n",
        b"GET /%2e%2e/%2e%2e/etc/passwd HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n",
        b"GET /%00 HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n",
        b"GET /" + b"a" * 5000 + b" HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n",
        b"GET /\x00 HTTP/1.1\r\nHost: x\r\n\r\n",
        b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03",
        b"\xff" * 10_000 + b"\r\n\r\n",
    ],
    ids=["long header", "many headers", "odd length", "negative length", "two lengths", "traversal",
         "encoded traversal", "nul in a path", "long name", "nul", "tls", "rubbish"],
)  # fmt: skip
def test_odd_requests_do_no_harm(server: ServerProcess, request_: bytes) -> None:
    answer = exchange(server, request_)
    assert b" 500 " not in answer.split(b"\r\n", 1)[0]
    assert b"root:" not in answer
    assert httpx.get(f"{server.url}/healthz", timeout=10).status_code == 200
    assert "Traceback" not in server.log.read_text()


# ---------------------------------------------------------------- bombs


def resident(server: ServerProcess) -> int:
    """Give the bytes of memory a server has."""
    assert server.process is not None
    status = Path(f"/proc/{server.process.pid}/status").read_text()
    return int(status.partition("VmRSS:")[2].split()[0]) * 1024


def test_what_is_refused_without_being_read_does_not_stay_in_memory(server: ServerProcess) -> None:
    many, size = 300, 100_000
    head = b"POST /api/v1/devices/a/chunks?session=a&seq=0 HTTP/1.1\r\nHost: x\r\nAuthorization: Bearer nobodys\r\n"
    request = head + b"Content-Length: %d\r\n\r\n" % size + b"a" * size
    before = resident(server)
    with ExitStack() as opened:
        for _ in range(many):
            connection = opened.enter_context(socket.create_connection(("127.0.0.1", server.port), timeout=10))
            connection.sendall(request)
            assert connection.recv(65536).startswith(b"HTTP/1.1 401 ")
        assert resident(server) - before < many * size / 2


def bomb(encoding: str, layers: int, size: int = 200 * MIB) -> bytes:
    body = bytes(size)
    for _ in range(layers):
        body = gzip.compress(body) if encoding == "gzip" else zstandard.compress(body)
    return body


@pytest.mark.parametrize("encoding", ["gzip", "zstd"])
@pytest.mark.parametrize(("layers", "expect"), [(1, 413), (2, 422)])
def test_a_bomb_is_refused_and_one_inside_another_not_lit(api: Api, encoding: str, layers: int, expect: int) -> None:
    device, body = api.add_device(), bomb(encoding, layers)
    tracemalloc.start()
    try:
        device.send(body, 0, expect=expect, Content_Encoding=encoding)
        assert tracemalloc.get_traced_memory()[1] < 200 * MIB
    finally:
        tracemalloc.stop()
    assert device.get("installation")["stage"] == "waiting"


def test_small_members_add_up(api: Api) -> None:
    device = api.add_device()
    device.send(gzip.compress(bytes(MIB)) * 80, 0, expect=413, Content_Encoding="gzip")
    device.send(zstandard.compress(bytes(MIB)) * 80, 0, expect=413, Content_Encoding="zstd")
    device.send(gzip.compress(b"") * 20_000, 0, expect=400, Content_Encoding="gzip")


def test_a_zstd_frame_that_lies_about_its_size_or_asks_for_a_huge_window(api: Api) -> None:
    device = api.add_device()
    parameters = zstandard.ZstdCompressionParameters(window_log=27, write_content_size=False)
    compressor = zstandard.ZstdCompressor(compression_params=parameters).compressobj()
    huge_window = compressor.compress(chunks()[0]) + compressor.flush()
    device.send(huge_window, 0, expect=400, Content_Encoding="zstd")
    lying = bytes.fromhex("28b52ffd") + b"\xe0" + (2**62).to_bytes(8, "little") + b"\x01\x00\x00"
    assert device.send(lying, 0, Content_Encoding="zstd").status_code in {400, 413, 422}


# ---------------------------------------------------------------- names and texts


@pytest.mark.parametrize("name", ODD_IDS)
def test_odd_ids_are_not_found(client: TestClient, api: Api, name: str) -> None:
    api.add_device()
    for path in (f"/api/v1/devices/{name}", f"/api/v1/devices/{name}/installation"):
        answer = client.get(path, headers={"Authorization": f"Bearer {api.key}"})
        assert answer.status_code in {404, 200}  # 200 only where the path became the list of devices
        assert answer.json().get("id") is None
        assert "set-cookie" not in answer.headers


@pytest.mark.parametrize("session", ODD_SESSIONS)
def test_odd_sessions_are_refused_and_cannot_forge_a_line_of_the_log(
    api: Api, session: str, caplog: pytest.LogCaptureFixture
) -> None:
    device = api.add_device()
    with caplog.at_level(logging.DEBUG):
        device.send(chunks()[0], 0, session=session, expect=422)
    assert all(record.getMessage().isprintable() for record in caplog.records if record.name.startswith("api"))


def test_an_unusable_chunk_is_logged_on_one_line(api: Api, caplog: pytest.LogCaptureFixture) -> None:
    device = api.add_device()
    header = b"t,ax,ay,az,fix,speed,course,\x1b[2J,x\x0bERROR\n"
    device.send(header + b"0,0,0,9.8,1,3,90,,\n", 1, expect=202, User_Agent="x\x1b[31m")
    device.send(header + b"1e300,0,0,9.8,1,3,90,,\n", 2, expect=422)
    assert all(record.getMessage().isprintable() for record in caplog.records)


def test_texts_come_back_as_they_are_and_as_json(api: Api) -> None:
    texts = {"name": MARKUP, "vehicle": "\u202eevil\u0301🚐", "notes": "'; DROP TABLE devices; --\n</script>"}
    device = api.add_device("box-1", **texts)
    answer = device.admin.call("GET", "/devices/box-1", 200)
    assert {name: answer.json()[name] for name in texts} == texts
    assert answer.headers["content-type"] == "application/json"
    assert answer.headers["x-content-type-options"] == "nosniff"


@pytest.mark.parametrize("text", ["a\x00b", "\x00"])
def test_the_character_0_is_refused_everywhere(api: Api, text: str) -> None:
    api.call("POST", "/devices", 422, json={"name": text})
    api.call("POST", "/devices", 422, json={"name": "x", "notes": text})
    api.call("GET", "/devices", 422, params={"q": text})
    api.call("GET", "/alerts", 422, params={"device_id": text})


def test_half_a_surrogate_is_refused(api: Api) -> None:
    body = json.dumps({"name": "\ud800"}).encode()
    answer = api.call("POST", "/devices", content=body, headers={"Content-Type": "application/json"})
    assert answer.status_code in {400, 422}


@pytest.mark.parametrize(
    ("q", "found"),
    [
        ("%", {"box-1"}),
        ("_", {"box-2"}),
        ("\\", {"box-3"}),
        ("'", {"box-4"}),
        ("%%", set()),
        ("B_x", set()),
        ("*", set()),
    ],
)
def test_q_has_no_wildcards(api: Api, q: str, found: set[str]) -> None:
    for n, name in enumerate(("100% van", "van_a", "van\\b", "o'van"), 1):
        api.add_device(f"box-{n}", name=name)
    assert {device["id"] for device in api.get("/devices", params={"q": q})["items"]} == found


# ---------------------------------------------------------------- headers


def test_every_answer_has_the_headers_that_guard(client: TestClient, api: Api) -> None:
    api.add_device()
    for path in ("/", "/healthz", "/nothing", "/api/v1/devices", "/api/v1/nothing", "/docs", "/openapi.json"):
        answer = client.get(path)
        assert {name: answer.headers[name] for name in HEADERS} == HEADERS, path
    assert "unsafe" not in HEADERS["Content-Security-Policy"]


def test_a_header_cannot_be_injected_through_what_is_echoed(api: Api) -> None:
    device = api.add_device()
    for value in ('"1-in_force"\tx', '"' + "a" * 5000, "W/W/W/", ",,,,"):
        device.api.call("GET", "/devices/box-1/mount", 404, headers={"If-None-Match": value})
    answer = api.call("GET", "/devices", params={"cursor": "x\r\nSet-Cookie: a=b"})
    assert answer.status_code == 422
    assert "set-cookie" not in answer.headers


# ---------------------------------------------------------------- the page's files


@pytest.mark.parametrize(
    "path",
    ["/../secret.txt", "/%2e%2e/secret.txt", "/..%2fsecret.txt", "/assets/../../secret.txt", "//secret.txt",
     "/%2e%2e%5csecret.txt", "/link.txt"],
)  # fmt: skip
def test_the_page_gives_nothing_beside_itself(tmp_path: Path, path: str) -> None:
    static = tmp_path / "static"
    static.mkdir()
    (tmp_path / "secret.txt").write_text("secret")
    (static / "index.html").write_text("start")
    (static / "link.txt").symlink_to(tmp_path / "secret.txt")
    app = Starlette()
    app.router.default = page.Page(app.router.default, static)
    client = TestClient(app, raise_server_exceptions=False)
    raw = client.get("http://testserver" + path)
    assert "secret" not in raw.text
    assert raw.status_code in {200, 404}
