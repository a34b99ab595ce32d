"""The frame of every page: language, colours, where one can go."""

import pytest
from playwright.sync_api import Browser, expect

from tests.e2e.visitor import Visitor
from tests.service import Api

pytestmark = pytest.mark.browser


def test_the_language_is_chosen_at_the_door_and_stays(installer: Visitor, api: Api) -> None:
    page = installer.page
    installer.open()
    page.get_by_role("radiogroup", name="Language").get_by_text("Italiano").click()
    expect(page.get_by_role("button", name="Accedi")).to_be_visible()
    assert page.locator("html").get_attribute("lang") == "it"
    installer.assert_accessible()
    page.reload()
    page.get_by_role("textbox", name="Chiave").fill("livella_wrong")
    page.get_by_role("button", name="Accedi").click()
    expect(page.get_by_role("alert")).to_contain_text("non è nota")


def test_a_browser_that_speaks_italian_is_spoken_to_in_italian(chromium: Browser, address: str) -> None:
    with Visitor.at_work(chromium, address, locale="it-IT") as visitor:
        visitor.open()
        visitor.see("Basta guidare")


def test_the_account_is_opened_and_closed_by_keyboard(visitor: Visitor, api: Api) -> None:
    visitor.sign_in()
    visitor.see("No devices yet")
    page = visitor.page
    account = page.get_by_role("button", name="Account")
    account.focus()
    page.keyboard.press("Enter")
    sign_out = page.get_by_role("button", name="Sign out")
    expect(sign_out).to_be_visible()
    visitor.assert_accessible()
    page.keyboard.press("Escape")
    expect(sign_out).to_be_hidden()
    expect(account).to_be_focused()


def test_the_places_are_those_of_the_role(visitor: Visitor, api: Api) -> None:
    key = api.post("/keys", {"role": "installer", "name": "Ida"}, expect=201)["key"]
    visitor.sign_in(key)
    places = visitor.page.get_by_role("navigation", name="Main navigation")
    expect(places.get_by_role("link")).to_have_text(["Devices", "Settings"])
    expect(places.get_by_role("link", name="Devices")).to_have_attribute("aria-current", "page")
    visitor.tolerated += ("403 (Forbidden)",)
    visitor.open("/alerts")
    expect(visitor.page).to_have_url(visitor.address + "/devices")
