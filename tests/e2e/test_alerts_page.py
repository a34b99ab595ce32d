"""What is wrong over the fleet: found, told, dealt with, by several people at once."""

import re
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from typing import Literal, NamedTuple

import pytest
from playwright.sync_api import Browser, Locator, Route, expect

from tests import drives
from tests.cli import livella
from tests.e2e import findings
from tests.e2e.visitor import Visitor
from tests.service import ADMIN_KEY, Api

pytestmark = pytest.mark.browser

SIZES = {"desk": (1280, 900), "phone": (360, 740)}


class Service(NamedTuple):
    address: str
    database_url: str


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """A service whose database the tests reach."""
    directory = tmp_path_factory.mktemp("alerts")
    with livella.serving(directory, LIVELLA_ADMIN_KEY=ADMIN_KEY) as (url, _):
        yield Service(url, f"sqlite:///{directory / 'data' / 'livella.db'}")


@pytest.fixture(scope="module")
def address(service: Service) -> str:
    return service.address


def key_of(api: Api, role: str, name: str) -> str:
    key: str = api.post("/keys", {"role": role, "name": name}, 201)["key"]
    return key


def lose_gps(service: Service, *devices: str, ago: float = 0.0) -> list[int]:
    """Raise `gps_lost` for devices, the last one newest; `ago`: so many s before now."""
    now = datetime.now(UTC) - timedelta(seconds=ago)
    found = [(device, now + timedelta(milliseconds=n)) for n, device in enumerate(devices)]
    return [findings.raise_(service.database_url, device, findings.lost(now), at) for device, at in found]


def alerts(visitor: Visitor) -> Locator:
    return visitor.page.get_by_role("list", name="List of alerts").get_by_role("article")


def settle(visitor: Visitor, verb: str, note: str = "") -> None:
    """Fill in the dialog that is open."""
    dialog = visitor.page.get_by_role("dialog")
    dialog.get_by_role("textbox", name="Note").fill(note)
    dialog.get_by_role("button", name=verb).click()


def test_a_moved_device_is_told_acknowledged_and_over_without_reload(visitor: Visitor, api: Api) -> None:
    story = drives.remounted()
    device = api.add_device("van-1", name="Van 1")
    device.send_all(story.chunks[: story.moved])
    visitor.sign_in(key_of(api, "manager", "Anna Bianchi"))
    visitor.open("/alerts")
    visitor.see("Nothing is unresolved")
    visitor.assert_accessible()
    loads = visitor.loads

    device.send(story.chunks[story.moved], story.moved, expect=200)
    (found,) = api.get("/alerts")["items"]
    shown = alerts(visitor)
    expect(shown).to_contain_text(found["message"])
    expect(shown.get_by_role("heading")).to_have_text(re.compile("The device was (turned|leaned|tipped)"))
    expect(shown.get_by_role("link", name="Van 1")).to_have_attribute("href", "/devices/van-1")
    shown.get_by_text("Details").click()
    expect(shown).to_contain_text("Drive on: the new mounting is found")
    expect(shown.get_by_role("img")).to_have_count(0 if found["data"]["evidence"] is None else 1)
    shown.get_by_role("button", name="Acknowledge").click()
    settle(visitor, "Acknowledge", "The driver moved it; I call him.")
    expect(visitor.page.get_by_role("status").filter(has_text="1 alert acknowledged.")).to_be_visible()
    expect(shown).to_contain_text("Acknowledged by Anna Bianchi")
    assert visitor.loads == loads

    visitor.page.reload()
    alerts(visitor).get_by_text("Details").click()
    expect(alerts(visitor)).to_contain_text("Acknowledged by Anna Bianchi")
    expect(alerts(visitor)).to_contain_text("The driver moved it; I call him.")
    for seq in range(story.moved + 1, story.confirmed_anew + 1):
        device.send(story.chunks[seq], seq, expect=200)
    visitor.see("Nothing is unresolved")
    visitor.page.get_by_role("button", name="Resolved", exact=True).click()
    alerts(visitor).get_by_text("Details").click()
    expect(alerts(visitor)).to_contain_text("Resolved by the service")


