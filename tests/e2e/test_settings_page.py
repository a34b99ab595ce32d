"""What may be set and looked up: keys, webhooks, thresholds, the audit trail; to each role its own."""

import re
from collections.abc import Iterator
from typing import Literal

import pytest
from playwright.sync_api import Browser, Locator, expect
from standardwebhooks import Webhook as Library

from tests.cli import livella
from tests.e2e.test_alerts_page import SIZES, Service, key_of, lose_gps
from tests.e2e.visitor import Visitor
from tests.receiver import Answer, Receiver, running_receiver
from tests.service import ADMIN_KEY, Api

pytestmark = pytest.mark.browser

SECTIONS = {
    "admin": ["Webhooks", "Thresholds", "Keys", "Audit trail", "About"],
    "manager": ["Webhooks", "Thresholds", "About"],
    "installer": ["About"],
}


SIGHTS = {
    "webhooks": "Help desk",
    "thresholds": "I valori con cui il servizio decide",
    "keys": "mai usata",
    "audit": "address: 127.0.0.1",
    "about": "Versione",
}


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """A service that may call receivers on this machine."""
    directory = tmp_path_factory.mktemp("settings")
    with livella.serving(directory, LIVELLA_ADMIN_KEY=ADMIN_KEY, LIVELLA_WEBHOOK_ALLOW_PRIVATE="true") as (url, _):
        yield Service(url, f"sqlite:///{directory / 'data' / 'livella.db'}")


@pytest.fixture(scope="module")
def address(service: Service) -> str:
    return service.address


@pytest.fixture
def receiver() -> Iterator[Receiver]:
    with running_receiver() as running:
        yield running


@pytest.fixture(autouse=True)
def nothing_set(api: Api) -> None:
    for webhook in api.get("/webhooks")["items"]:
        api.call("DELETE", f"/webhooks/{webhook['id']}", 204)


def sections(visitor: Visitor) -> Locator:
    return visitor.page.get_by_role("navigation", name="Sections of the settings").get_by_role("link")


def said(visitor: Visitor, text: str) -> None:
    expect(visitor.page.get_by_role("status").filter(has_text=text)).to_be_visible()


@pytest.mark.parametrize("role", SECTIONS)
def test_each_role_has_its_own_sections_and_no_other(visitor: Visitor, api: Api, role: str) -> None:
    visitor.sign_in(key_of(api, role, f"a {role}"))
    page = visitor.page
    page.get_by_role("link", name="Settings").click()
    expect(sections(visitor)).to_have_text(SECTIONS[role])
    for name in ("webhooks", "thresholds", "keys", "audit", "about"):
        visitor.open(f"/settings/{name}")
        expect(page.get_by_role("heading", level=2).first).to_be_visible()
        title = page.get_by_role("heading", level=2).first.text_content()
        allowed = {"audit": "Audit trail"}.get(name, name.capitalize())
        assert title == (allowed if allowed in SECTIONS[role] else SECTIONS[role][0])


def test_a_device_has_no_settings(installer: Visitor, api: Api) -> None:
    own = api.add_device("van-1")
    installer.sign_in(own.key)
    installer.see_stage("Waiting")
    installer.open("/settings/about")
    expect(installer.page).to_have_url(re.compile("/devices/van-1$"))
    expect(installer.page.get_by_role("link", name="Settings")).to_have_count(0)


def test_a_key_is_made_shown_once_and_revoked(visitor: Visitor, api: Api) -> None:
    visitor.sign_in()
    visitor.open("/settings/keys")
    page = visitor.page
    page.get_by_role("button", name="Make a key").click()
    dialog = page.get_by_role("dialog")
    dialog.get_by_role("combobox", name="Role").select_option("Fleet manager")
    dialog.get_by_role("textbox", name="Name").fill("Help desk")
    dialog.get_by_label("Last day").fill("2001-02-03")
    visitor.tolerated += ("422 (Unprocessable",)
    dialog.get_by_role("button", name="Make a key").click()
    expect(dialog.get_by_role("alert")).to_contain_text("has to lie in the future")
    dialog.get_by_label("Last day").fill("2099-12-31")
    dialog.get_by_role("button", name="Make a key").click()
    visitor.see("This key is shown only now")
    expect(dialog.get_by_role("img", name="The key of Help desk as a QR code")).to_be_visible()
    visitor.assert_accessible()
    key = dialog.locator("code").text_content()
    desk = api.as_(key)
    desk.get("/alerts")
    desk.get("/keys", 403)
    dialog.get_by_role("button", name="Done").click()

    row = page.get_by_role("list", name="List of keys").get_by_role("listitem").filter(has_text="Help desk")
    expect(row).to_contain_text("Fleet manager")
    expect(row).to_contain_text(str(key)[:12])
    expect(row).to_contain_text("by admin")
    expect(row).to_contain_text("holds until")
    page.reload()
    expect(row).to_be_visible()
    expect(page.get_by_text(str(key))).to_have_count(0)
    row.get_by_role("button", name="Revoke").click()
    expect(dialog).to_contain_text("Help desk")
    dialog.get_by_role("button", name="Cancel").click()
    desk.get("/alerts")
    row.get_by_role("button", name="Revoke").click()
    dialog.get_by_role("button", name="Revoke").click()
    said(visitor, "The key “Help desk” is revoked.")
    expect(row).to_have_count(0)
    desk.get("/alerts", 401)


