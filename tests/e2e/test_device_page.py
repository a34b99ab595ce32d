"""The page of a device in an installer's hand: what to do, what is wrong, how sure, proved, printed, changed."""

import math
import re
from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Locator, Page, expect

from api.formats.writer import write_native_csv
from core import quaternion
from core.simulation import Scenario, simulate
from tests import drives
from tests.e2e.qr import read_code
from tests.e2e.visitor import Visitor
from tests.service import Api, Device

pytestmark = pytest.mark.browser

LONG = "Fiat Ducato furgone lastrato, passo lungo, tetto alto, targa AB 123 CD, officina di via delle Industrie 14"


def open_device(somebody: Visitor, key: str | None = None) -> Page:
    somebody.sign_in(key) if key else somebody.sign_in()
    somebody.open("/devices/van-1")
    expect(somebody.page.get_by_role("heading", level=1)).to_be_visible()
    return somebody.page


def live(page: Page) -> Locator:
    return page.get_by_role("region", name="Calibration now")


def choose(page: Page, item: str) -> Locator:
    """Open one of the dialogs of the menu."""
    page.get_by_role("button", name="More", exact=True).click()
    page.get_by_role("button", name=item).click()
    dialog = page.get_by_role("dialog")
    expect(dialog).to_be_visible()
    return dialog


def drive_until_verifying(device: Device) -> Iterator[bytes]:
    """Send a drive until its test is under way; give the chunks that are left."""
    chunks = enumerate(drives.chunks())
    for seq, body in chunks:
        test = device.send(body, seq, expect=200).json()["installation"]["verification"]
        if test["state"] == "running" and test["elapsed_s"] > 10:
            break
    for seq, body in chunks:
        yield body
        device.send(body, seq, expect=200)


def odd_drive(imu_rate: float = 50.0, silent_receiver: bool = False) -> bytes:
    """Write half a minute of a drive that is not as it should be."""
    outages = ((0.0, 1e9),) if silent_receiver else ()
    return write_native_csv(simulate(Scenario("city", 30.0, 2, imu_rate=imu_rate, outages=outages)).samples)


# ---------------------------------------------------------------- the live card


def test_one_sentence_says_what_to_do_and_the_figures_are_live(installer: Visitor, api: Api) -> None:
    device = api.add_device("van-1", name="Van 1")
    page = open_device(installer)
    card = live(page)
    expect(card).to_contain_text("Waiting for data: switch the device on")
    expect(card.get_by_text("Last data")).to_have_count(0)
    sent = device.send(drives.chunks()[0], 0, expect=200).json()["installation"]
    assert "turn" in sent["needs"]
    expect(card).to_contain_text("Take a few turns to the left and to the right.")
    share = card.get_by_role("progressbar", name="Progress of the calibration")
    expect(share).to_have_attribute("aria-valuenow", f"{100 * sent['progress']:.0f}")
    for figure in ("GPS fix Yes", "Samples 50 Hz", "Gyroscope Yes", f"{3.6 * sent['data']['speed_mps']:.0f} km/h"):
        expect(card).to_contain_text(re.compile(figure.replace(" ", r"\s*")))
    expect(card).to_contain_text(re.compile(r"Last data\s*\d+ s ago"))
    expect(card.get_by_role("list", name="What is wrong")).to_have_count(0)
    installer.assert_accessible()
    installer.picture("live-phone")


def test_what_is_wrong_with_the_data_is_said_with_its_remedy(installer: Visitor, api: Api) -> None:
    device = api.add_device("van-1", name="Van 1")
    device.send(odd_drive(silent_receiver=True), 0, expect=200)
    page = open_device(installer)
    wrong = live(page).get_by_role("list", name="What is wrong")
    expect(wrong).to_contain_text("no GPS fix")
    expect(wrong).to_contain_text("check the antenna")
    expect(live(page)).to_contain_text(re.compile(r"GPS fix\s*No"))
    device.send(odd_drive(imu_rate=10.0), 0, "slow", expect=200)
    expect(wrong).to_contain_text("Only 10 samples a second")
    expect(wrong).to_contain_text("at least")
    expect(wrong).not_to_contain_text("no GPS fix")
    installer.assert_accessible()
    installer.picture("trouble-phone")


