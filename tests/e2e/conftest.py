"""The service as a process of its own, and Chromium looking at its page."""

import shutil
from collections.abc import Iterator

import httpx
import pytest
from playwright.sync_api import Browser, sync_playwright

from tests.cli import livella
from tests.e2e.visitor import SWITCHES, Visitor
from tests.server import ROOT
from tests.service import ADMIN_KEY, Api


@pytest.fixture(scope="module")
def chromium() -> Iterator[Browser]:
    """Debian's Chromium; for a module only, because Playwright's event loop is in the way of other tests' loops."""
    path = shutil.which("chromium")
    assert path, "Chromium is missing: install Debian's package `chromium`"
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=SWITCHES)
        yield browser
        browser.close()


@pytest.fixture(scope="session")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """The service, serving the built page."""
    assert (ROOT / "api/static/index.html").is_file(), "the page is not built: run `make setup`"
    directory = tmp_path_factory.mktemp("service")
    with livella.serving(directory, LIVELLA_ADMIN_KEY=ADMIN_KEY) as (url, _):
        yield url


@pytest.fixture
def api(address: str) -> Iterator[Api]:
    """The service as its administrator sees it, without devices."""
    with httpx.Client(base_url=address, timeout=60.0) as client:
        admin = Api(client)
        for device in admin.get("/devices", params={"limit": 500})["items"]:
            admin.call("DELETE", f"/devices/{device['id']}", 204)
        yield admin


@pytest.fixture
def visitor(chromium: Browser, address: str) -> Iterator[Visitor]:
    """Somebody at a desk."""
    with Visitor.at_work(chromium, address) as somebody:
        yield somebody


@pytest.fixture
def installer(chromium: Browser, address: str) -> Iterator[Visitor]:
    """Somebody in a workshop, with a phone."""
    with Visitor.at_work(chromium, address, width=360, height=740) as somebody:
        yield somebody
