"""The accelerometer's calibration as a setting of the device."""

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from api.formats.writer import write_native_csv
from tests.core.poses import random_calibration
from tests.drives import CHUNK_SECONDS, RATE, chunks, plain
from tests.service import Api, Device

TRUTH = random_calibration(np.random.default_rng(1))
SETTING = {"gain": TRUTH.gain.tolist(), "offset": TRUTH.offset.tolist()}
LENGTH = 6
"""chunks, until there are estimates to compare"""


@cache
def distorted() -> tuple[bytes, ...]:
    """The drive as an accelerometer with these errors reads it."""
    samples, step = plain().samples, int(CHUNK_SECONDS * RATE)
    samples = replace(samples, f_s=samples.f_s @ TRUTH.gain.T + TRUTH.offset)
    return tuple(write_native_csv(samples.slice(n * step, (n + 1) * step)) for n in range(LENGTH))


def estimates(device: Device) -> np.ndarray:
    shown = device.get("estimates")
    return np.column_stack([shown["t"], shown["quaternion"]])


def patch(api: Api, device_id: str, calibration: Any, expect: int = 200) -> Any:
    return api.call("PATCH", f"/devices/{device_id}", expect, json={"accelerometer_calibration": calibration}).json()


def test_it_is_kept_with_the_device_exactly(api: Api) -> None:
    made = api.post("/devices", {"id": "a", "name": "A", "accelerometer_calibration": SETTING}, 201)
    assert made["device"]["accelerometer_calibration"] == SETTING
    assert api.get("/devices/a")["accelerometer_calibration"] == SETTING
    assert api.get("/devices")["items"][0]["accelerometer_calibration"] == SETTING
    edited = api.call("PATCH", "/devices/a", 200, json={"name": "B"}).json()
    assert (edited["name"], edited["accelerometer_calibration"]) == ("B", SETTING)
    plain_ = {"gain": np.eye(3).tolist(), "offset": [0.0, 0.0, 0.0]}
    assert patch(api, "a", plain_)["accelerometer_calibration"] == plain_
    assert patch(api, "a", None)["accelerometer_calibration"] is None
    assert api.get("/devices/a")["accelerometer_calibration"] is None


def gain(row: int, column: int, value: Any) -> list[list[Any]]:
    made: list[list[Any]] = np.eye(3).tolist()
    made[row][column] = value
    return made


@pytest.mark.parametrize(
    ("calibration", "words"),
    [
        (SETTING | {"gain": gain(0, 0, 0.7)}, "gains are 0.7, 1, 1"),
        (SETTING | {"gain": gain(0, 0, -1.0)}, "gains"),
        (SETTING | {"gain": gain(0, 1, 0.1)}, "not symmetric"),
        (SETTING | {"gain": gain(0, 0, None)}, "valid number"),
        (SETTING | {"gain": np.eye(2).tolist()}, "required"),
        (SETTING | {"gain": (np.eye(3) + 0.3 * (1 - np.eye(3))).tolist()}, "cross gains are 0.3"),
        (SETTING | {"offset": [0, 0, 3.5]}, "offsets are 0, 0, 3.5 m/s2"),
        (SETTING | {"offset": [0, 0]}, "required"),
        ({"gain": SETTING["gain"]}, "required"),
        (SETTING | {"rms": 1}, "not permitted"),
        ([], "valid dictionary"),
    ],
)
def test_one_that_no_accelerometer_has_is_refused(api: Api, calibration: Any, words: str) -> None:
    api.add_device("a", accelerometer_calibration=SETTING)
    problem = patch(api, "a", calibration, 422)
    assert problem["errors"][0]["pointer"].startswith("/body/accelerometer_calibration")
    assert words in problem["errors"][0]["message"]
    api.post("/devices", {"id": "b", "name": "B", "accelerometer_calibration": calibration}, 422)
    assert api.get("/devices/a")["accelerometer_calibration"] == SETTING


@pytest.mark.parametrize("number", ["NaN", "Infinity", "-1e999"])
def test_numbers_that_are_none_are_refused(api: Api, number: str) -> None:
    api.add_device("a")
    body = f'{{"accelerometer_calibration": {{"gain": [[1,0,0],[0,1,0],[0,0,1]], "offset": [{number}, 0, 0]}}}}'
    api.call("PATCH", "/devices/a", 422, content=body.encode(), headers={"Content-Type": "application/json"})
    assert api.get("/devices/a")["accelerometer_calibration"] is None


def test_the_estimator_gets_what_a_perfect_accelerometer_would_read(api: Api) -> None:
    flawless = {"gain": np.eye(3).tolist(), "offset": [0.0, 0.0, 0.0]}
    perfect = api.add_device("a", accelerometer_calibration=flawless)
    ignorant = api.add_device("b")
    calibrated = api.add_device("c", accelerometer_calibration=SETTING)
    perfect.send_all(chunks()[:LENGTH])
    calibrated.send_all(distorted())
    ignorant.send_all(distorted())
    assert len(estimates(perfect)) > 10
    np.testing.assert_allclose(estimates(calibrated), estimates(perfect), atol=2e-4)
    assert np.abs(estimates(ignorant)[-5:] - estimates(perfect)[-5:]).max() > 3e-3


def test_a_change_tells_on_later_chunks_alone(api: Api) -> None:
    changed, same = api.add_device("a"), api.add_device("b")
    for device in (changed, same):
        device.send_all(distorted()[:4])
    before = estimates(changed)
    patch(api, "a", SETTING)
    np.testing.assert_array_equal(estimates(changed), before)
    for device in (changed, same):
        device.send_all(distorted()[4:], start=4)
    np.testing.assert_array_equal(estimates(changed)[: len(before)], before)
    assert np.abs(estimates(changed)[-1] - estimates(same)[-1]).max() > 1e-3
    assert changed.send(distorted()[0], 0).json()["chunk"]["duplicate"]


def test_a_chunk_that_waited_is_corrected_too(api: Api) -> None:
    waited, told = api.add_device("a"), api.add_device("b", accelerometer_calibration=SETTING)
    for seq in (*range(1, LENGTH), 0):
        if seq == 0:
            patch(api, "a", SETTING)
        waited.send(distorted()[seq], seq)
    told.send_all(distorted())
    np.testing.assert_array_equal(estimates(waited), estimates(told))
