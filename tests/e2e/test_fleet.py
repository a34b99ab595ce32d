"""Signing in, registering, watching a device being calibrated: on simulated drives."""

import re
from collections.abc import Iterator

import pytest
from playwright.sync_api import expect

from tests import drives
from tests.e2e.visitor import Visitor
from tests.service import Api, Device

pytestmark = pytest.mark.browser


def drive_until_confirmed(device: Device) -> Iterator[str]:
    """Send a drive, a chunk at each step; give the stage after it in the page's words."""
    for seq, body in enumerate(drives.plain().chunks):
        stage: str = device.send(body, seq, expect=200).json()["installation"]["stage"]
        yield stage.capitalize()
    assert stage == "confirmed"


def test_a_wrong_key_is_told_and_the_right_one_opens(visitor: Visitor, api: Api) -> None:
    page = visitor.page
    visitor.open("/devices")
    page.get_by_role("textbox", name="Key").fill("livella_wrong")
    page.get_by_role("button", name="Sign in").click()
    expect(page.get_by_role("alert")).to_contain_text("not known")
    assert page.context.cookies() == []
    visitor.sign_in()
    visitor.see("No devices yet")
    (cookie,) = page.context.cookies(visitor.address + "/api")
    assert cookie["httpOnly"]
    assert cookie["sameSite"] == "Strict"
    page.get_by_role("button", name="Account").click()
    page.get_by_role("button", name="Sign out").click()
    visitor.see("Sign in")
    page.reload()
    visitor.see("Sign in")


def test_a_device_is_registered_on_a_phone_and_its_key_shown_once(installer: Visitor, api: Api) -> None:
    page = installer.page
    installer.sign_in()
    page.get_by_role("button", name="Add a device").first.click()
    dialog = page.get_by_role("dialog")
    dialog.get_by_role("textbox", name="Name").fill("Van 12")
    dialog.get_by_role("textbox", name="Vehicle").fill("Fiat Ducato")
    dialog.get_by_role("textbox", name="Device id").fill("van-12")
    dialog.get_by_role("button", name="Add", exact=True).click()
    installer.see("This key is shown only now")
    key, command = dialog.locator("code").all_text_contents()
    assert f"--device van-12 \\\n  --key {key}" in command
    assert api.as_(key).get("/devices/van-12/installation")["stage"] == "waiting"
    installer.assert_fits()
    dialog.get_by_role("link", name="Open the device").click()
    installer.see_stage("Waiting")
    assert key not in page.content()


def test_a_name_that_is_taken_is_explained_in_the_dialog(visitor: Visitor, api: Api) -> None:
    api.add_device("van-12")
    visitor.tolerated += ("409 (Conflict)",)
    visitor.sign_in()
    page = visitor.page
    page.get_by_role("button", name="Add a device").click()
    dialog = page.get_by_role("dialog")
    dialog.get_by_role("textbox", name="Name").fill("Van 12")
    dialog.get_by_role("textbox", name="Device id").fill("van-12")
    dialog.get_by_role("button", name="Add", exact=True).click()
    expect(dialog.get_by_role("alert")).to_contain_text("van-12")


def test_the_list_is_live_searched_and_filtered(visitor: Visitor, api: Api) -> None:
    moving = api.add_device("van-1", name="Van 1")
    api.add_device("bus-2", name="Bus 2")
    visitor.sign_in()
    page = visitor.page
    rows = page.get_by_role("table", name="Devices").get_by_role("row").filter(has=page.get_by_role("link"))
    expect(rows).to_have_count(2)
    moving.send_all(drives.plain().chunks[:3])
    expect(rows.filter(has_text="Van 1")).not_to_contain_text("Waiting")
    expect(page.get_by_role("button", name="Waiting 1")).to_be_visible()
    page.get_by_role("searchbox").fill("bus")
    expect(rows).to_have_count(1)
    page.get_by_role("searchbox").fill("nothing like it")
    visitor.see("No device matches")
    page.get_by_role("button", name="Show all devices").click()
    page.get_by_role("button", name="Waiting 1").click()
    expect(rows).to_have_text([re.compile("Bus 2")])
    api.add_device("taxi-3", name="Taxi 3")
    expect(rows).to_have_count(2)


