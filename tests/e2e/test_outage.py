"""The service goes away and comes back while somebody looks."""

import signal
from contextlib import ExitStack
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
    with ExitStack() as services:
        url, service = services.enter_context(livella.serving(tmp_path, port, LIVELLA_ADMIN_KEY=ADMIN_KEY))
        client = services.enter_context(httpx.Client(base_url=url, timeout=60.0))
        device = Api(client).add_device("van-1", name="Van 1")
        with Visitor.at_work(chromium, url) as visitor:
            visitor.sign_in()
            visitor.open("/devices/van-1")
            visitor.see_stage("Waiting")
            visitor.tolerated += WITHOUT_SERVICE
            loads = visitor.loads
            service.end(signal.SIGTERM)
            visitor.see("Connection lost")
            visitor.see_stage("Waiting")
            services.enter_context(livella.serving(tmp_path, port, LIVELLA_ADMIN_KEY=ADMIN_KEY))
            sent = device.send(drives.plain().chunks[0], 0, expect=200).json()
            assert sent["installation"]["stage"] != "waiting"
            expect(visitor.page.get_by_role("banner")).to_contain_text("Live", timeout=45_000)
            visitor.see_stage(sent["installation"]["stage"].capitalize())
            assert visitor.loads == loads


def test_three_drawings_stand_in_for_a_picture_that_does_not_come(visitor: Visitor, api: Api) -> None:
    device = api.add_device("van-1", name="Van 1")
    device.send_all(drives.plain().chunks)
    visitor.tolerated += ("ERR_FAILED",)
    visitor.page.route("**/assets/Scene3D*", lambda route: route.abort())
    visitor.sign_in()
    visitor.open("/devices/van-1")
    visitor.see("From above")
    expect(visitor.page.get_by_role("img", name="The device is turned")).to_have_count(1)
