"""Make the pictures of the documents anew: `python -m tests.e2e.pictures`. Simulated drives only, three minutes."""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, get_args

import httpx
import numpy as np
from playwright.sync_api import Browser, Page, sync_playwright

from api import schemas
from api.formats.writer import write_native_csv
from core import quaternion
from core.simulation import Scenario, simulate
from tests.cli import livella
from tests.cli.test_demo import demo, items, seconds_until
from tests.e2e.visitor import SWITCHES, Visitor
from tests.server import ROOT
from tests.service import ADMIN_KEY, Api, Device

PICTURES = ROOT / "docs" / "pictures"
CHUNK_SECONDS = 12.0
LONGEST = 600.0
"""s of driving; confirmed before"""
PHONE = {"width": 360, "height": 740, "device_scale_factor": 2}
DESK = {"width": 1280, "height": 860}
KINDS = set(get_args(schemas.AlertKind))
PATIENCE = 180.0
"""s until the demo shows every kind of alert"""
DRAWN = 4000
"""ms: the 3D picture is fetched and drawn after the rest"""


def main() -> None:
    """Calibrate a device with a phone in hand, then look at the demo's fleet from a desk."""
    with TemporaryDirectory() as directory, sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=SWITCHES)
        with livella.serving(Path(directory), LIVELLA_ADMIN_KEY=ADMIN_KEY) as (url, _):
            picture_installation(chromium, url)
        with demo(Path(directory) / "demo.log") as (_, client):
            picture_fleet(chromium, client)
        chromium.close()


# ---------------------------------------------------------------- an installer's phone


def picture_installation(chromium: Browser, url: str) -> None:
    """From the first start to the certificate."""
    with httpx.Client(base_url=url, timeout=60.0) as client, looking(chromium, url, ADMIN_KEY, PHONE) as visitor:
        visitor.see("No devices yet")
        key = add_device(visitor.page)
        device = Device(Api(client), "van-12", key)
        take(visitor.page, "device-waiting-phone")
        for stage in ("settling", "verifying", "confirmed"):
            play(device, until=stage)
            visitor.see_stage(stage.capitalize())
            take(visitor.page, f"device-{stage}-phone")
        with looking(chromium, url, ADMIN_KEY, DESK, locale="it-IT", color_scheme="dark") as abroad:
            abroad.open("/devices/van-12")
            abroad.see_stage("Confermato")
            take(abroad.page, "device-desk-italian-dark")
        with looking(chromium, url, ADMIN_KEY, {"width": 794, "height": 1123}) as printer:
            printer.open("/devices/van-12")
            printer.see_stage("Confirmed")
            printer.page.emulate_media(media="print")
            take(printer.page, "certificate")
        with looking(chromium, url, ADMIN_KEY, {"width": 1280, "height": 1675}) as desk:
            desk.open("/devices/van-12")
            desk.see_stage("Confirmed")
            take(desk.page, "device-desktop")


def add_device(page: Page) -> str:
    """Fill in the form and give the key that is shown."""
    page.get_by_role("button", name="Add a device").first.click()
    dialog = page.get_by_role("dialog")
    dialog.get_by_role("textbox", name="Name").fill("Van 12")
    dialog.get_by_role("textbox", name="Vehicle").fill("Fiat Ducato, AB 123 CD")
    dialog.get_by_role("textbox", name="Device id").fill("van-12")
    take(page, "add-device-phone")
    dialog.get_by_role("button", name="Add", exact=True).click()
    key = dialog.locator("code").first.inner_text()
    take(page, "key-phone")
    dialog.get_by_role("link", name="Open the device").click()
    return key