def test_a_key_for_a_device_and_the_last_key_of_an_administrator(visitor: Visitor, api: Api) -> None:
    for key in api.get("/keys", params={"limit": 500})["items"]:
        if key["name"] != "admin":
            api.call("DELETE", f"/keys/{key['id']}", 204)
    device = api.add_device("van-1", name="Van 1")
    visitor.sign_in()
    visitor.open("/settings/keys")
    page = visitor.page
    page.get_by_role("button", name="Make a key").click()
    dialog = page.get_by_role("dialog")
    dialog.get_by_role("combobox", name="Role").select_option("Device")
    dialog.get_by_role("textbox", name="Name").fill("Spare")
    dialog.get_by_label("Device").fill("van")
    expect(dialog.locator("datalist option")).to_have_attribute("value", device.id)
    dialog.get_by_label("Device").fill(device.id)
    dialog.get_by_role("button", name="Make a key").click()
    key = dialog.locator("code").text_content()
    assert api.as_(key).get("/devices/van-1/installation")["stage"] == "waiting"
    dialog.get_by_role("button", name="Done").click()

    rows = page.get_by_role("list", name="List of keys").get_by_role("listitem")
    expect(rows.filter(has_text="Spare").get_by_role("link", name="van-1")).to_be_visible()
    visitor.tolerated += ("409 (Conflict)",)
    rows.filter(has_text="Administrator").get_by_role("button", name="Revoke").click()
    dialog.get_by_role("button", name="Revoke").click()
    expect(dialog.get_by_role("alert")).to_contain_text("the last key that may administer the service")


def test_a_webhook_is_made_tested_and_told_of_alerts(
    visitor: Visitor, api: Api, service: Service, receiver: Receiver
) -> None:
    api.add_device("van-1")
    visitor.sign_in(key_of(api, "manager", "Anna"))
    visitor.open("/settings/webhooks")
    visitor.see("No webhooks yet")
    page = visitor.page
    page.get_by_role("button", name="Add a webhook").click()
    dialog = page.get_by_role("dialog")
    dialog.get_by_role("textbox", name="Name").fill("Help desk")
    visitor.tolerated += ("422 (Unprocessable",)
    dialog.get_by_role("textbox", name="Address").fill("ftp://127.0.0.1/hook")
    dialog.get_by_role("button", name="Save").click()
    expect(dialog.get_by_role("alert")).to_contain_text("has to begin with")
    dialog.get_by_role("textbox", name="Address").fill(receiver.url)
    dialog.get_by_role("checkbox", name="All kinds").uncheck()
    dialog.get_by_role("checkbox", name="Clock fault").uncheck()
    dialog.get_by_role("button", name="Save").click()
    visitor.see("This secret is shown only now")
    secret = dialog.locator("code").text_content()
    dialog.get_by_role("button", name="Done").click()

    card = page.get_by_role("list", name="List of webhooks").get_by_role("article")
    expect(card).to_contain_text(receiver.url)
    expect(card).to_contain_text("Not called yet")
    expect(card).to_contain_text("GPS lost")
    expect(card).not_to_contain_text("Clock fault")
    card.get_by_role("button", name="Test").click()
    expect(card.get_by_role("status")).to_contain_text(re.compile(r"went well.*Answer: 204, after \d+ ms"))
    (call,) = receiver.wait_for(1)
    Library(str(secret)).verify(call.body, call.headers)
    expect(card).to_contain_text("Working")

    card.get_by_text("Deliveries").click()
    log = card.get_by_role("list", name="Deliveries").get_by_role("listitem")
    expect(log).to_have_text([re.compile("Test.*Delivered.*1 attempt.*answer 204")])
    (number,) = lose_gps(service, "van-1")
    api.post(f"/alerts/{number}/acknowledge", {})
    receiver.wait_for(3)
    page.reload()
    card.get_by_text("Deliveries").click()
    seen = [re.compile(f"{what}.*Delivered") for what in ("Alert acknowledged.*van-1", "Alert opened", "Test")]
    expect(log).to_have_text(seen)
    visitor.assert_accessible()


