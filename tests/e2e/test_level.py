"""Level ground, said by an installer with a phone."""

import pytest
from playwright.sync_api import expect

from api.formats.writer import write_native_csv
from core.simulation import Scenario, simulate
from tests import drives
from tests.e2e.visitor import Visitor
from tests.service import Api

pytestmark = pytest.mark.browser

SAY_SO = "Vehicle stands on level ground"


def test_level_ground_is_refused_in_words_while_driving_and_taken_at_rest(installer: Visitor, api: Api) -> None:
    parked = write_native_csv(simulate(Scenario("parked", 20.0, 1, imu_rate=50.0)).samples)
    device = api.add_device("van-1", name="Van 1")
    installer.tolerated += ("409 (Conflict)",)
    installer.sign_in()
    installer.open("/devices/van-1")
    installer.see("Waiting for data")
    page = installer.page
    expect(page.get_by_role("button", name=SAY_SO)).to_have_count(0)
    device.send_all(drives.chunks()[:2])
    page.get_by_role("button", name=SAY_SO).click()
    dialog = page.get_by_role("dialog")
    dialog.get_by_role("button", name="It stands level").click()
    expect(dialog.get_by_role("alert")).to_contain_text("was moving within the last 2 seconds")
    installer.assert_accessible()
    installer.picture("level-refused-phone")
    dialog.get_by_role("button", name="Cancel").click()
    device.send(parked, 0, "parked", expect=200)
    page.get_by_role("button", name=SAY_SO).click()
    expect(dialog.get_by_role("alert")).to_have_count(0)
    dialog.get_by_role("button", name="It stands level").click()
    installer.see("Level ground was taken into account")
    expect(dialog).to_have_count(0)
    installer.assert_accessible()
    installer.picture("level-taken-phone")


def test_a_confirmed_mounting_needs_no_level_ground(visitor: Visitor, api: Api) -> None:
    api.add_device("van-1", name="Van 1").send_all(drives.chunks())
    visitor.sign_in()
    visitor.open("/devices/van-1")
    visitor.see_stage("Confirmed")
    expect(visitor.page.get_by_role("button", name=SAY_SO)).to_have_count(0)
