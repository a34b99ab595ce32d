"""The speeds of the drive test, as the installation and the mountings show them."""

from collections.abc import Iterator
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import core
from api.formats.writer import write_native_csv
from core import EventKind, Samples
from tests.drives import chunks, plain, remounted
from tests.service import Api, Device, Json
from tests.watched import pieces

ROWS = 130


@cache
def started_and_confirmed() -> tuple[float, float]:
    """Give when the drive test of `plain` starts, and when it ends."""
    state = core.begin_session(core.DEFAULT, core.initial_state(core.DEFAULT))
    events = core.advance(core.DEFAULT, state, plain().samples)[1].events
    started = [event.t for event in events if event.kind is EventKind.VERIFICATION_STARTED]
    return started[-1], next(event.t for event in events if event.kind is EventKind.CONFIRMED)


def bodies(samples: Samples, seconds: float) -> Iterator[bytes]:
    return (write_native_csv(piece) for piece in pieces(samples, seconds))


def send(device: Device, samples: Samples, seconds: float, session: str = "a") -> list[Json]:
    """Send samples in chunks; give what the installation showed of the drive test after each."""
    sent = enumerate(bodies(samples, seconds))
    answers = [device.send(body, seq, session, expect=200).json() for seq, body in sent]
    return [answer["installation"]["verification"] for answer in answers]


def check(verification: Json) -> None:
    """The trace is one of the test."""
    trace = verification["trace"]
    t, gps, sensor = (np.array(trace[name]) for name in ("t", "gps_mps", "sensor_mps"))
    assert t.shape == gps.shape == sensor.shape
    assert verification["elapsed_s"] - 2 <= t.size <= min(verification["elapsed_s"] + 2, ROWS)
    assert np.all(np.diff(t) > 0)
    if verification["state"] == "passed":
        assert abs(sensor[-1] - gps[-1]) == pytest.approx(verification["error_mps"], abs=0.011)


def test_the_trace_grows_with_the_test_and_stays(api: Api) -> None:
    device = api.add_device()
    assert device.installation()["verification"]["trace"] is None
    shown = send(device, plain().samples, 7.0)
    tested = [verification for verification in shown if verification["trace"]]
    for verification in tested:
        check(verification)
    assert {verification["state"] for verification in tested} == {"running", "passed"}
    assert [v["state"] for v in shown if v["trace"] is None and v["elapsed_s"] > 0] == []
    started, confirmed = started_and_confirmed()
    trace = shown[-1]["trace"]
    assert started < trace["t"][0] < started + 5
    assert trace["t"][-1] == pytest.approx(confirmed, abs=0.006)
    assert device.get("mounts/1")["verification"] == shown[-1]
    assert device.get("mount")["verification"] == shown[-1]


def test_other_pieces_give_the_same_trace(api: Api) -> None:
    shown = [send(api.add_device(f"box-{s:.0f}"), plain().samples, s)[-1] for s in (7.0, 30.0, 1000.0)]
    assert shown[0] == shown[1] == shown[2]


def test_a_chunk_may_hold_several_tests(api: Api) -> None:
    """The end of one, the device turned, and all of the next."""
    at_once, apart = api.add_device("at-once"), api.add_device("apart")
    send(at_once, remounted().samples, 2000.0)
    apart.send_all(remounted().chunks)
    mounts = at_once.get("mounts")["items"]
    assert [mount["id"] for mount in mounts] == [2, 1]
    assert mounts == [
        mount | {"confirmed_at": own["confirmed_at"]}  # by when the chunks came in
        for mount, own in zip(apart.get("mounts")["items"], mounts, strict=True)
    ]
    for mount in mounts:
        check(mount["verification"])
    assert mounts[1]["verification"]["trace"]["t"][-1] < mounts[0]["verification"]["trace"]["t"][0]
    assert at_once.installation()["verification"] == mounts[0]["verification"]


def test_while_no_test_has_tested_anything_there_is_no_trace(api: Api) -> None:
    device = api.add_device()
    for seq, body in enumerate(remounted().chunks):
        verification = device.send(body, seq, expect=200).json()["installation"]["verification"]
        if seq >= remounted().confirmed:
            assert (verification["trace"] is None) == (verification["elapsed_s"] == 0)
        if seq == remounted().moved:
            assert verification["trace"] is None or verification["state"] == "running"
    assert verification["state"] == "passed"


def test_a_restart_ends_the_trace_but_not_that_of_the_mounting(api: Api) -> None:
    device = api.add_device()
    verification = device.send_all(chunks())["installation"]["verification"]
    assert device.admin.post(f"/devices/{device.id}/installation/restart")["verification"]["trace"] is None
    assert device.get("mounts/1")["verification"] == verification


def test_a_power_cut_during_the_test_begins_the_trace_anew_by_the_new_clock(api: Api) -> None:
    device, samples = api.add_device(), plain().samples
    started, _ = started_and_confirmed()
    cut = int(np.searchsorted(samples.t, started + 15.0))
    before = send(device, samples.slice(0, cut), 30.0)[-1]
    assert (before["state"], len(before["trace"]["t"]) > 5) == ("running", True)
    after = samples.slice(cut, len(samples))
    shown = send(device, replace(after, t=after.t - after.t[0]), 10.0, "b")[0]
    assert shown["elapsed_s"] > before["elapsed_s"]
    assert 0 < shown["trace"]["t"][0] < 10.0