def test_what_a_webhook_was_not_told_is_sent_again(
    visitor: Visitor, api: Api, service: Service, receiver: Receiver
) -> None:
    """A receiver says that it is gone: the webhook is off, and what it was to be told is given up."""
    api.add_device("van-1")
    api.post("/webhooks", {"name": "Chat", "url": receiver.url}, 201)
    receiver.answer = Answer(410)
    (number,) = lose_gps(service, "van-1")
    api.post(f"/alerts/{number}/acknowledge", {})
    visitor.sign_in()
    visitor.open("/settings/webhooks")
    page = visitor.page
    card = page.get_by_role("article")
    expect(card).to_contain_text("Off")
    card.get_by_role("button", name="Test").click()
    expect(card.get_by_role("status")).to_contain_text(re.compile("did not go well.*Answer: 410"))
    card.get_by_text("Deliveries").click()
    log = card.get_by_role("list", name="Deliveries").get_by_role("listitem")
    opened = log.filter(has_text="Alert opened")
    expect(opened).to_have_text(re.compile("van-1.*Given up.*answer 410"))
    receiver.answer = Answer(204)
    card.get_by_role("button", name="Edit").click()
    page.get_by_role("switch", name="Active").check()
    page.get_by_role("button", name="Save").click()
    card.get_by_role("button", name="Send the given up ones again").click()
    said(visitor, "tried again.")
    expect(opened).to_have_text(re.compile("Delivered.*answer 204"))
    expect(card.get_by_role("button", name="Send the given up ones again")).to_have_count(0)
    expect(card).to_contain_text("Working")


def test_a_webhook_is_edited_gets_a_new_secret_and_is_deleted(visitor: Visitor, api: Api, receiver: Receiver) -> None:
    made = api.post("/webhooks", {"name": "Chat", "url": receiver.url, "severities": ["critical"]}, 201)
    visitor.sign_in()
    visitor.open("/settings/webhooks")
    page = visitor.page
    card, dialog = page.get_by_role("article"), page.get_by_role("dialog")
    card.get_by_role("button", name="Edit").click()
    expect(dialog.get_by_role("textbox", name="Address")).to_have_value(receiver.url)
    expect(dialog.get_by_role("checkbox", name="All kinds")).to_be_checked()
    expect(dialog.get_by_role("checkbox", name="Critical")).to_be_checked()
    dialog.get_by_role("textbox", name="Name").fill("Night desk")
    dialog.get_by_role("checkbox", name="All severities").check()
    dialog.get_by_role("switch", name="Active").uncheck()
    dialog.get_by_role("button", name="Save").click()
    said(visitor, "The webhook “Night desk” is saved.")
    expect(card).to_contain_text("Off")
    (kept,) = api.get("/webhooks")["items"]
    assert (kept["name"], kept["severities"], kept["active"]) == ("Night desk", None, False)

    card.get_by_role("button", name="New secret").click()
    dialog.get_by_role("button", name="New secret").click()
    secret = dialog.locator("code").text_content()
    assert str(secret).startswith("whsec_")
    assert secret != made["secret"]
    dialog.get_by_role("button", name="Done").click()
    card.get_by_role("button", name="Test").click()
    (call,) = receiver.wait_for(1)
    Library(str(secret)).verify(call.body, call.headers)

    card.get_by_role("button", name="Delete").click()
    dialog.get_by_role("button", name="Delete").click()
    said(visitor, "The webhook “Night desk” is deleted.")
    visitor.see("No webhooks yet")
    assert api.get("/webhooks")["items"] == []


def test_a_receiver_that_fails_is_named_so(visitor: Visitor, api: Api, service: Service, receiver: Receiver) -> None:
    api.add_device("van-1")
    api.post("/webhooks", {"name": "Chat", "url": receiver.url}, 201)
    receiver.answer = Answer(500)
    (number,) = lose_gps(service, "van-1")
    api.post(f"/alerts/{number}/acknowledge", {})
    receiver.wait_for(1)
    visitor.sign_in()
    visitor.open("/settings/webhooks")
    card = visitor.page.get_by_role("article")
    expect(card).to_contain_text("Failing")
    expect(card).to_contain_text("first failure")
    card.get_by_text("Deliveries").click()
    log = card.get_by_role("list", name="Deliveries").get_by_role("listitem")
    expect(log.last).to_have_text(re.compile("Alert opened.*van-1.*Waiting.*answer 500.*next attempt"))


