"""How a vehicle moved and what happened to it: a crash after the mounting was confirmed, seen on the page."""

import csv
import re
from collections.abc import Iterator

import httpx
import pytest
from playwright.sync_api import Browser, Page, expect

from api.formats import parse
from tests import crashes, drives
from tests.e2e.visitor import Visitor
from tests.service import ADMIN_KEY, Api, Device

pytestmark = pytest.mark.browser

MOTION = "/devices/van-7/motion"


@pytest.fixture(scope="module")
def crashed(address: str) -> Iterator[Device]:
    """A device whose vehicle was hit from the front left, and another one that has only just been fitted."""
    with httpx.Client(base_url=address, timeout=60.0) as client:
        admin = Api(client)
        for known in admin.get("/devices", params={"limit": 500})["items"]:
            admin.call("DELETE", f"/devices/{known['id']}", 204)
        device = admin.add_device("van-7", name="Van 7")
        device.send_all(crashes.crashed().chunks)
        admin.add_device("van-8").send_all(drives.chunks()[:1])
        yield device


@pytest.fixture
def desk(visitor: Visitor, crashed: Device) -> Visitor:
    visitor.sign_in()
    return visitor


def chart(page: Page, name: str) -> str:
    """What a chart says to somebody who does not see it."""
    shown = page.get_by_role("img", name=re.compile(f"^{name} over time"))
    expect(shown).to_be_visible(timeout=20_000)
    return shown.get_attribute("aria-label") or ""


def moment(page: Page) -> int:
    return int(page.get_by_role("slider", name="Moment").input_value())


def test_from_the_alert_to_the_impact_and_the_seconds_around_it(desk: Visitor) -> None:
    desk.open("/alerts")
    alert = desk.page.get_by_role("article").filter(has_text="hit from the front left")
    alert.get_by_text("Details").click()
    alert.get_by_role("link", name="The impact").click()
    expect(desk.page.get_by_role("heading", level=1)).to_have_text("Impact")
    expect(desk.page.get_by_text(re.compile(r"[34]\d° to the left of the front, 11 o’clock"))).to_be_visible()
    expect(desk.page.get_by_role("img", name="The vehicle from above")).to_be_visible()
    least, most = (
        float(n.replace("\u2212", "-")) for n in re.findall(r"[\u2212\d.]+", chart(desk.page, "Acceleration"))[:2]
    )
    assert least < -50.0 < 50.0 > most  # pushed back and to the right
    desk.assert_accessible()
    desk.picture("impact")


def test_the_moment_moves_by_hand_and_is_played(desk: Visitor) -> None:
    desk.open(MOTION)
    chart(desk.page, "Speed")
    slider = desk.page.get_by_role("slider", name="Moment")
    slider.fill("10")
    assert moment(desk.page) == 10
    desk.page.get_by_role("button", name="Play").click()
    expect(slider).not_to_have_value("10")
    desk.page.get_by_role("button", name="Pause").click()
    stopped = moment(desk.page)
    desk.page.wait_for_timeout(500)
    assert moment(desk.page) == stopped


def test_an_event_leads_to_its_moment_and_the_way_back_to_the_newest_data(desk: Visitor) -> None:
    desk.open(MOTION)
    chart(desk.page, "Acceleration")
    desk.page.get_by_role("button", name=re.compile("^Impact")).click()
    expect(desk.page).to_have_url(re.compile("end="))
    expect(desk.page.get_by_role("button", name="Later")).to_be_enabled()
    desk.page.get_by_role("button", name="Latest").click()
    expect(desk.page.get_by_role("button", name="Later")).to_be_disabled()
    desk.assert_accessible()
    desk.picture("motion")


def test_the_readings_around_an_impact_are_taken_away_as_a_log_that_can_be_uploaded(desk: Visitor) -> None:
    desk.open(MOTION)
    desk.page.get_by_role("listitem").filter(has_text="Impact").get_by_role("link", name="Details").click()
    with desk.page.expect_download() as download:
        desk.page.get_by_role("link", name="Readings as CSV").click()
    content = download.value.path().read_bytes()
    rows = list(csv.DictReader(content.decode().splitlines()))
    assert max(abs(float(row["ax"])) + abs(float(row["ay"])) + abs(float(row["az"])) for row in rows) > 100.0
    assert parse(content, "text/csv", None).rows == len(rows)


def test_before_a_mounting_is_confirmed_it_says_what_is_missing(desk: Visitor) -> None:
    desk.open("/devices/van-8/motion")
    desk.see("Motion is computed once the mounting is confirmed")
    desk.see("Nothing worth telling has happened so far")
    desk.assert_accessible()


def test_a_device_leads_to_its_motion(desk: Visitor) -> None:
    desk.open("/devices/van-7")
    desk.page.get_by_role("link", name="Motion").click()
    expect(desk.page).to_have_url(re.compile(f"{MOTION}$"))


def test_an_event_that_is_not_there_is_said_to_be_none(desk: Visitor) -> None:
    desk.tolerated = (*desk.tolerated, "404 (Not Found)")
    desk.open(f"{MOTION}/999999")
    desk.see("There is no such event.")


def test_on_a_phone_in_italian_in_the_dark(chromium: Browser, address: str, crashed: Device) -> None:
    with Visitor.at_work(chromium, address, width=360, height=740, locale="it-IT", color_scheme="dark") as phone:
        phone.open()
        phone.page.get_by_role("textbox", name="Chiave").fill(ADMIN_KEY)
        phone.page.get_by_role("button", name="Accedi").click()
        phone.see("Dispositivi")
        phone.open(MOTION)
        phone.see("Cerchio di aderenza")
        phone.page.get_by_role("listitem").filter(has_text="Urto").get_by_role("link", name="Dettagli").click()
        phone.see("Da davanti a sinistra")
        expect(phone.page.get_by_text(re.compile(r"[34]\d° a sinistra rispetto al davanti, a ore 11"))).to_be_visible()
        phone.assert_accessible()
        phone.picture("impact-phone-it")