def test_a_device_that_falls_silent_is_told_without_any_message(installer: Visitor, api: Api) -> None:
    device = api.add_device("van-1", name="Van 1")
    device.send(drives.chunks()[0], 0, expect=200)
    installer.page.clock.install()
    card = live(open_device(installer))
    expect(card).to_contain_text(re.compile(r"Last data\s*\d+ s ago"))
    installer.page.clock.fast_forward("03:00")
    expect(card.get_by_role("list", name="What is wrong")).to_contain_text("last data 3 minutes ago")
    expect(card).to_contain_text("goes on with the next data")
    installer.page.clock.fast_forward("03:00")
    expect(card).to_contain_text("last data 6 minutes ago")


def test_figures_that_may_be_old_say_of_when_they_are(installer: Visitor, api: Api) -> None:
    device = api.add_device("van-1", name="Van 1")
    device.send(drives.chunks()[0], 0, expect=200)
    card = live(open_device(installer))
    expect(card).to_contain_text(re.compile(r"\d+ s ago"))
    installer.tolerated += ("ERR_INTERNET_DISCONNECTED", "ERR_NETWORK_CHANGED")
    installer.page.context.set_offline(True)
    expect(card).to_contain_text(re.compile(r"as of \d+:\d\d:\d\d"))
    installer.assert_accessible()
    installer.page.context.set_offline(False)
    expect(card).to_contain_text(re.compile(r"\d+ s ago"), timeout=45_000)


# ---------------------------------------------------------------- how sure, and the proof


def test_the_uncertainty_shrinks_before_ones_eyes(installer: Visitor, api: Api) -> None:
    device = api.add_device("van-1", name="Van 1")
    page = open_device(installer)
    sure = page.get_by_role("region", name="How sure")
    expect(sure).to_contain_text("three curves appear here")
    for seq, body in enumerate(drives.chunks()[:2]):
        device.send(body, seq, expect=200)
    expect(page.get_by_role("region", name="Numbers")).to_be_visible()
    sure.scroll_into_view_if_needed()
    chart = sure.get_by_role("img", name="Uncertainty over time")
    expect(chart).to_be_visible()
    sigma = device.installation()["estimate"]["sigma_deg"]
    expect(sure).to_contain_text(f"± {sigma[2]:.1f}°")
    assert chart.evaluate(painted), "nothing is drawn"
    installer.assert_accessible()


painted = """
element => {
  const canvas = element.querySelector("canvas");
  const pixels = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
  return pixels.filter((value, i) => i % 4 === 3 && value > 0).length > 500;
}
"""


def test_the_drive_test_counts_down_and_draws_both_speeds(installer: Visitor, api: Api) -> None:
    device = api.add_device("van-1", name="Van 1")
    page = open_device(installer)
    left = drive_until_verifying(device)
    next(left)
    test = page.get_by_role("region", name="Drive test")
    seconds = math.ceil(40 - device.installation()["verification"]["elapsed_s"])
    countdown = test.get_by_role("progressbar", name="Drive test")
    expect(countdown).to_have_attribute("aria-valuetext", f"{seconds} s of driving left")
    expect(live(page)).to_contain_text("the result is being tested")
    chart = test.get_by_role("img", name=re.compile(r"Speed over \d+ s of driving: GPS from \d+ to \d+"))
    expect(chart).to_be_visible()
    assert chart.evaluate(painted), "nothing is drawn"
    installer.assert_accessible()
    installer.picture("verifying-phone")
    for _ in left:
        pass
    expect(test).to_contain_text("Passed")
    expect(test.get_by_label("within the limit")).to_be_visible()
    test.scroll_into_view_if_needed()
    expect(chart).to_be_visible()
    expect(countdown).to_have_count(0)


# ---------------------------------------------------------------- the result


