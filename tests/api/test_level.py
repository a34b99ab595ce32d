"""An installer says that the vehicle stands on level ground."""

from functools import cache

import pytest

from api.formats.writer import write_native_csv
from core.simulation import Scenario, simulate
from tests.conftest import Clock
from tests.drives import chunks
from tests.service import Api, Device


@pytest.fixture
def device(api: Api) -> Device:
    return api.add_device()


@cache
def parked() -> bytes:
    return write_native_csv(simulate(Scenario("parked", 20.0, 1, imu_rate=50.0)).samples)


def test_a_vehicle_that_stands_still(device: Device) -> None:
    before = device.send(parked(), 0, expect=200).json()["installation"]
    shown = device.admin.post(f"/devices/{device.id}/installation/level")
    assert shown["revision"] > before["revision"]
    assert {**shown, "revision": 0} == {**device.installation(), "revision": 0}
    assert device.installation()["revision"] == shown["revision"]


def test_one_that_moves(device: Device) -> None:
    device.send_all(chunks()[:3])
    before = device.installation()
    problem = device.admin.post(f"/devices/{device.id}/installation/level", expect=409)
    assert problem["type"].endswith("not-still")
    assert problem["title"] == "The vehicle is not standing still"
    assert problem["detail"] == "The vehicle was moving within the last 2 seconds of what the device sent."
    assert device.installation() == before


def test_one_that_has_sent_nothing(device: Device) -> None:
    problem = device.admin.post(f"/devices/{device.id}/installation/level", expect=409)
    assert problem["detail"] == "The device has sent no data since it was switched on."


def test_one_that_has_been_silent_for_long(device: Device, clock: Clock) -> None:
    device.send(parked(), 0, expect=200)
    clock.advance(299)
    device.admin.post(f"/devices/{device.id}/installation/level")
    clock.advance(2)
    problem = device.admin.post(f"/devices/{device.id}/installation/level", expect=409)
    assert problem["detail"] == "The device has sent nothing for 5 minutes: nobody can tell if it stands still."


def test_one_that_is_not_there(api: Api) -> None:
    api.post("/devices/nobody/installation/level", expect=404)