def test_a_device_is_followed_to_confirmed_without_reload(visitor: Visitor, installer: Visitor, api: Api) -> None:
    device = api.add_device("van-1", name="Van 1")
    for somebody in (visitor, installer):
        somebody.sign_in()
        somebody.page.get_by_role("link", name="Van 1").click()
        somebody.see_stage("Waiting")
    loads = [visitor.loads, installer.loads]
    for word in drive_until_confirmed(device):
        visitor.see_stage(word)
        installer.see_stage(word)
    expect(visitor.page.get_by_role("status").filter(has_text="Stage: Confirmed")).to_have_count(1)
    visitor.scroll_to("Angle history")
    expect(visitor.page.get_by_role("img", name="Yaw over time")).to_be_visible()
    expect(visitor.page.get_by_role("region", name="Confirmed mountings")).to_contain_text("In force")
    assert loads == [visitor.loads, installer.loads]
    visitor.picture("simulated-1280")
    installer.picture("simulated-360")


def test_the_history_is_zoomed_and_unzoomed(visitor: Visitor, api: Api) -> None:
    device = api.add_device("van-1", name="Van 1")
    device.send_all(drives.plain().chunks)
    visitor.sign_in()
    visitor.open("/devices/van-1")
    page = visitor.page
    visitor.scroll_to("Angle history")
    chart = page.get_by_role("img", name="Yaw over time")
    chart.scroll_into_view_if_needed()
    box = chart.bounding_box()
    assert box is not None
    asked = []
    page.on("request", lambda request: asked.append(request.url) if "/estimates" in request.url else None)
    page.mouse.move(box["x"] + 0.3 * box["width"], box["y"] + 40)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.6 * box["width"], box["y"] + 45, steps=4)
    page.mouse.up()
    reset = page.get_by_role("button", name="Reset zoom")
    expect(reset).to_be_visible()
    expect(chart).to_be_visible()
    assert "from=" in asked[-1]
    assert "to=" in asked[-1]
    reset.click()
    expect(reset).to_be_hidden()
    expect(chart).to_be_visible()


def test_a_moved_device_is_told_with_the_evidence(visitor: Visitor, api: Api) -> None:
    story = drives.remounted()
    api.add_device("van-1", name="Van 1").send_all(story.chunks[: story.moved + 1])
    (alert,) = api.get("/alerts")["items"]
    visitor.sign_in()
    visitor.open("/devices/van-1")
    visitor.scroll_to("Alerts")
    shown = visitor.page.get_by_role("region", name="Alerts")
    expect(shown).to_contain_text(alert["message"])
    chart = shown.get_by_role("img", name="Evidence went from")
    expect(chart).to_have_count(0 if alert["data"]["evidence"] is None else 1, timeout=20_000)
    visitor.assert_accessible()


def test_a_refit_begins_anew_and_keeps_the_history(visitor: Visitor, api: Api) -> None:
    device = api.add_device("van-1", name="Van 1")
    device.send_all(drives.plain().chunks)
    visitor.sign_in()
    visitor.open("/devices/van-1")
    visitor.see_stage("Confirmed")
    page = visitor.page
    page.get_by_role("button", name="Device refitted").click()
    page.get_by_role("dialog").get_by_role("button", name="Cancel").click()
    visitor.see_stage("Confirmed")
    page.get_by_role("button", name="Device refitted").click()
    page.get_by_role("dialog").get_by_role("button", name="Start again").click()
    visitor.see_stage("Aligning")
    mounts = page.get_by_role("region", name="Confirmed mountings")
    expect(mounts).to_contain_text("Superseded")


def test_a_device_key_sees_its_own_device_only(installer: Visitor, api: Api) -> None:
    own = api.add_device("van-1", name="Van 1")
    api.add_device("bus-2", name="Bus 2")
    installer.sign_in(own.key)
    installer.see_stage("Waiting")
    assert installer.page.url.endswith("/devices/van-1")
    expect(installer.page.get_by_role("button", name="Device refitted")).to_have_count(0)
    installer.tolerated += ("/devices/bus-2",)
    installer.open("/devices/bus-2")
    installer.see("does not exist")
