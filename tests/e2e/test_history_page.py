"""The fleet manager's half of a device's page: its past, its mountings, and what became of its data."""

import csv
import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import httpx
import pytest
from playwright.sync_api import Browser, Download, Locator, Page, expect

from api.formats.writer import write_native_csv
from tests import drives
from tests.e2e.visitor import Visitor
from tests.service import ADMIN_KEY, Api, Device
from tests.watched import parked

pytestmark = pytest.mark.browser

CHART = "Yaw over time"


@pytest.fixture(scope="module")
def moved(address: str) -> Iterator[Device]:
    """A device that was confirmed, was turned, and was confirmed anew."""
    with httpx.Client(base_url=address, timeout=60.0) as client:
        admin = Api(client)
        for known in admin.get("/devices", params={"limit": 500})["items"]:
            admin.call("DELETE", f"/devices/{known['id']}", 204)
        device = admin.add_device("van-1", name="Van 1")
        device.send_all(drives.remounted().chunks)
        yield device


@pytest.fixture
def page(visitor: Visitor, moved: Device) -> Page:
    """The history of that device at a desk."""
    return opened(visitor)


def opened(visitor: Visitor, key: str = ADMIN_KEY) -> Page:
    visitor.sign_in(key)
    visitor.open("/devices/van-1")
    visitor.scroll_to("Angle history")
    chart = visitor.page.get_by_role("img", name=CHART)
    expect(chart).to_be_visible(timeout=20_000)
    chart.scroll_into_view_if_needed()
    return visitor.page


def history(page: Page) -> Locator:
    return page.get_by_role("region", name="Angle history")


def span(page: Page) -> Locator:
    """The time that is shown, in words."""
    return history(page).get_by_role("status").first


@contextmanager
def changed(shown: Locator) -> Iterator[None]:
    before = shown.text_content() or ""
    yield
    expect(shown).not_to_have_text(before)


def middle(page: Page) -> tuple[float, float]:
    box = page.get_by_role("img", name=CHART).bounding_box()
    assert box is not None
    return box["x"] + 0.6 * box["width"], box["y"] + 0.4 * box["height"]


def rested(page: Page) -> tuple[float, float]:
    """The same, clear of the page's head, once it stands still: a swipe goes on by itself, what appears moves it."""
    page.get_by_role("img", name=CHART).evaluate("chart => chart.scrollIntoView({ block: 'center' })")
    before, now = None, middle(page)
    while now != before:
        page.wait_for_timeout(300)
        before, now = now, middle(page)
    return now


def scrolled(page: Page) -> float:
    height: float = page.evaluate("scrollY")
    return height


def test_buttons_zoom_and_move_for_the_keyboard(page: Page) -> None:
    whole = span(page).text_content() or ""
    press = page.keyboard.press
    page.get_by_role("button", name="Zoom in").focus()
    with changed(span(page)):
        press("Enter")
    with changed(span(page)):
        page.get_by_role("button", name="Earlier").focus()
        press("Enter")
    with changed(span(page)):
        page.get_by_role("button", name="Later").focus()
        press("Space")
    page.get_by_role("button", name="Zoom out").click()
    expect(span(page)).to_have_text(whole)
    page.get_by_role("button", name="Reset zoom").click()
    expect(page.get_by_role("button", name="Reset zoom")).to_be_hidden()
    expect(span(page)).to_have_text(whole)


def test_the_wheel_scrolls_the_page_until_it_is_zoomed_with_ctrl(page: Page) -> None:
    page.mouse.move(*middle(page))
    whole, height = span(page).text_content() or "", scrolled(page)
    page.mouse.wheel(0, -60)
    page.wait_for_function("height => scrollY < height", arg=height)
    expect(span(page)).to_have_text(whole)
    page.mouse.move(*middle(page))
    with changed(span(page)):
        page.keyboard.down("Control")
        page.mouse.wheel(0, -300)
        page.mouse.wheel(0, -300)
        page.keyboard.up("Control")
    height = scrolled(page)
    with changed(span(page)):
        page.mouse.wheel(0, -40)
    assert scrolled(page) == height
    page.mouse.dblclick(*middle(page))
    expect(span(page)).to_have_text(whole)


def test_dragging_zooms_and_with_shift_moves(page: Page) -> None:
    x, y = middle(page)
    page.mouse.move(x - 200, y)
    with changed(span(page)):
        drag(page, x, y)
    with changed(span(page)):
        page.keyboard.down("Shift")
        drag(page, x + 150, y)
        page.keyboard.up("Shift")
    expect(page.get_by_role("button", name="Reset zoom")).to_be_visible()


