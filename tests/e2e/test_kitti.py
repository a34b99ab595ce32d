"""A recorded drive, sent by the command a device's maker would use, while somebody watches the page."""

import csv
import gzip
import json
import threading
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from playwright.sync_api import Browser, expect

from core import quaternion
from tests.cli import livella
from tests.e2e.visitor import Visitor
from tests.server import ROOT
from tests.service import Api

LOG = ROOT.parent / "shared/data/kitti_gtsam.csv.gz"
pytestmark = [
    pytest.mark.browser,
    pytest.mark.real_data,
    pytest.mark.skipif(not LOG.is_file(), reason="needs the recorded drive ../shared/data/kitti_gtsam.csv.gz"),
]

Floats = NDArray[np.float64]
DOCUMENTED_DEG = 3.0
TURNED_WITH_DEG = 0.05
SPEED = 40
"""times the speed of time; the drive takes 469 s"""
TURN = quaternion.from_angles(*np.radians([-35.0, 50.0, 120.0]))
"""from the sensor's axes to those of a device mounted otherwise"""


def test_the_page_finds_the_documented_mounting_and_turns_with_the_device(
    chromium: Browser, address: str, api: Api, tmp_path: Path
) -> None:
    plain = follow(chromium, address, api, LOG, "kitti")
    documented = json.loads(LOG.with_suffix("").with_suffix(".json").read_text())["R_sensor_to_vehicle"]
    assert degrees_between(plain, quaternion.from_matrix(documented)) < DOCUMENTED_DEG
    turned = follow(chromium, address, api, turn(LOG, tmp_path / "turned.csv.gz"), "kitti-turned")
    assert degrees_between(quaternion.multiply(turned, TURN), plain) < TURNED_WITH_DEG


def follow(chromium: Browser, address: str, api: Api, log: Path, name: str) -> Floats:
    """Watch a drive being sent on a desk and on a phone; give the mounting that the page shows at the end."""
    device = api.add_device(name, name=name.capitalize())
    with Visitor.at_work(chromium, address) as desk, Visitor.at_work(chromium, address, 360, 740) as phone:
        for somebody in (desk, phone):
            somebody.sign_in()
            somebody.page.get_by_role("link", name=name.capitalize(), exact=True).click()
            somebody.see_stage("Waiting")
        loads = [desk.loads, phone.loads]
        sender = Sender(log, address, device.id, device.key)
        sender.start()
        for somebody in (desk, phone):
            somebody.see_stage("Confirmed", seconds=120)
        sender.join(120)
        assert sender.result is not None
        assert sender.result.status == 0, sender.result.err
        assert loads == [desk.loads, phone.loads], "the page was loaded anew"
        shown = shown_mounting(desk)
        assert degrees_between(shown, np.array(device.installation()["mount"]["quaternion"])) < 1e-3
        for somebody, width in ((desk, 1280), (phone, 360)):
            somebody.scroll_to("Angle history")
            expect(somebody.page.get_by_role("img", name="Yaw over time")).to_be_visible()
            somebody.picture(f"{name}-{width}")
        return shown


class Sender(threading.Thread):
    """`livella upload` beside the test."""

    def __init__(self, log: Path, server: str, device: str, key: str) -> None:
        super().__init__()
        self.arguments = (log, "--server", server, "--device", device, "--chunk-seconds", 60, "--realtime", SPEED)
        self.key = key
        self.result: livella.Result | None = None

    def run(self) -> None:
        self.result = livella.run("upload", *self.arguments, LIVELLA_KEY=self.key)


def shown_mounting(visitor: Visitor) -> Floats:
    """Read the quaternion off the page."""
    text = visitor.page.get_by_role("region", name="Numbers").locator("code").inner_text()
    return quaternion.normalise([float(number) for number in text.split(",")])


def degrees_between(q: Floats, p: Floats) -> float:
    return float(np.degrees(quaternion.angle_between(q, p)))


def turn(log: Path, to: Path) -> Path:
    """Write the log that a device turned by `TURN` would have made."""
    with gzip.open(log, "rt", newline="") as source, gzip.open(to, "wt", newline="", compresslevel=1) as sink:
        reader = csv.DictReader(source)
        writer = csv.DictWriter(sink, reader.fieldnames or ())
        writer.writeheader()
        matrix = quaternion.matrix(TURN)
        for row in reader:
            for axes in (("ax", "ay", "az"), ("gx", "gy", "gz")):
                turned = matrix @ [float(row[axis]) for axis in axes]
                row |= {axis: f"{value:.9f}" for axis, value in zip(axes, turned, strict=True)}
            writer.writerow(row)
    return to
