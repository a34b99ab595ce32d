"""What the installation tells of the last data."""

from dataclasses import replace

import numpy as np
import pytest

import core
from api.formats.writer import write_native_csv
from core import Samples
from tests.service import Api, Device, Json
from tests.watched import drive, parked, pieces

HEADER = b"t,ax,ay,az,fix,speed,course\n"
SPEED, COURSE = (core.FIX_COLUMNS.index(name) for name in ("speed", "course"))


@pytest.fixture
def device(api: Api) -> Device:
    return api.add_device()


def data_after(device: Device, samples: Samples, seq: int = 0) -> Json:
    shown = device.send(write_native_csv(samples), seq, expect=200).json()["installation"]
    assert shown == device.installation()
    data: Json = shown["data"]
    return data


def test_a_chunk_of_a_vehicle_that_stands(device: Device) -> None:
    assert data_after(device, parked(0.0)) == {
        "session": "a",
        "sample_rate_hz": 2.0,
        "fix_rate_hz": 1.0,
        "has_fix": True,
        "speed_mps": 0.0,
        "gyroscope": False,
        "span_s": 59.5,
        "rejected": {},
    }


def test_a_chunk_of_a_drive_with_a_gyroscope(device: Device) -> None:
    samples = next(pieces(drive("city", 40.0, rate=50.0), 30.0))
    data = data_after(device, samples)
    assert data["gyroscope"]
    assert data["sample_rate_hz"] == 50.0
    assert data["fix_rate_hz"] == pytest.approx(4.0, abs=4.0 / 120)  # one more or less in the chunk
    assert data["speed_mps"] == pytest.approx(samples.fix[-1, SPEED], abs=0.006)


def test_a_receiver_that_has_lost_its_fix(device: Device) -> None:
    samples = parked(0.0)
    lost = np.arange(samples.fix_row.size) < 45
    data = data_after(device, replace(samples, fix_valid=lost))
    assert (data["has_fix"], data["speed_mps"], data["fix_rate_hz"]) == (False, 0.0, 0.75)
    data = data_after(device, parked(60.0, fix=False), 1)
    assert (data["has_fix"], data["speed_mps"], data["fix_rate_hz"]) == (False, None, 0.0)


def test_a_receiver_that_tells_only_where_it_is(device: Device) -> None:
    samples = next(pieces(drive("city", 40.0), 30.0))
    fix = samples.fix.copy()
    fix[:, [SPEED, COURSE]] = np.nan
    assert data_after(device, replace(samples, fix=fix))["speed_mps"] == pytest.approx(samples.fix[-1, SPEED], abs=4.0)


def test_what_was_not_used_is_counted_and_no_part_of_the_rates(device: Device) -> None:
    first, again = parked(0.0), parked(0.0, 120.0)
    data_after(device, first)
    data = data_after(device, again, 1)
    assert data["rejected"] == {"before_previous_sample": 119, "duplicate_time": 1}
    assert data["sample_rate_hz"] == pytest.approx(119 / 119.5, abs=0.001)


def test_one_sample_has_no_rate(device: Device) -> None:
    device.send(HEADER + b"1.0,0,0,9.81,1,3.0,90\n", 0, expect=200)
    data = device.installation()["data"]
    assert (data["sample_rate_hz"], data["fix_rate_hz"], data["span_s"]) == (None, None, 0.0)
    assert (data["has_fix"], data["speed_mps"]) == (True, 3.0)


def test_it_is_about_the_last_chunk_that_was_applied(device: Device) -> None:
    told = data_after(device, parked(0.0))
    device.send(write_native_csv(parked(120.0, 30.0)), 2, expect=202)
    assert device.installation()["data"] == told
    device.send(write_native_csv(parked(60.0)), 1, expect=200)
    assert device.installation()["data"]["span_s"] == 29.5
    device.send(write_native_csv(parked(0.0, 10.0)), 0, "b", expect=200)
    assert device.installation()["data"]["session"] == "b"


def test_it_stays_when_the_installation_is_restarted(device: Device) -> None:
    told = data_after(device, parked(0.0))
    assert device.admin.post(f"/devices/{device.id}/installation/level")["data"] == told
    assert device.admin.post(f"/devices/{device.id}/installation/restart")["data"] == told