def drag(page: Page, x: float, y: float) -> None:
    page.mouse.down()
    page.mouse.move(x, y, steps=5)
    page.mouse.up()


def test_fingers_zoom_and_move_and_the_page_still_scrolls(chromium: Browser, address: str, moved: Device) -> None:
    options: dict[str, Any] = {"has_touch": True, "is_mobile": True}
    with Visitor.at_work(chromium, address, 360, 740, **options) as visitor:
        page = opened(visitor)
        x, y = middle(page)
        whole = span(page).text_content() or ""
        fingers = Fingers(page)
        height = scrolled(page)
        fingers.move([(x, y)], [(x, y - 200)])
        page.wait_for_function("height => scrollY > height + 100", arg=height)
        expect(span(page)).to_have_text(whole)
        x, y = rested(page)
        with changed(span(page)):
            fingers.move([(x - 20, y), (x + 20, y)], [(x - 120, y), (x + 70, y)])
        x, y = rested(page)
        with changed(span(page)):
            fingers.move([(x, y)], [(x + 90, y)])
        visitor.assert_fits()


class Fingers:
    """Fingers on a screen."""

    def __init__(self, page: Page) -> None:
        self.session = page.context.new_cdp_session(page)

    def move(self, begin: list[tuple[float, float]], end: list[tuple[float, float]], steps: int = 10) -> None:
        self._send("touchStart", begin)
        for step in range(1, steps + 1):
            share = step / steps
            pairs = zip(begin, end, strict=True)
            self._send("touchMove", [(x + share * (u - x), y + share * (v - y)) for (x, y), (u, v) in pairs])
        self._send("touchEnd", [])

    def _send(self, kind: str, places: list[tuple[float, float]]) -> None:
        points = [{"x": x, "y": y, "id": i} for i, (x, y) in enumerate(places)]
        self.session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})


def test_the_cursor_tells_value_and_time_also_under_a_finger(page: Page) -> None:
    yaw = page.get_by_role("figure").filter(has_text="Yaw")
    expect(yaw).not_to_contain_text("20")
    page.mouse.move(*middle(page))
    expect(yaw).to_contain_text(re.compile(r"° ± \d.*20\d\d"))
    expect(page.get_by_role("figure").filter(has_text="Roll")).to_contain_text("20")


def test_ranges_ask_for_their_time(page: Page) -> None:
    for name in ("Last day", "Last week", "Last month"):
        with page.expect_request("**/estimates*from=*"):
            choose(page, name)
    with page.expect_request("**/estimates*") as everything:
        choose(page, "Everything")
    assert "from=" not in everything.value.url


def choose(page: Page, name: str) -> None:
    """Choose a time; the whole of its name is for screen readers."""
    page.locator("label", has_text=name).click()
    expect(page.get_by_role("radio", name=name)).to_be_checked()


def test_what_happened_is_listed_and_leads_to_its_place(page: Page, moved: Device) -> None:
    events = history(page).get_by_text("Events in view")
    events.focus()
    page.keyboard.press("Enter")
    listed = history(page).get_by_role("listitem").get_by_role("button")
    for text in ("Session a begins", "Stage: Verifying", "Mounting 1 confirmed", "Alert: Device turned"):
        expect(listed.filter(has_text=text).first).to_be_visible()
    legend = page.get_by_role("list", name="Marks")
    expect(legend).to_contain_text("Mounting confirmed")
    with changed(span(page)):
        listed.filter(has_text="Mounting 1 confirmed").focus()
        page.keyboard.press("Enter")
    expect(listed.filter(has_text="Mounting 1 confirmed")).to_be_focused()
    expect(listed.filter(has_text="Alert: Device turned")).to_have_count(0)


def test_alerts_are_marked_for_managers_only(installer: Visitor, moved: Device) -> None:
    key = moved.admin.post("/keys", {"role": "installer", "name": "Ida"}, expect=201)["key"]
    page = opened(installer, key)
    history(page).get_by_text("Events in view").click()
    listed = history(page).get_by_role("listitem").get_by_role("button")
    expect(listed.filter(has_text="Mounting 1 confirmed")).to_be_visible()
    expect(listed.filter(has_text="Alert")).to_have_count(0)