def test_a_device_on_its_end_is_shown_as_it_is_and_turned_by_keys(visitor: Visitor, api: Api) -> None:
    mount = quaternion.from_angles(0.4, 1.55, 0.0)
    samples = simulate(Scenario("city", 60.0, 2, sensor="calibrated", mount=mount, imu_rate=50.0)).samples
    api.add_device("van-1", name="Van 1").send(write_native_csv(samples), 0, expect=200)
    page = open_device(visitor)
    picture = page.get_by_role("img", name="The device stands on end")
    expect(picture).to_be_visible()
    expect(page.get_by_role("region", name="Mounting", exact=True)).to_contain_text(re.compile(r"Good to \d"))
    group = page.get_by_role("group", name="Picture of the vehicle")
    group.focus()
    drawn = picture.locator("canvas")
    before = drawn.evaluate("canvas => canvas.toDataURL()")
    page.keyboard.press("ArrowLeft")
    turned = drawn.evaluate("canvas => canvas.toDataURL()")
    assert turned != before
    page.get_by_role("radiogroup", name="View of the vehicle").get_by_text("Corner").click()
    assert drawn.evaluate("canvas => canvas.toDataURL()") == before
    visitor.assert_accessible()


def test_a_finger_turns_the_picture(chromium: Browser, address: str, api: Api) -> None:
    api.add_device("van-1", name="Van 1").send(drives.chunks()[0], 0, expect=200)
    with Visitor.at_work(chromium, address, 360, 740, has_touch=True) as installer:
        page = open_device(installer)
        canvas = page.get_by_role("region", name="Mounting", exact=True).locator("canvas")
        canvas.scroll_into_view_if_needed()
        box = canvas.bounding_box()
        assert box is not None
        before = canvas.evaluate("canvas => canvas.toDataURL()")
        finger = page.context.new_cdp_session(page)
        at = {"x": box["x"] + 200, "y": box["y"] + 100}
        finger.send("Input.dispatchTouchEvent", {"type": "touchStart", "touchPoints": [at]})
        for _ in range(4):
            at = at | {"x": at["x"] - 30}
            finger.send("Input.dispatchTouchEvent", {"type": "touchMove", "touchPoints": [at]})
        finger.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
        assert canvas.evaluate("canvas => canvas.toDataURL()") != before
        expect(
            page.get_by_role("radiogroup", name="View of the vehicle").get_by_role("radio", checked=True)
        ).to_have_count(0)


def test_the_certificate_is_one_page_that_leads_back(visitor: Visitor, api: Api) -> None:
    device = api.add_device("van-1", name=LONG, vehicle=LONG, notes=f"{LONG}\n" * 9)
    device.send_all(drives.chunks())
    page = open_device(visitor)
    visitor.see_stage("Confirmed")
    page.emulate_media(media="print")
    visitor.see("Installation certificate")
    expect(page.get_by_role("banner")).to_be_hidden()
    certificate = page.get_by_role("article")
    mount = device.installation()["mount"]
    expect(certificate).to_contain_text(", ".join(f"{value:.6f}" for value in mount["quaternion"]))
    expect(certificate).to_contain_text(f"± {mount['sigma_deg'][2]:.2f}°")
    expect(certificate.get_by_role("img", name="Speed over")).to_be_visible()
    expect(certificate).to_contain_text("Date and signature")
    assert read_code(certificate.get_by_role("img", name="This device’s page")) == page.url
    assert page.pdf(prefer_css_page_size=True).count(b"/Type /Page\n") == 1


def test_everything_speaks_italian(chromium: Browser, address: str, api: Api) -> None:
    device = api.add_device("van-1", name="Furgone 1")
    device.send(drives.chunks()[0], 0, expect=200)
    with Visitor.at_work(chromium, address, 360, 740, locale="it-IT") as installer:
        installer.open()
        installer.page.get_by_role("textbox", name="Chiave").fill(device.admin.key or "")
        installer.page.get_by_role("button", name="Accedi").click()
        installer.see("Furgone 1")
        installer.open("/devices/van-1")
        page = installer.page
        installer.see("Fare qualche curva, a sinistra e a destra.")
        sigma = device.installation()["estimate"]["sigma_deg"]
        expect(page.get_by_role("region", name="Quanto è sicuro")).to_contain_text(
            f"± {sigma[2]:.1f}".replace(".", ",")
        )
        expect(page.get_by_role("region", name="Prova su strada")).to_contain_text("Comincia da sola")
        expect(page.get_by_role("region", name="Montaggio", exact=True)).to_contain_text("Il dispositivo è girato di")
        page.get_by_role("button", name="Dispositivo rimontato").click()
        expect(page.get_by_role("dialog")).to_contain_text("Restano i montaggi precedenti")
        installer.assert_accessible()
        page.keyboard.press("Escape")
        installer.assert_fits()
        page.emulate_media(media="print")
        code = page.get_by_role("article").get_by_text("Quaternione q_vs")
        expect(code).to_contain_text(re.compile(r"-?\d\.\d{6}, -?\d\.\d{6}"))