def test_several_at_once_of_which_some_do_not_go_through(visitor: Visitor, api: Api, service: Service) -> None:
    names = [f"van-{n}" for n in range(1, 5)]
    for name in names:
        api.add_device(name)
    numbers = dict(zip(names, lose_gps(service, *names), strict=True))
    colleague = api.as_(key_of(api, "manager", "Bruno"))
    visitor.sign_in(key_of(api, "manager", "Anna"))
    visitor.open("/alerts")
    page = visitor.page
    page.get_by_role("checkbox", name="Select all shown").check()
    bar = page.get_by_role("region", name="With the selected alerts")
    expect(bar).to_contain_text("4 selected")
    bar.get_by_role("button", name="Acknowledge (4)").click()
    dialog = page.get_by_role("dialog")

    colleague.post(f"/alerts/{numbers['van-1']}/resolve", {"note": "cable"})
    api.call("DELETE", "/devices/van-2", 204)
    page.context.route(f"**/alerts/{numbers['van-3']}/acknowledge", lambda route: route.abort())
    visitor.tolerated += ("404 (Not Found)", "ERR_FAILED")
    settle(visitor, "Acknowledge", "together")
    expect(dialog).to_contain_text("2 alerts failed")
    expect(dialog).to_contain_text("There is no such alert.")
    expect(dialog).to_contain_text("does not answer")
    expect(dialog).to_contain_text("already resolved by Bruno")
    assert [shown_state(api, numbers[name]) for name in ("van-1", "van-3", "van-4")] == [
        ("resolved", None),
        ("open", None),
        ("acknowledged", "together"),
    ]
    visitor.assert_accessible()

    page.context.unroute_all()
    dialog.get_by_role("button", name="Try again").click()
    expect(dialog).to_contain_text("1 alert failed")
    expect(dialog).not_to_contain_text("does not answer")
    assert shown_state(api, numbers["van-3"]) == ("acknowledged", "together")
    dialog.get_by_role("button", name="Close").last.click()
    expect(alerts(visitor)).to_have_count(2)
    bar.get_by_role("button", name="Resolve (2)").click()
    settle(visitor, "Resolve")
    visitor.see("Nothing is unresolved")
    expect(dialog).to_be_hidden()


def shown_state(api: Api, number: int) -> tuple[str, str | None]:
    alert = api.get(f"/alerts/{number}")
    return alert["state"], alert["acknowledge_note"]


def test_at_most_four_requests_run_at_the_same_time(visitor: Visitor, api: Api, service: Service) -> None:
    names = [f"van-{n:02}" for n in range(10)]
    for name in names:
        api.add_device(name)
    lose_gps(service, *names)
    visitor.sign_in()
    visitor.open("/alerts")
    page = visitor.page
    held: list[Route] = []

    def hold(route: Route) -> None:
        held.append(route)

    page.context.route("**/alerts/*/resolve", hold)
    page.get_by_role("checkbox", name="Select all shown").check()
    page.get_by_role("button", name="Resolve (10)").click()
    settle(visitor, "Resolve")
    most = 0
    for _ in names:
        page.wait_for_timeout(200)
        most = max(most, len(held))
        held.pop(0).continue_()
    visitor.see("Nothing is unresolved")
    assert most == 4


def test_what_is_unread_stands_in_the_title_of_every_page(visitor: Visitor, api: Api, service: Service) -> None:
    for name in ("van-1", "van-2", "van-3"):
        api.add_device(name)
    lose_gps(service, "van-1", ago=60)
    visitor.sign_in(key_of(api, "manager", "Anna"))
    page = visitor.page
    visitor.open("/settings/about")
    expect(page).to_have_title("(1) About · Livella")
    lose_gps(service, "van-2")
    expect(page).to_have_title("(2) About · Livella")
    page.get_by_role("link", name="Alerts").click()
    expect(page).to_have_title("Alerts · Livella")
    page.get_by_role("link", name="Settings").click()
    page.get_by_role("link", name="About").click()
    expect(page).to_have_title("About · Livella")
    (number,) = lose_gps(service, "van-3")
    expect(page).to_have_title("(1) About · Livella")
    page.reload()
    expect(page).to_have_title("(1) About · Livella")
    api.post(f"/alerts/{number}/acknowledge", {})
    expect(page).to_have_title("About · Livella")


def test_the_title_counts_on_while_nobody_looks_at_the_page(visitor: Visitor, api: Api, service: Service) -> None:
    api.add_device("van-1")
    api.add_device("van-2")
    lose_gps(service, "van-1")
    page = visitor.page
    page.clock.install()
    visitor.sign_in(key_of(api, "manager", "Anna"))
    visitor.open("/settings/about")
    expect(page).to_have_title("(1) About · Livella")
    page.evaluate(LOOK_AWAY)
    page.clock.run_for(31_000)
    visitor.see("Paused")
    lose_gps(service, "van-2")
    page.clock.run_for(61_000)
    expect(page).to_have_title("(2) About · Livella")


LOOK_AWAY = """() => {
    Object.defineProperty(document, "hidden", { value: true });
    Object.defineProperty(document, "visibilityState", { value: "hidden" });
    document.dispatchEvent(new Event("visibilitychange"));
}"""


def test_who_may_not_read_alerts_is_not_told_of_them(visitor: Visitor, api: Api, service: Service) -> None:
    own = api.add_device("van-1")
    lose_gps(service, "van-1")
    asked: list[str] = []
    visitor.page.on("request", lambda request: asked.append(request.url) if "/api/v1/alerts" in request.url else None)
    for key, home in ((key_of(api, "installer", "Ida"), "/devices"), (own.key, "/devices/van-1")):
        visitor.sign_in(key)
        visitor.open("/alerts")
        expect(visitor.page).to_have_url(visitor.address + home)
        expect(visitor.page.get_by_role("link", name="Alerts")).to_have_count(0)
        visitor.page.get_by_role("button", name="Account").click()
        visitor.page.get_by_role("button", name="Sign out").click()
        visitor.see("Sign in")
    assert asked == []


