"""The list of devices: tiles that filter, an address to share, any number of rows, adding a device with a camera."""

import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx
import pytest
from playwright.sync_api import Browser, Locator, Page, expect

from tests import drives, fleets
from tests.cli import livella
from tests.e2e import codes
from tests.e2e.speed import scroll_frame_rate
from tests.e2e.visitor import SWITCHES, Visitor
from tests.service import ADMIN_KEY, Api, Device

pytestmark = pytest.mark.browser

MANY = 10_000
MOST_ROWS = 60
"""in the document, however many there are"""
WITHOUT_HTTPS = ("The Cross-Origin-Opener-Policy header has been ignored",)
"""is logged by Chromium where a header of ours asks for more than an address without https can have"""


@pytest.fixture(scope="module")
def large(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """A service with ten thousand devices."""
    directory = tmp_path_factory.mktemp("large")
    fleets.make(directory / "data", MANY)
    with livella.serving(directory, LIVELLA_ADMIN_KEY=ADMIN_KEY) as (url, _):
        yield url


@pytest.fixture
def manager(chromium: Browser, large: str) -> Iterator[Visitor]:
    """Somebody at a desk who looks after ten thousand devices."""
    with Visitor.at_work(chromium, large) as somebody:
        somebody.sign_in()
        somebody.see("Van 1")
        yield somebody


def rows(page: Page) -> Locator:
    """The rows that are in the document, without the heads of the columns and those that are still to come."""
    return page.locator("[data-index]").filter(has=page.get_by_role("link"))


def names(page: Page) -> list[str]:
    return rows(page).get_by_role("link").all_text_contents()


def tile(page: Page, word: str) -> Locator:
    return page.get_by_role("button", name=re.compile(rf"^{word} [\d,]+$"))


def count_of(page: Page, word: str) -> int:
    return int(tile(page, word).inner_text().split()[-1].replace(",", ""))


# ---------------------------------------------------------------- tiles and the address


def test_each_tile_lists_just_the_devices_that_it_counts(manager: Visitor) -> None:
    page = manager.page
    for word, search in (
        ("Waiting", "stage=waiting"),
        ("Confirmed", "stage=confirmed"),
        ("Critical", "alert_severity=critical"),
        ("Notes", "alert_severity=info"),
        ("Silent", "alert_kind=device_silent"),
        ("Suspect mounting", "mount_status=suspect"),
    ):
        tile(page, "All").click()
        tile(page, word).click()
        expect(tile(page, word)).to_have_attribute("aria-pressed", "true")
        expect(tile(page, "All")).to_have_attribute("aria-pressed", "false")
        expect(page).to_have_url(f"{manager.address}/devices?{search}")
        count = count_of(page, word)
        expect(page.get_by_role("status").filter(has_text=f"{count:,} devices")).to_be_visible()
        expect(page.get_by_role("table")).to_have_attribute("aria-rowcount", str(count + 1))
    numbers = range(1, MANY + 1)
    silent = [n for n in numbers if fleets.alert_of(n) == ("device_silent", "warning")]
    tile(page, "All").click()
    tile(page, "Silent").click()
    expect(rows(page).first).to_contain_text(fleets.id_of(silent[0]))
    expect(rows(page).first).to_contain_text("5 days ago")
    assert count_of(page, "Silent") == len(silent)
    tile(page, "Waiting").click()
    expect(page).to_have_url(re.compile(r"stage=waiting&alert_kind=device_silent"))
    both = [n for n in silent if fleets.stage_of(n) == "waiting"]
    expect(page.get_by_role("status").filter(has_text=f"{len(both)} device")).to_be_visible()
    tile(page, "Waiting").click()
    expect(tile(page, "Waiting")).to_have_attribute("aria-pressed", "false")


def test_what_is_looked_at_stands_in_the_address(manager: Visitor, chromium: Browser) -> None:
    page = manager.page
    tile(page, "Waiting").click()
    page.get_by_role("searchbox").press_sequentially("van 12", delay=20)
    expect(page).to_have_url(f"{manager.address}/devices?q=van+12&stage=waiting")
    page.get_by_role("button", name="Name").click()
    sorted_by_name = f"{manager.address}/devices?q=van+12&stage=waiting&sort=name"
    expect(page).to_have_url(sorted_by_name)
    expect(rows(page).first).to_contain_text("Van 120")
    page.go_back()
    expect(page).to_have_url(f"{manager.address}/devices?q=van+12&stage=waiting")
    expect(page.get_by_role("searchbox")).to_have_value("van 12")
    page.go_back()
    expect(page).to_have_url(f"{manager.address}/devices")  # what was typed is one step, not one for each letter
    expect(page.get_by_role("searchbox")).to_have_value("")
    expect(tile(page, "All")).to_have_attribute("aria-pressed", "true")
    page.go_forward()
    page.go_forward()
    page.reload()
    expect(page).to_have_url(sorted_by_name)
    expect(page.get_by_role("searchbox")).to_have_value("van 12")
    expect(page.get_by_role("columnheader", name="Name")).to_have_attribute("aria-sort", "ascending")
    with Visitor.at_work(chromium, manager.address) as colleague:
        colleague.sign_in()
        colleague.page.goto(sorted_by_name)
        expect(rows(colleague.page).first).to_contain_text("Van 120")
        expect(tile(colleague.page, "Waiting")).to_have_attribute("aria-pressed", "true")
        colleague.page.goto(f"{manager.address}/devices?stage=asleep&sort=colour")
        expect(rows(colleague.page).first).to_contain_text("Van 1")


def test_the_list_is_sorted_by_its_heads(manager: Visitor) -> None:
    page = manager.page
    expect(page.get_by_role("columnheader", name="Id")).to_have_attribute("aria-sort", "ascending")
    for head, sort, first in (
        ("Id", "descending", fleets.id_of(MANY)),
        ("Name", "ascending", fleets.id_of(1)),
        ("Name", "descending", fleets.id_of(9999)),
        ("Last data", "descending", fleets.id_of(1)),
        ("Last data", "ascending", None),
    ):
        page.get_by_role("columnheader", name=head).get_by_role("button").click()
        expect(page.get_by_role("columnheader", name=head)).to_have_attribute("aria-sort", sort)
        expect(rows(page).first).to_contain_text(first or "5 days ago")
    expect(page.get_by_role("columnheader", name="Id")).to_have_attribute("aria-sort", "none")
    expect(page.get_by_role("columnheader", name="Vehicle").get_by_role("button")).to_have_count(0)
    manager.assert_accessible()


def test_another_order_begins_at_the_top(manager: Visitor) -> None:
    page = manager.page
    page.evaluate("scrollTo(0, 100000)")
    expect(rows(page).first).to_be_visible()
    page.get_by_role("columnheader", name="Name").get_by_role("button").click()
    expect(page.locator("[data-index='0']")).to_be_in_viewport()
    page.go_back()
    expect(page.get_by_role("columnheader", name="Id")).to_have_attribute("aria-sort", "ascending")


def test_a_phone_sorts_and_filters_too(chromium: Browser, large: str) -> None:
    with Visitor.at_work(chromium, large, width=360, height=740, has_touch=True) as visitor:
        visitor.sign_in()
        page = visitor.page
        expect(page.get_by_role("list", name="Devices").get_by_role("listitem").first).to_contain_text("Van 1")
        visitor.assert_fits()
        tile(page, "Suspect mounting").click()
        expect(rows(page).first).to_contain_text("Suspect")
        page.get_by_role("combobox", name="Sort by").select_option("Name, Z to A")
        expect(page).to_have_url(f"{large}/devices?mount_status=suspect&sort=-name")
        item = page.get_by_role("listitem").first
        assert item.get_attribute("aria-posinset") == "1"
        assert item.get_attribute("aria-setsize") == str(count_of(page, "Suspect mounting"))
        boxes = [box for button in page.get_by_role("button").all() if (box := button.bounding_box())]
        assert min(box["height"] for box in boxes) >= 42
        visitor.assert_fits()
        visitor.assert_accessible()


# ---------------------------------------------------------------- ten thousand rows


def test_ten_thousand_devices_are_scrolled_to_the_end(manager: Visitor) -> None:
    page = manager.page
    table = page.get_by_role("table", name="Devices")
    expect(table).to_have_attribute("aria-rowcount", str(MANY + 1))
    for part in (0.1, 0.5, 0.9, 1.0):
        page.evaluate("part => scrollTo(0, part * document.documentElement.scrollHeight)", part)
        page.wait_for_timeout(100)
        assert page.locator("[data-index]").count() < MOST_ROWS
    last = rows(page).last
    expect(last).to_contain_text(fleets.id_of(MANY), timeout=60_000)
    expect(last).to_have_attribute("aria-rowindex", str(MANY + 1))
    expect(last).to_be_in_viewport()
    shown = [int(name.removeprefix("Van ")) for name in names(page)]
    assert shown == list(range(MANY - len(shown) + 1, MANY + 1))
    assert page.evaluate("document.querySelectorAll('*').length") < 2000
    manager.assert_accessible()


def test_the_frame_rate_can_be_measured(manager: Visitor) -> None:
    assert scroll_frame_rate(manager.page, seconds=1.0) > 0
    assert manager.page.evaluate("scrollY") > 100_000


def test_a_row_far_down_changes_in_place(manager: Visitor) -> None:
    page = manager.page
    number = 4003
    page.evaluate("scrollTo(0, document.documentElement.scrollHeight * 0.4)")
    row = rows(page).filter(has_text=fleets.id_of(number))
    expect(row).to_contain_text(fleets.stage_of(number).capitalize(), timeout=60_000)
    before = page.evaluate("scrollY"), names(page)
    stage = _send(manager.address, fleets.id_of(number), drives.plain().chunks[0])
    assert stage != fleets.stage_of(number)
    expect(row).to_contain_text(stage.capitalize())
    assert (page.evaluate("scrollY"), names(page)) == before


def _send(address: str, device_id: str, chunk: bytes) -> str:
    """Send a chunk as a device; give the stage after it."""
    with httpx.Client(base_url=address, timeout=60.0) as client:
        admin = Api(client)
        device = Device(admin, device_id, admin.post(f"/devices/{device_id}/key")["key"])
        stage: str = device.send(chunk, 0, expect=200).json()["installation"]["stage"]
    return stage


def test_the_keyboard_goes_from_row_to_row(manager: Visitor) -> None:
    page = manager.page

    def focused() -> Locator:
        return page.locator("[data-index] a:focus")

    rows(page).first.get_by_role("link").focus()
    page.keyboard.press("ArrowDown")
    page.keyboard.press("ArrowDown")
    expect(focused()).to_have_text("Van 3")
    page.keyboard.press("ArrowUp")
    expect(focused()).to_have_text("Van 2")
    page.keyboard.press("PageDown")
    expect(focused()).not_to_have_text("Van 2")
    page.keyboard.press("End")
    expect(focused()).to_have_text(f"Van {MANY}", timeout=60_000)
    expect(focused()).to_be_in_viewport()
    page.keyboard.press("ArrowDown")
    expect(focused()).to_have_text(f"Van {MANY}")
    page.keyboard.press("PageUp")
    page.keyboard.press("ArrowUp")
    expect(focused()).not_to_have_text(f"Van {MANY}")
    page.keyboard.press("Home")
    expect(focused()).to_have_text("Van 1")
    for _ in range(30):
        page.keyboard.press("ArrowDown")
    expect(focused()).to_have_text("Van 31")
    covered = page.get_by_role("columnheader", name="Id").bounding_box()
    row = focused().bounding_box()
    assert covered is not None
    assert row is not None
    assert row["y"] > covered["y"] + covered["height"]
    page.keyboard.press("Shift+Tab")  # one step leaves the table, however long it is
    expect(page.get_by_role("button", name="Last data")).to_be_focused()
    page.keyboard.press("Tab")
    page.keyboard.press("Enter")
    expect(page).to_have_url(re.compile(r"/devices/dev-000\d\d$"))


def test_one_comes_back_to_where_one_was(manager: Visitor) -> None:
    page = manager.page
    page.evaluate("scrollTo(0, 20000)")
    expect(rows(page).filter(has_text="dev-00350")).to_have_count(1)
    page.get_by_role("link", name="Van 350", exact=True).click()
    expect(page.get_by_role("heading", level=1)).to_contain_text("Van 350")
    assert page.evaluate("scrollY") == 0
    page.go_back()
    expect(page.get_by_role("link", name="Van 350", exact=True)).to_be_in_viewport()


def test_rows_that_cannot_be_read_are_asked_for_again(manager: Visitor) -> None:
    page = manager.page
    manager.tolerated += ("ERR_FAILED", "503 (Service Unavailable)")
    page.route(re.compile(r"/api/v1/devices\?.*cursor="), lambda route: route.fulfill(status=404))
    manager.tolerated += ("404 (Not Found)",)
    page.evaluate("scrollTo(0, 300000)")
    expect(page.get_by_role("alert")).to_contain_text("Could not load the devices")
    page.unroute_all()
    page.get_by_role("button", name="Try again").click()
    expect(rows(page).last).to_contain_text("Van", timeout=60_000)
    expect(page.get_by_role("alert")).to_have_count(0)


# ---------------------------------------------------------------- nothing to list


def test_an_empty_fleet_says_what_to_do(visitor: Visitor, installer: Visitor, api: Api) -> None:
    for somebody in (visitor, installer):
        somebody.sign_in()
        somebody.see("No devices yet")
        steps = somebody.page.get_by_role("main").get_by_role("listitem")
        expect(steps).to_have_count(3)
        expect(steps.nth(1)).to_contain_text(f"--server {somebody.address}")
        assert somebody.page.get_by_role("link", name="description of the API").get_attribute("href") == "/docs"
        somebody.assert_fits()
        somebody.assert_accessible()
    api.add_device("van-1", name="Van 1")
    visitor.see("Van 1")
    expect(visitor.page.get_by_role("button", name="All 1")).to_be_visible()


def test_restrictions_that_leave_nothing_are_taken_away_one_by_one(visitor: Visitor, api: Api) -> None:
    api.add_device("van-1", name="Van 1")
    visitor.sign_in()
    visitor.page.goto(f"{visitor.address}/devices?q=bus&stage=waiting&alert_kind=device_silent&sort=-name")
    page = visitor.page
    visitor.see("No device matches")
    visitor.assert_accessible()
    page.get_by_role("button", name="Take away: Open alert: Silent").click()
    visitor.see("No device matches")
    expect(page).to_have_url(f"{visitor.address}/devices?q=bus&stage=waiting&sort=-name")
    page.get_by_role("button", name="Take away: Search: bus").click()
    expect(rows(page)).to_have_count(1)
    expect(page.get_by_role("searchbox")).to_have_value("")
    page.get_by_role("searchbox").fill("bus")
    page.get_by_role("button", name="Show all devices").click()
    expect(page).to_have_url(f"{visitor.address}/devices?sort=-name")
    expect(rows(page)).to_have_count(1)


# ---------------------------------------------------------------- adding a device


def open_scanner(page: Page) -> Locator:
    page.get_by_role("button", name="Add a device").first.click()
    dialog = page.get_by_role("dialog")
    dialog.get_by_role("textbox", name="Name").fill("Van 12")
    dialog.get_by_role("button", name="Scan the device id").click()
    return dialog


@contextmanager
def with_camera(chromium: Browser, address: str, *switches: str) -> Iterator[Visitor]:
    """Somebody in a workshop whose phone has a camera, or is told that it has."""
    browser = chromium.browser_type.launch(
        executable_path=shutil.which("chromium"), args=[*SWITCHES, "--use-fake-device-for-media-stream", *switches]
    )
    try:
        with Visitor.at_work(browser, address, width=360, height=740) as somebody:
            somebody.tolerated += WITHOUT_HTTPS
            somebody.sign_in()
            yield somebody
    finally:
        browser.close()


def filmed(path: Path, text: str) -> list[str]:
    film = codes.film(path / "label.y4m", codes.picture(text))
    return ["--use-fake-ui-for-media-stream", f"--use-file-for-fake-video-capture={film}"]


@pytest.mark.parametrize("label", ["van-12", "livella:van-12", "{address}/devices/van-12"])
def test_the_id_is_scanned(chromium: Browser, address: str, api: Api, tmp_path: Path, label: str) -> None:
    with with_camera(chromium, address, *filmed(tmp_path, label.format(address=address))) as somebody:
        dialog = open_scanner(somebody.page)
        expect(dialog.get_by_role("textbox", name="Device id")).to_have_value("van-12", timeout=30_000)
        expect(dialog.get_by_role("status").filter(has_text="Scanned: van-12")).to_be_visible()
        expect(dialog.get_by_role("textbox", name="Name")).to_have_value("Van 12")
        somebody.assert_accessible()
        dialog.get_by_role("button", name="Add", exact=True).click()
        somebody.see("This key is shown only now")
        assert api.get("/devices/van-12")["name"] == "Van 12"


def test_a_code_that_is_no_id_is_explained(chromium: Browser, address: str, api: Api, tmp_path: Path) -> None:
    with with_camera(chromium, address, *filmed(tmp_path, "S/N 4711")) as somebody:
        dialog = open_scanner(somebody.page)
        told = dialog.get_by_role("status").filter(has_text="This code is not a device id")
        expect(told).to_contain_text("there is / and a blank", timeout=30_000)
        expect(told).to_contain_text("S/N 4711")
        somebody.assert_fits()
        somebody.assert_accessible()
        somebody.picture("scanner-360")
        dialog.get_by_role("button", name="Type it instead").click()
        expect(dialog.get_by_role("textbox", name="Device id")).to_be_focused()
        expect(dialog.get_by_role("textbox", name="Device id")).to_have_value("")


def test_the_camera_is_switched_off_when_it_is_no_longer_needed(
    chromium: Browser, address: str, api: Api, tmp_path: Path
) -> None:
    with with_camera(chromium, address, *filmed(tmp_path, "S/N 4711")) as somebody:
        page = somebody.page
        dialog = open_scanner(page)
        expect(dialog.locator("video")).to_have_js_property("paused", False)
        page.evaluate("window.tracks = document.querySelector('video').srcObject.getTracks()")
        assert page.evaluate("tracks.map(track => track.readyState)") == ["live"]
        dialog.get_by_role("button", name="Type it instead").click()
        expect(dialog.locator("video")).to_have_count(0)
        assert page.evaluate("tracks.map(track => track.readyState)") == ["ended"]


def test_a_refused_camera_is_told_and_a_photo_does_as_well(chromium: Browser, address: str, api: Api) -> None:
    with with_camera(chromium, address) as somebody:
        dialog = open_scanner(somebody.page)
        expect(dialog.get_by_role("status").filter(has_text="The camera was not allowed")).to_be_visible()
        somebody.assert_accessible()
        photo = dialog.locator("input[type=file]")
        assert photo.get_attribute("capture") == "environment"
        assert photo.get_attribute("accept") == "image/*"
        for content, words in ((codes.png(codes.picture(None)), "No code was found"), (b"no picture", "not a picture")):
            photo.set_input_files({"name": "photo.png", "mimeType": "image/png", "buffer": content})
            expect(dialog.get_by_role("status").filter(has_text=words)).to_be_visible()
        label = codes.png(codes.picture("van-12"))
        with somebody.page.expect_file_chooser() as chooser:
            dialog.get_by_role("button", name="Take a photo").click()
        chooser.value.set_files({"name": "photo.png", "mimeType": "image/png", "buffer": label})
        expect(dialog.get_by_role("textbox", name="Device id")).to_have_value("van-12")


def test_a_workshop_without_https_takes_a_photo(chromium: Browser, address: str, api: Api) -> None:
    plain = address.replace("127.0.0.1", "workshop.example")
    with with_camera(chromium, plain, "--host-resolver-rules=MAP workshop.example 127.0.0.1") as somebody:
        assert somebody.page.evaluate("[isSecureContext, 'mediaDevices' in navigator]") == [False, False]
        dialog = open_scanner(somebody.page)
        expect(dialog.get_by_role("status").filter(has_text="No live camera on this address")).to_be_visible()
        label = codes.png(codes.picture(f"{plain}/devices/van-12"))
        dialog.locator("input[type=file]").set_input_files({"name": "a.png", "mimeType": "image/png", "buffer": label})
        expect(dialog.get_by_role("textbox", name="Device id")).to_have_value("van-12")


def test_a_desk_without_a_camera_is_told(visitor: Visitor, api: Api) -> None:
    visitor.sign_in()
    dialog = open_scanner(visitor.page)
    expect(dialog.get_by_role("status").filter(has_text="There is no camera")).to_be_visible()


def test_the_key_is_shown_once_and_its_code_can_be_scanned(visitor: Visitor, api: Api) -> None:
    visitor.sign_in()
    page = visitor.page
    page.get_by_role("button", name="Add a device").first.click()
    dialog = page.get_by_role("dialog")
    dialog.get_by_role("textbox", name="Name").fill("Van 12")
    dialog.get_by_role("button", name="Add", exact=True).click()
    visitor.see("This key is shown only now")
    key = dialog.locator("code").first.inner_text()
    assert codes.read(dialog.get_by_role("img", name="QR code of the key of Van 12")) == key
    visitor.assert_accessible()
    page.keyboard.press("Escape")
    page.keyboard.press("Enter")
    expect(dialog).to_be_visible()  # nothing but a button closes it: the key would be lost
    dialog.get_by_role("button", name="Done").click()
    expect(dialog).to_be_hidden()
    assert key not in page.content()
    (device,) = api.get("/devices")["items"]
    assert api.as_(key).get(f"/devices/{device['id']}/installation")["stage"] == "waiting"
    expect(page.get_by_role("link", name="Van 12")).to_be_visible()
    expect(page.get_by_role("button", name="Add a device")).to_be_focused()
