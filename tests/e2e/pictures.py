"""Make the pictures of the documents anew: `python -m tests.e2e.pictures`. Simulated drives only."""

import shutil
from pathlib import Path
from tempfile import TemporaryDirectory

import httpx
import numpy as np
from playwright.sync_api import Browser, sync_playwright

from api.formats.writer import write_native_csv
from core import quaternion
from core.simulation import Scenario, simulate
from tests.cli import livella
from tests.e2e.visitor import SWITCHES, Visitor
from tests.server import ROOT
from tests.service import ADMIN_KEY, Api, Device

PICTURES = ROOT / "docs" / "pictures"
CHUNK_SECONDS = 12.0
LONGEST = 600.0
"""s of driving; confirmed before"""


def main() -> None:
    """Start the service, play one device, look at it from a phone on the way and from a desk at the end."""
    with (
        TemporaryDirectory() as directory,
        livella.serving(Path(directory), LIVELLA_ADMIN_KEY=ADMIN_KEY) as (url, _),
        httpx.Client(base_url=url, timeout=60.0) as client,
        sync_playwright() as playwright,
    ):
        chromium = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=SWITCHES)
        device = Api(client).add_device("van-12", name="Van 12", vehicle="Fiat Ducato")
        play(device, until="verifying")
        look(chromium, url, "device-phone", width=360, height=800, device_scale_factor=2)
        play(device, until="confirmed")
        look(chromium, url, "device-desktop", width=1280, height=1675)
        chromium.close()


def play(device: Device, until: str) -> None:
    """Send the drive, from where it is, until a stage is well under way."""
    mount = quaternion.from_angles(*np.radians([3.0, 8.0, -94.0]))
    samples = simulate(Scenario(seconds=LONGEST, seed=3, mount=mount, imu_rate=50.0)).samples
    step = int(CHUNK_SECONDS * 50)
    pieces = [samples.slice(i, i + step) for i in range(0, len(samples), step)]
    for seq, piece in enumerate(pieces):
        answer = device.send(write_native_csv(piece), seq, expect=200).json()
        installation = answer["installation"]
        under_way = until == "confirmed" or installation["verification"]["elapsed_s"] > CHUNK_SECONDS
        if installation["stage"] == until and under_way and not answer["chunk"]["duplicate"]:
            return
    raise AssertionError(f"not {until} within {LONGEST} s")


def look(chromium: Browser, url: str, name: str, width: int, height: int, **options: float) -> None:
    """Take a picture of the device's page."""
    with Visitor.at_work(chromium, url, width, height, **options) as visitor:
        visitor.sign_in()
        visitor.open("/devices/van-12")
        visitor.see("Yaw")
        visitor.page.wait_for_load_state("load")
        visitor.page.wait_for_timeout(1500)  # the 3D picture is fetched and drawn after the rest
        visitor.page.screenshot(path=PICTURES / f"{name}.png")


if __name__ == "__main__":
    main()