def test_who_did_what_is_looked_up(visitor: Visitor, api: Api, service: Service) -> None:
    api.add_device("van-1", name="Van 1")
    (number,) = lose_gps(service, "van-1")
    anna = api.as_(key_of(api, "manager", "Anna Verdi"))
    anna.post(f"/alerts/{number}/acknowledge", {"note": "cable"})
    anna.post(f"/alerts/{number}/resolve", {})
    visitor.sign_in()
    visitor.open("/settings/audit")
    page = visitor.page
    entries = page.get_by_role("list", name="Audit trail").get_by_role("listitem")
    page.get_by_role("textbox", name="Who").fill("Anna Verdi")
    expect(entries).to_have_text([re.compile("Resolved an alert"), re.compile("Acknowledged an alert.*cable")])
    page.get_by_role("combobox", name="What").select_option("Acknowledged an alert")
    expect(entries).to_have_count(1)
    entries.get_by_role("link", name=f"alerts/{number}").click()
    expect(page).to_have_url(f"{visitor.address}/alerts?id={number}")
    visitor.see("Acknowledged by Anna Verdi")
    page.go_back()
    page.get_by_role("textbox", name="To what").fill("devices/nothing")
    visitor.see("Nothing matches.")


def test_what_the_service_decides_by_is_read(visitor: Visitor, api: Api) -> None:
    items = api.get("/thresholds")["items"]
    visitor.sign_in(key_of(api, "manager", "Anna"))
    visitor.open("/settings/thresholds")
    rows = visitor.page.locator("tbody").get_by_role("row")
    expect(rows).to_have_count(len(items))
    expect(visitor.page.get_by_role("table", name="Alerts")).to_contain_text("30 min")
    chunk = rows.filter(has=visitor.page.get_by_role("rowheader", name="max_chunk_bytes"))
    expect(chunk).to_contain_text("16,777,216 bytes")
    for item in items:
        expect(rows.filter(has_text=item["meaning"].replace("`", "")).first).to_be_visible()  # code is set as code


def test_what_the_service_is_and_how_it_looks(visitor: Visitor, api: Api) -> None:
    visitor.sign_in(key_of(api, "installer", "Ida"))
    visitor.open("/settings/about")
    page = visitor.page
    visitor.see(api.client.get("/openapi.json").json()["info"]["version"])
    page.get_by_text("Dark", exact=True).click()
    expect(page.locator("html")).to_have_attribute("data-mantine-color-scheme", "dark")
    page.reload()
    expect(page.locator("html")).to_have_attribute("data-mantine-color-scheme", "dark")
    page.get_by_role("radiogroup", name="Language").get_by_text("Italiano").click()
    visitor.see("Che cosa conserva questo browser")
    page.reload()
    visitor.see("Che cosa conserva questo browser")


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("size", SIZES)
def test_every_section_can_be_used_by_everybody(
    chromium: Browser, api: Api, service: Service, receiver: Receiver, size: str, scheme: Literal["light", "dark"]
) -> None:
    api.add_device("van-1")
    api.post("/webhooks", {"name": "Help desk", "url": receiver.url, "kinds": ["gps_lost", "device_silent"]}, 201)
    key_of(api, "manager", "Anna")
    width, height = SIZES[size]
    with Visitor.at_work(chromium, service.address, width, height, color_scheme=scheme, locale="it-IT") as visitor:
        visitor.page.request.post(f"{service.address}/api/v1/session", data={"key": ADMIN_KEY})
        for name, sight in SIGHTS.items():
            visitor.open(f"/settings/{name}")
            visitor.see(sight)
            if name == "webhooks":
                visitor.page.get_by_role("button", name="Prova").click()
                visitor.see("La chiamata di prova è riuscita")
                visitor.page.get_by_text("Consegne").click()
                visitor.see("Consegnato")
            visitor.assert_accessible()
            visitor.picture(f"settings-{name}-{size}-{scheme}")
        for name, button in (("keys", "Crea una chiave"), ("webhooks", "Aggiungi un webhook")):
            visitor.open(f"/settings/{name}")
            visitor.page.get_by_role("button", name=button).click()
            expect(visitor.page.get_by_role("dialog")).to_be_visible()
            if name == "webhooks":
                visitor.page.get_by_role("checkbox", name="Tutti i tipi").uncheck()
            visitor.assert_accessible()
            visitor.assert_fits()
