"""The service goes away and comes back while somebody looks."""

import signal
from pathlib import Path

import httpx
import pytest
from playwright.sync_api import Browser, expect

from tests import drives
from tests.cli import livella
from tests.e2e.visitor import Visitor
from tests.service import ADMIN_KEY, Api

pytestmark = pytest.mark.browser

WITHOUT_SERVICE = ("ERR_CONNECTION_REFUSED", "ERR_INCOMPLETE_CHUNKED_ENCODING", "ERR_CONNECTION_RESET", "503")


def test_the_page_says_so_and_catches_up_by_itself(chromium: Browser, tmp_path: Path) -> None:
    port = livella.free_port()
    with livella.serving(tmp_path, port, LIVELLA_ADMIN_KEY=ADMIN_KEY) as (url, service):
        with httpx.Client(base_url=url, timeout=60.0) as client:
            device = Api(client).add_device("van-1", name="Van 1")
        with Visitor.at_work(chromium, url) as visitor:
            visitor.sign_in()
            visitor.open("/devices/van-1")
            visitor.see_stage("Waiting")
            service.end(signal.SIGTERM)
            visitor.see("Connection lost")
            visitor.see_stage("Waiting")
            loads = visitor.loads
            with livella.serving(tmp_path, port, LIVELLA_ADMIN_KEY=ADMIN_KEY), httpx.Client(base_url=url) as client:
                device.api.client = client
                sent = device.send(drives.chunks(900.0)[0], 0, expect=200).json()
                assert sent["installation"]["stage"] != "waiting"
                expect(visitor.page.get_by_role("banner")).to_contain_text("Live", timeout=45_000)
                visitor.see_stage(sent["installation"]["stage"].capitalize())
                assert visitor.loads == loads
            visitor.complaints = [text for text in visitor.complaints if not any(w in text for w in WITHOUT_SERVICE)]