def test_the_shown_history_is_taken_away_as_the_api_gives_it(page: Page, moved: Device) -> None:
    with page.expect_download() as download:
        page.get_by_role("button", name="Download CSV").click()
    name = download.value.suggested_filename
    assert re.fullmatch(r"livella-van-1-\d{8}T\d{6}Z-\d{8}T\d{6}Z\.csv", name)
    rows = table(download.value)
    told = moved.get("estimates", params={"max_points": 10_000})
    expect(history(page)).to_contain_text(f"{name}: {len(rows)} rows")
    assert [row["session"] for row in rows] == told["session"]
    for column, expected in {
        "t_s": told["t"],
        "roll_deg": told["angles_deg"]["roll"],
        "pitch_deg": told["angles_deg"]["pitch"],
        "yaw_deg": told["angles_deg"]["yaw"],
        "yaw_sigma_deg": [sigma[2] for sigma in told["sigma_deg"]],
        "q_z": [quaternion[3] for quaternion in told["quaternion"]],
    }.items():
        assert [float(row[column]) for row in rows] == expected
    assert [row["stage"] for row in rows] == told["stage"]
    assert all(re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3}Z", row["time_utc"]) for row in rows)
    assert rows[0]["time_utc"][:22] == told["time"][0][:22]


def table(download: Download) -> list[dict[str, str]]:
    return list(csv.DictReader(download.path().read_text().splitlines()))


def test_only_the_zoomed_part_is_taken_away(page: Page, moved: Device) -> None:
    with changed(span(page)):
        page.get_by_role("button", name="Zoom in").click()
    with page.expect_download() as download:
        page.get_by_role("button", name="Download CSV").click()
    rows = table(download.value)
    everything = moved.get("estimates", params={"max_points": 10_000})["t"]
    assert 0.4 * len(everything) < len(rows) < 0.6 * len(everything)


def test_a_download_that_fails_says_so_and_is_tried_again(visitor: Visitor, page: Page) -> None:
    visitor.tolerated += ("503",)
    page.route("**/estimates?max_points=10000*", lambda route: route.fulfill(status=503, json={"detail": "Busy."}))
    page.get_by_role("button", name="Download CSV").click()
    trouble = history(page).get_by_role("alert")
    expect(trouble).to_contain_text("Busy.")
    page.unroute("**/estimates?max_points=10000*")
    with page.expect_download():
        trouble.get_by_role("button", name="Try again").click()
    expect(trouble).to_be_hidden()


def test_a_mounting_unfolds(page: Page, moved: Device) -> None:
    mounts = page.get_by_role("region", name="Confirmed mountings")
    expect(mounts.get_by_role("listitem")).to_have_count(2)
    newest, first = (mounts.get_by_role("listitem").nth(i) for i in (0, 1))
    expect(newest).to_contain_text("In force")
    expect(newest).to_contain_text(
        re.compile(r"Drive test passed: speed error \d\.\d\skm/h after \d+\ss, \d+\.\d\skm/h allowed")
    )
    first.get_by_text("Mounting 1: details").click()
    known = moved.get("mounts/1")
    quaternion = ", ".join(f"{part:.6f}" for part in known["quaternion"])
    expect(first.get_by_text(quaternion)).to_be_visible()
    expect(first.get_by_text("a", exact=True)).to_be_visible()
    expect(first.get_by_role("img", name="Speed over")).to_be_visible()


def test_evidence_has_names_and_units(page: Page) -> None:
    alerts = page.get_by_role("region", name="Alerts")
    alerts.get_by_text("Details").click()
    for name, value in {"Turned by": r"\d+°", "Mounting in doubt": "no. 1", "Its uncertainty, 1 σ": "roll .*°"}.items():
        row = alerts.locator("dl > div").filter(has_text=name)
        expect(row).to_contain_text(re.compile(value))
    expect(alerts.get_by_role("img", name="Evidence went from")).to_be_visible()


