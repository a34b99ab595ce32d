"""What a machine can check of WCAG 2.2 AA, in light and dark, at a desk and on a phone."""

from typing import Literal

import pytest
from playwright.sync_api import Browser, expect

from tests import drives
from tests.e2e.visitor import Visitor
from tests.service import Api

pytestmark = pytest.mark.browser

SIZES = {"desk": (1280, 900), "phone": (360, 740)}


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("size", SIZES)
def test_every_page_can_be_used_by_everybody(
    chromium: Browser, address: str, api: Api, size: str, scheme: Literal["light", "dark"]
) -> None:
    device = api.add_device("van-1", name="Van 1")
    api.add_device("new", name="Not yet heard of")
    device.send_all(drives.plain().chunks)
    width, height = SIZES[size]
    with Visitor.at_work(chromium, address, width, height, color_scheme=scheme) as visitor:
        visitor.open()
        visitor.see("Sign in")
        visitor.assert_accessible()
        visitor.sign_in()
        visitor.see("Not yet heard of")
        visitor.assert_accessible()
        visitor.picture(f"devices-{size}-{scheme}")
        visitor.page.get_by_role("button", name="Add a device").click()
        expect(visitor.page.get_by_role("dialog")).to_be_visible()
        visitor.assert_accessible()
        for path, sight in (("/devices/new", "Waiting for data"), ("/devices/van-1", "Numbers"), ("/nowhere", "exist")):
            visitor.open(path)
            visitor.see(sight)
            visitor.assert_accessible()
            visitor.assert_fits()


def test_the_keyboard_reaches_everything(visitor: Visitor, api: Api) -> None:
    api.add_device("van-1", name="Van 1")
    visitor.open()
    visitor.see("Sign in")
    page = visitor.page
    page.keyboard.press("Tab")
    expect(page.get_by_role("textbox", name="Key")).to_be_focused()
    visitor.sign_in()
    page.reload()
    visitor.see("Van 1")
    page.keyboard.press("Tab")
    expect(page.get_by_role("link", name="Skip to the content")).to_be_focused()
    page.keyboard.press("Enter")
    page.keyboard.press("Tab")
    expect(page.get_by_role("button", name="Add a device")).to_be_focused()
    page.keyboard.press("Enter")
    expect(page.get_by_role("dialog").get_by_role("textbox", name="Name")).to_be_focused()
    page.keyboard.press("Escape")
    expect(page.get_by_role("dialog")).to_be_hidden()
    expect(page.get_by_role("button", name="Add a device")).to_be_focused()
    page.get_by_role("link", name="Van 1").focus()
    page.keyboard.press("Enter")
    visitor.see_stage("Waiting")