# ---------------------------------------------------------------- what an installer changes


def test_a_device_is_edited_on_a_phone(installer: Visitor, api: Api) -> None:
    api.add_device("van-1", name="Van 1", vehicle="Fiat Ducato")
    page = open_device(installer)
    dialog = choose(page, "Edit")
    installer.assert_accessible()
    dialog.get_by_role("textbox", name="Name").fill("Van 12")
    dialog.get_by_role("textbox", name="Vehicle").fill("")
    dialog.get_by_role("textbox", name="Notes").fill("Left of the glove box")
    dialog.get_by_role("button", name="Save").click()
    expect(dialog).to_be_hidden()
    expect(page.get_by_role("heading", level=1)).to_have_text("Van 12")
    expect(page.get_by_role("button", name="More", exact=True)).to_be_focused()
    stored = api.get("/devices/van-1")
    assert (stored["name"], stored["vehicle"], stored["notes"]) == ("Van 12", None, "Left of the glove box")


def test_a_new_key_is_shown_once_as_text_and_code_and_ends_the_old_one(installer: Visitor, api: Api) -> None:
    device = api.add_device("van-1", name="Van 1")
    page = open_device(installer)
    dialog = choose(page, "New device key")
    assert device.send(b"", 0).status_code != 401
    dialog.get_by_role("button", name="Make a new key").click()
    installer.see("This key is shown only now")
    key = dialog.locator("code").inner_text()
    assert read_code(dialog.get_by_role("img", name="QR code of the key")) == key
    assert api.as_(key).get("/devices/van-1/installation")["stage"] == "waiting"
    assert device.send(b"", 0).status_code == 401
    installer.assert_accessible()
    installer.assert_fits()
    dialog.get_by_role("button", name="Done").click()
    expect(dialog).to_be_hidden()
    assert key not in page.content()


def test_a_device_is_removed_only_by_its_name(installer: Visitor, api: Api) -> None:
    api.add_device("van-1", name="Van 1")
    api.add_device("bus-2", name="Bus 2")
    page = open_device(installer)
    dialog = choose(page, "Remove")
    remove = dialog.get_by_role("button", name="Remove for ever")
    expect(remove).to_be_disabled()
    dialog.get_by_role("textbox").fill("Bus 2")
    expect(remove).to_be_disabled()
    dialog.get_by_role("textbox").fill("Van 1")
    installer.assert_accessible()
    installer.tolerated += ("404 (Not Found)",)
    remove.click()
    installer.see("Bus 2")
    assert page.url.endswith("/devices")
    assert [item["id"] for item in api.get("/devices")["items"]] == ["bus-2"]


def test_a_refit_that_does_not_get_through_is_told_and_repeated(installer: Visitor, api: Api) -> None:
    api.add_device("van-1", name="Van 1").send_all(drives.chunks())
    page = open_device(installer)
    installer.see_stage("Confirmed")
    installer.tolerated += ("ERR_FAILED",)
    page.route("**/installation/restart", lambda route: route.abort())
    page.get_by_role("button", name="Device refitted").click()
    dialog = page.get_by_role("dialog")
    expect(dialog).to_contain_text("What stays: earlier mountings")
    dialog.get_by_role("button", name="Start again").click()
    expect(dialog.get_by_role("alert")).to_contain_text("not started again")
    installer.see_stage("Confirmed")
    page.unroute("**/installation/restart")
    dialog.get_by_role("button", name="Start again").click()
    expect(dialog).to_be_hidden()
    installer.see_stage("Aligning")