def play(device: Device, until: str) -> None:
    """Send the drive, from where it is, until a stage is well under way."""
    mount = quaternion.from_angles(*np.radians([3.0, 8.0, -94.0]))
    samples = simulate(Scenario(seconds=LONGEST, seed=3, mount=mount, imu_rate=50.0)).samples
    step = int(CHUNK_SECONDS * 50)
    pieces = [samples.slice(i, i + step) for i in range(0, len(samples), step)]
    for seq, piece in enumerate(pieces):
        answer = device.send(write_native_csv(piece), seq, expect=200).json()
        installation = answer["installation"]
        under_way = until != "verifying" or installation["verification"]["elapsed_s"] > 2 * CHUNK_SECONDS
        if installation["stage"] == until and under_way and not answer["chunk"]["duplicate"]:
            return
    raise AssertionError(f"not {until} within {LONGEST} s")


# ---------------------------------------------------------------- a fleet manager's desk


def picture_fleet(chromium: Browser, client: httpx.Client) -> None:
    """The demo's fleet, once it shows everything."""
    seconds_until(lambda: {alert["kind"] for alert in items(client, "alerts")} >= KINDS, PATIENCE)
    url = str(client.base_url).removesuffix("/api/v1/")
    key = client.headers["Authorization"].removeprefix("Bearer ")
    with looking(chromium, url, key, DESK) as visitor:
        visitor.see("Van in a jam")
        take(visitor.page, "fleet-desk")
        picture_alert(visitor)
        picture_past(visitor)
    with looking(chromium, url, key, {"width": 1280, "height": 1340}) as visitor:
        picture_motion(visitor)
    with looking(chromium, url, key, DESK, color_scheme="dark") as visitor:
        visitor.open("/alerts")
        visitor.see("Acknowledge")
        take(visitor.page, "alerts-desk-dark")
        visitor.open("/settings/thresholds")
        visitor.see("settling.yaw_sigma")
        take(visitor.page, "settings-desk-dark")


def picture_alert(visitor: Visitor) -> None:
    """An alert with what it was raised on."""
    moved = next(alert for alert in _alerts(visitor) if alert["device_id"] == "car-205")
    visitor.open(f"/alerts?id={moved['id']}")
    visitor.see("What to do")
    take(visitor.page, "alert-desk")


def picture_past(visitor: Visitor) -> None:
    """The history and the data of a device that has driven for hours."""
    visitor.open("/devices/van-103")
    visitor.scroll_to("Angle history")
    visitor.page.get_by_text("Events in view").scroll_into_view_if_needed()
    region = visitor.page.get_by_role("region", name="Angle history")
    region.evaluate("region => scrollTo(0, region.getBoundingClientRect().top + scrollY - 120)")
    take(visitor.page, "history-desk")


def picture_motion(visitor: Visitor) -> None:
    """How a vehicle moved that was hit, and the impact."""
    visitor.open("/devices/car-208/motion")
    visitor.see("Friction circle")
    take(visitor.page, "motion-desk")
    visitor.page.get_by_role("listitem").filter(has_text="Impact").get_by_role("link", name="Details").click()
    visitor.page.get_by_role("img", name="The vehicle from above").wait_for()
    take(visitor.page, "impact-desk")


def _alerts(visitor: Visitor) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = visitor.page.evaluate(
        "fetch('/api/v1/alerts?limit=500').then(answer => answer.json()).then(page => page.items)"
    )
    return found


# ---------------------------------------------------------------- pictures


@contextmanager
def looking(chromium: Browser, url: str, key: str, size: dict[str, int], **options: Any) -> Iterator[Visitor]:
    """Somebody signed in, in front of a screen of this size."""
    with Visitor.at_work(chromium, url, **size, **options) as visitor:
        visitor.open()
        visitor.page.locator("input[type=password]").fill(key)
        visitor.page.locator("button[type=submit]").click()
        visitor.page.locator("main h1").wait_for()
        yield visitor


def take(page: Page, name: str) -> None:
    """Keep what is on the screen, once it stands still."""
    page.wait_for_timeout(DRAWN)
    page.screenshot(path=PICTURES / f"{name}.png")


if __name__ == "__main__":
    main()