def test_everybody_can_use_it_in_italian_too(visitor: Visitor, page: Page) -> None:
    history(page).get_by_text("Events in view").click()
    page.get_by_role("region", name="Data health").scroll_into_view_if_needed()
    visitor.see("Samples, usual rate")
    visitor.assert_accessible()
    page.evaluate("localStorage.setItem('livella-language', 'it')")
    page.reload()
    visitor.scroll_to("Storico degli angoli")
    region = page.get_by_role("region", name="Storico degli angoli")
    expect(region.get_by_role("img", name="Imbardata nel tempo; ultimo valore: ")).to_be_visible()
    expect(region.get_by_role("figure").first).to_contain_text(re.compile(r"Rollio −?\d+,\d° ± \d,\d°"))
    region.get_by_text("Eventi nella vista").click()
    expect(region.get_by_role("list").last).to_contain_text("Fase: Verifica")
    mounts = page.get_by_role("region", name="Montaggi confermati")
    expect(mounts).to_contain_text(re.compile(r"Prova su strada superata: errore di velocità di \d,\d\skm/h"))
    alerts = page.get_by_role("region", name="Avvisi")
    alerts.get_by_text("Dettagli").click()
    expect(alerts).to_contain_text("Girato di")
    page.get_by_role("region", name="Salute dei dati").scroll_into_view_if_needed()
    visitor.see("Ogni blocco è arrivato")
    visitor.assert_accessible()


def test_what_does_not_come_says_so(visitor: Visitor, moved: Device) -> None:
    visitor.tolerated += ("ERR_FAILED",)
    visitor.page.route("**/assets/HistorySection*.js", lambda route: route.abort())
    visitor.sign_in()
    visitor.open("/devices/van-1")
    visitor.scroll_to("Angle history")
    trouble = visitor.page.get_by_role("alert").filter(has_text="the history")
    expect(trouble).to_contain_text("Check the connection", timeout=20_000)
    visitor.page.unroute("**/assets/HistorySection*.js")
    trouble.get_by_role("button", name="Try again").click()
    visitor.scroll_to("Angle history")
    expect(visitor.page.get_by_role("img", name=CHART)).to_be_visible(timeout=20_000)


def test_health_tells_what_was_not_used_and_what_was_lost(installer: Visitor, api: Api) -> None:
    device = api.add_device("van-1", name="Van 1")
    page = installer.page
    installer.sign_in()
    installer.open("/devices/van-1")
    health = page.get_by_role("region", name="Data health")
    health.scroll_into_view_if_needed()
    expect(health).to_contain_text("Nothing came in during this time")
    send(device, 0)
    send(device, 1, start=15.0)  # its first half once more
    send(device, 3)
    page.reload()
    health.scroll_into_view_if_needed()
    expect(health).to_contain_text("1 chunk waits for an earlier one")
    for seq in range(4, 68):  # so many wait that the gap is declared
        send(device, seq)
    page.reload()
    health.scroll_into_view_if_needed()
    expect(health).to_contain_text("1 chunk is lost")
    expect(health).to_contain_text("Session a: chunk 2 never came")
    told = device.get("health")
    number = told["rejected"]["before_previous_sample"]
    reason = health.get_by_role("listitem").filter(has_text="Samples older than the one before")
    expect(reason).to_contain_text(f"{number} (")
    expect(reason).to_contain_text("in the order of their times")
    for name, value in {"Chunks": told["chunks"], "Samples": told["samples"], "GPS fixes": told["fixes"]}.items():
        expect(health.get_by_label("In numbers")).to_contain_text(f"{name}{value:,}")
    for name in ("Samples a second over time", "GPS fixes a second over time", "Readings not used in each chunk"):
        expect(health.get_by_role("img", name=name)).to_be_visible()
    health.get_by_text("Sessions (1)").click()
    expect(health).to_contain_text("Chunks 0 to 67")
    installer.assert_accessible()
    installer.assert_fits()
    with page.expect_request("**/health?hours=720"):
        choose(page, "Last 30 days")
    expect(health).to_contain_text("1 chunk is lost")


def send(device: Device, seq: int, start: float | None = None) -> None:
    """Send half a minute of standing."""
    body = write_native_csv(parked(30.0 * seq if start is None else start, 30.0))
    assert device.send(body, seq).status_code in {200, 202}


def test_the_lower_half_comes_when_it_is_looked_at(visitor: Visitor, api: Api) -> None:
    api.add_device("van-1", name="Van 1").send_all(drives.plain().chunks)
    asked: list[str] = []
    visitor.page.on("request", lambda request: asked.append(request.url))
    visitor.sign_in()
    visitor.open("/devices/van-1")
    visitor.see_stage("Confirmed")
    visitor.page.wait_for_load_state("networkidle")
    assert not [url for url in asked if re.search("/health|HealthSection|HistorySection", url)]
    visitor.scroll_to("Angle history")
    expect(visitor.page.get_by_role("img", name=CHART)).to_be_visible(timeout=20_000)
    visitor.scroll_to("Data health")
    visitor.see("Every chunk has arrived")
