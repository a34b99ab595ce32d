import gzip
import threading
from pathlib import Path

import pytest
from starlette.testclient import TestClient

from api import page, settings
from api.app import create_app
from api.routes import service
from api.services import startup
from api.settings import Settings
from tests.conftest import Clock
from tests.drives import chunks
from tests.service import ADMIN_KEY, Api

ROOT = Path(__file__).parents[2]


def test_it_is_alive_at_once_and_ready_when_the_estimator_is_compiled(
    settings: Settings, clock: Clock, monkeypatch: pytest.MonkeyPatch
) -> None:
    compiled = threading.Event()
    monkeypatch.setattr(startup, "warm_up", lambda _: compiled.wait(30))
    with TestClient(create_app(settings, clock)) as client:
        api = Api(client)
        assert client.get("/healthz").json() == {"status": "ok"}
        starting = client.get("/readyz")
        assert (starting.status_code, starting.json()) == (503, {"status": "starting"})
        device = api.add_device()
        refused = device.send(chunks()[0], 0, expect=503)
        assert refused.headers["retry-after"].isdigit()
        compiled.set()
        api.wait_until_ready()
        assert client.get("/readyz").json() == {"status": "ok"}
        device.send(chunks()[0], 0, expect=200)


def test_a_service_that_cannot_compile_stays_unready(
    settings: Settings, clock: Clock, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(startup, "warm_up", lambda _: 1 / 0)
    with TestClient(create_app(settings, clock)) as client:
        assert client.get("/readyz").status_code == 503
        assert client.get("/healthz").status_code == 200
    assert "cannot be compiled" in caplog.text


PROBLEMS = [
    ("GET", "/api/v1/nothing", 404),
    ("POST", "/api/v1/nothing", 404),
    ("PUT", "/api/v1/devices", 405),
    ("GET", "/api/nothing", 404),
    ("POST", "/nothing", 404),
    ("GET", "/api/v1/devices/none", 404),
    ("GET", "/api/v1/devices?limit=x", 422),
]


@pytest.mark.parametrize(("method", "path", "status"), PROBLEMS)
def test_every_error_is_problem_details(api: Api, client: TestClient, method: str, path: str, status: int) -> None:
    answer = client.request(method, path, headers={"Authorization": f"Bearer {ADMIN_KEY}", "Accept": "text/html"})
    assert answer.status_code == status
    assert answer.headers["content-type"] == "application/problem+json"
    problem = answer.json()
    assert set(problem) == {"type", "title", "status", "detail", "errors"}
    assert problem["status"] == status


def test_what_is_wrong_in_a_request_is_pointed_at(api: Api) -> None:
    problem = api.call("POST", "/devices", 422, json={"name": 5, "extra/field~": 1}).json()
    assert {error["pointer"] for error in problem["errors"]} == {"/body/name", "/body/extra~1field~0"}
    assert api.call("POST", "/devices", 422, content=b"{").json()["errors"][0]["pointer"].startswith("/body")


def test_a_fault_of_ours_tells_no_internals(api: Api, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        raise RuntimeError("secret detail")

    monkeypatch.setattr("storage.device_lists.page", fail)
    problem = api.call("GET", "/devices", 500)
    assert problem.headers["content-type"] == "application/problem+json"
    assert "secret" not in problem.text


def test_every_answer_has_the_security_headers(api: Api, client: TestClient) -> None:
    for path in ("/", "/healthz", "/docs", "/openapi.json", "/api/v1/session", "/api/v1/nothing"):
        headers = client.get(path).headers
        assert headers["x-content-type-options"] == "nosniff", path
        policy = headers["content-security-policy"]
        assert "default-src 'self'" in policy
        assert "unsafe" not in policy
        assert "frame-ancestors 'none'" in policy
    assert client.get("/api/v1/session").headers["cache-control"] == "no-store"


def test_the_page_may_use_the_camera_and_nothing_else(client: TestClient) -> None:
    policy = client.get("/").headers["permissions-policy"].split(", ")
    allowed = dict(rule.split("=") for rule in policy)
    assert allowed.pop("camera") == "(self)"
    assert set(allowed) == {"microphone", "geolocation", "payment"}
    assert set(allowed.values()) == {"()"}


# ---------------------------------------------------------------- the page


@pytest.fixture
def built(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    directory = tmp_path / "static"
    (directory / "assets").mkdir(parents=True)
    (directory / "swagger").mkdir()
    (directory / "index.html").write_text("<p>start</p>")
    (directory / "assets" / "app-1a2b.js").write_text("1;" * 500)
    (directory / "assets" / "app-1a2b.js.gz").write_bytes(gzip.compress(b"1;" * 500))
    (tmp_path / "secret.txt").write_text("secret")
    monkeypatch.setattr(page, "STATIC", directory)
    monkeypatch.setattr(service, "SWAGGER", directory / "swagger")
    return directory


def test_the_page_finds_its_own_way(built: Path, client: TestClient) -> None:
    for path in ("/", "/index.html", "/devices/box-1", "/alerts"):
        answer = client.get(path)
        assert (answer.status_code, answer.text) == (200, "<p>start</p>"), path
        assert answer.headers["cache-control"] == "no-cache"
    asset = client.get("/assets/app-1a2b.js")
    assert "immutable" in asset.headers["cache-control"]
    assert "javascript" in asset.headers["content-type"]
    assert asset.headers["content-encoding"] == "gzip", "phones in workshops have slow networks"
    unchanged = client.get("/assets/app-1a2b.js", headers={"If-None-Match": asset.headers["etag"]})
    assert unchanged.status_code == 304
    assert client.get("/assets/old-9z.js").status_code == 404
    assert client.head("/").status_code == 200
    assert client.post("/").status_code in {404, 405}


@pytest.mark.parametrize(
    ("accepted", "sent"),
    [
        ("gzip, deflate, br, zstd", "br"),
        ("br;q=0, gzip;q=0.5", "gzip"),
        ("GZIP", "gzip"),
        ("gzip;q=0, br;q=0.000", None),
        ("identity", None),
        ("", None),
    ],
)
def test_the_smallest_file_that_the_browser_takes_is_sent(
    built: Path, client: TestClient, accepted: str, sent: str | None
) -> None:
    for ending in ("br", "gz"):
        (built / "assets" / f"app-1a2b.js.{ending}").write_text(f"compressed: {ending}")
    with client.stream("GET", "/assets/app-1a2b.js", headers={"Accept-Encoding": accepted}) as answer:
        content = b"".join(answer.iter_raw())
    assert answer.headers.get("content-encoding") == sent
    assert content == {"br": b"compressed: br", "gzip": b"compressed: gz", None: b"1;" * 500}[sent]
    assert answer.headers["content-type"].startswith("text/javascript")
    assert answer.headers["vary"] == "Accept-Encoding"
    assert "immutable" in answer.headers["cache-control"]


@pytest.mark.parametrize(
    "path", ["/../secret.txt", "/%2e%2e/secret.txt", "/assets/..%2f..%2fsecret.txt", "//secret.txt"]
)
def test_only_files_of_the_page_are_served(built: Path, client: TestClient, path: str) -> None:
    assert "secret" not in client.get(path).text


def test_the_description_of_the_api_needs_no_other_server(built: Path, client: TestClient) -> None:
    html = client.get("/docs").text
    assert "swagger-ui-bundle.js" in html
    assert "http" not in html.replace("<!doctype html>", "")
    assert client.get("/docs/start.js").headers["content-type"].startswith("text/javascript")


@pytest.fixture
def not_built(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(page, "STATIC", tmp_path / "nothing")
    monkeypatch.setattr(service, "SWAGGER", tmp_path / "nothing")


@pytest.mark.parametrize("path", ["/", "/devices/box-1", "/docs"])
def test_a_page_that_is_not_built_says_so(not_built: None, client: TestClient, path: str) -> None:
    answer = client.get(path)
    assert answer.status_code == 404
    assert "make setup" in answer.text
    assert answer.headers["content-type"].startswith("text/plain")


# ---------------------------------------------------------------- settings and description


def test_the_table_of_settings_is_up_to_date() -> None:
    written = (ROOT / "docs" / "settings.md").read_text()
    assert written == settings.document(), "run `python -m api.settings > docs/settings.md`"
    for name in Settings.model_fields:
        assert f"`LIVELLA_{name.upper()}`" in written
        assert Settings.model_fields[name].description


def test_settings_come_from_the_environment(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("LIVELLA_GAP_TIMEOUT", "5")
    monkeypatch.setenv("LIVELLA_DATA_DIR", str(tmp_path))
    read = Settings()
    assert read.gap_timeout == 5
    assert read.url == f"sqlite:///{tmp_path / 'livella.db'}"
    for name, value in (("GAP_TIMEOUT", "-1"), ("PRESET", "none"), ("ADMIN_KEY", "")):
        with monkeypatch.context() as patch:
            patch.setenv(f"LIVELLA_{name}", value)
            with pytest.raises(ValueError, match=name.lower()):
                Settings()


def test_secrets_of_the_settings_are_not_printed() -> None:
    shown = repr(Settings(admin_key="hidden-key", database_url="postgresql://u:hidden-password@h/d"))
    assert "hidden" not in shown


def test_the_description_names_every_error_and_every_answer(client: TestClient) -> None:
    document = client.get("/openapi.json").json()
    operations = [op for path in document["paths"].values() for op in path.values()]
    assert len({op["operationId"] for op in operations}) == len(operations)
    for operation in operations:
        assert set(operation["responses"]["default"]["content"]) == {"application/problem+json"}
        success = [answer for status, answer in operation["responses"].items() if status.startswith("2")]
        for answer in success:
            for media in answer.get("content", {}).values():
                assert media.get("schema") or media.get("itemSchema"), operation["operationId"]
    assert "HTTPValidationError" not in document["components"]["schemas"]
    assert set(document["components"]["schemas"]["Installation"]["required"]) == {
        *("device_id", "stage", "since", "progress", "needs", "hint", "estimate", "verification", "mount", "limits"),
        *("data", "open_alerts", "last_data_at", "revision"),
    }