def test_the_filters_stand_in_the_address(visitor: Visitor, api: Api, service: Service) -> None:
    for n in range(1, 6):
        api.add_device(f"van-{n}", name=f"Van {n}")
    kinds = findings.raise_every_kind(service.database_url)
    visitor.sign_in()
    visitor.open("/alerts")
    page = visitor.page
    expect(alerts(visitor)).to_have_count(len(kinds))
    page.get_by_role("combobox", name="Severity").select_option("Critical")
    expect(alerts(visitor)).to_have_count(4)
    page.get_by_role("combobox", name="Kind").select_option("Sensor fault")
    expect(alerts(visitor)).to_have_count(2)
    expect(page).to_have_url(visitor.address + "/alerts?kind=sensor_fault&severity=critical")
    page.get_by_label("Device", exact=True).fill("van-4")
    expect(alerts(visitor)).to_have_text([re.compile("An axis of the sensor is stuck")])
    page.reload()
    expect(alerts(visitor)).to_have_count(1)
    tomorrow = (datetime.now() + timedelta(days=2)).strftime("%Y-%m-%d")
    page.get_by_label("Opened from").fill(tomorrow)
    visitor.see("No alert matches")
    page.get_by_role("button", name="Show all unresolved alerts").click()
    expect(page).to_have_url(visitor.address + "/alerts")
    expect(alerts(visitor)).to_have_count(len(kinds))
    page.get_by_role("button", name="Acknowledged", exact=True).click()
    visitor.see("No alert matches")


def test_long_lists_come_as_one_goes_down(visitor: Visitor, api: Api, service: Service) -> None:
    api.add_device("van-1")
    for n in range(60, 0, -1):
        (number,) = lose_gps(service, "van-1", ago=60.0 * n)
        api.post(f"/alerts/{number}/resolve", {})
    (open_one,) = lose_gps(service, "van-1")
    visitor.sign_in()
    visitor.open("/alerts?state=all")
    expect(alerts(visitor)).to_have_count(50)
    alerts(visitor).last.scroll_into_view_if_needed()
    expect(alerts(visitor)).to_have_count(61)
    expect(visitor.page.get_by_role("button", name="Show more")).to_have_count(0)
    api.post(f"/alerts/{open_one}/resolve", {})
    expect(alerts(visitor).filter(has_text="Opened").first).to_contain_text("Resolved")
    expect(alerts(visitor)).to_have_count(61)


def test_a_link_leads_to_one_alert_unfolded(visitor: Visitor, api: Api, service: Service) -> None:
    api.add_device("van-1", name="Van 1")
    api.add_device("van-2", name="Van 2")
    number, _ = lose_gps(service, "van-1", "van-2")
    visitor.sign_in()
    visitor.open(f"/alerts?id={number}")
    page = visitor.page
    expect(page.get_by_role("article")).to_have_count(1)
    visitor.see("What to do")
    visitor.see("check antenna, cable and plug")
    page.get_by_role("button", name="Resolve").click()
    settle(visitor, "Resolve", "plugged in")
    expect(page.get_by_role("article")).to_contain_text("plugged in")
    expect(page.get_by_role("article").get_by_role("button")).to_have_count(0)
    page.get_by_role("link", name="All alerts").click()
    expect(alerts(visitor)).to_have_text([re.compile("Van 2")])
    visitor.tolerated += ("404 (Not Found)",)
    visitor.open("/alerts?id=4711")
    visitor.see("There is no alert 4711")


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("size", SIZES)
def test_every_kind_is_told_in_both_languages(
    chromium: Browser, api: Api, service: Service, size: str, scheme: Literal["light", "dark"]
) -> None:
    for n in range(1, 6):
        api.add_device(f"van-{n}", name=f"Van {n}")
    kinds = findings.raise_every_kind(service.database_url)
    width, height = SIZES[size]
    with Visitor.at_work(chromium, service.address, width, height, color_scheme=scheme) as visitor:
        visitor.sign_in()
        visitor.open("/alerts")
        for kind in kinds:
            visitor.see(kind.english)
        for summary in visitor.page.get_by_text("Details").all()[:4]:
            summary.click()
        visitor.assert_accessible()
        visitor.picture(f"alerts-{size}-{scheme}")
        visitor.page.evaluate("localStorage.setItem('livella-language', 'it')")
        visitor.page.reload()
        visitor.see("Non risolti")
        for kind in kinds:
            visitor.see(kind.italian)
        message = api.get("/alerts")["items"][0]["message"]
        visitor.page.get_by_text("Dettagli").first.click()
        expect(visitor.page.locator("[lang=en]", has_text=message)).to_be_visible()
        visitor.page.get_by_role("checkbox", name="Seleziona tutti").check()
        visitor.assert_accessible()
        visitor.picture(f"alerts-italian-{size}-{scheme}")
        visitor.page.get_by_role("button", name=re.compile(f"Prendi in carico .*{len(kinds)}")).click()
        expect(visitor.page.get_by_role("dialog")).to_be_visible()
        visitor.assert_accessible()
        visitor.assert_fits()
