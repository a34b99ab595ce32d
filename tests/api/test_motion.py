"""Motion computed on demand: what it tells is what the vehicle did."""

from datetime import datetime, timedelta

import numpy as np
import pytest

from api.overload import MOST_COMPUTATIONS, Gate
from core import quaternion
from tests.conftest import Clock
from tests.crashes import crashed
from tests.drives import CHUNK_SECONDS, chunks, plain, remounted
from tests.service import Api, Device, Json


def play(device: Device, clock: Clock, bodies: tuple[bytes, ...], session: str = "a") -> datetime:
    """Send chunks at their time; give the zero of the session's clock."""
    begun = clock.now
    for seq, body in enumerate(bodies):
        clock.advance(CHUNK_SECONDS)
        device.send(body, seq, session, expect=200)
    return begun


def ask(
    device: Device, expect: int = 200, start: datetime | None = None, end: datetime | None = None, n: int = 1000
) -> Json:
    query = {"max_points": n, "from": start and start.isoformat(), "to": end and end.isoformat()}
    answer: Json = device.get("motion", expect, params={name: value for name, value in query.items() if value})
    return answer


def column(motion: Json, name: str) -> np.ndarray:
    return np.array(motion["columns"][name], np.float64)


def test_it_is_what_the_vehicle_did(api: Api, clock: Clock) -> None:
    story, device = crashed(), api.add_device()
    play(device, clock, story.chunks[: story.struck])
    motion, truth = ask(device, n=10_000), story.drive.truth
    assert len({len(values) for values in motion["columns"].values()}) == 1
    t = column(motion, "t")
    assert t.size > 1000
    moving = np.interp(t, truth.t, truth.speed) > 3.0
    speed = column(motion, "speed_mps")[moving] - np.interp(t, truth.t, truth.speed)[moving]
    assert np.sqrt(np.mean(speed**2)) < 0.5
    heading = np.degrees(np.interp(t, truth.t, np.unwrap(np.arctan2(*_forward(truth.q_nv)))))
    off = (column(motion, "heading_deg")[moving] - heading[moving] + 180) % 360 - 180
    assert np.sqrt(np.mean(off**2)) < 4.0
    q = np.array(motion["columns"]["quaternion"])
    np.testing.assert_allclose(np.linalg.norm(q, axis=1), 1.0, atol=1e-6)
    roll, pitch, _ = np.degrees(quaternion.all_angles(q)).T
    np.testing.assert_allclose(column(motion, "roll_deg"), roll, atol=1e-5)
    np.testing.assert_allclose(column(motion, "pitch_deg"), pitch, atol=1e-5)
    assert abs(float(np.median(column(motion, "vertical_mps2")))) < 0.3
    assert motion["vehicle"] == "sedan"
    assert motion["origin"]["lat"] == pytest.approx(45.67, abs=0.1)


def _forward(q_nv: np.ndarray) -> np.ndarray:
    """East and north of the vehicle's x axis."""
    return quaternion.matrix(q_nv)[:, :2, 0].T


def test_it_begins_when_the_mounting_came_into_force(api: Api, clock: Clock) -> None:
    device = api.add_device()
    play(device, clock, chunks())
    motion = ask(device)
    confirmed = device.get("mount")["confirmed_at"]
    assert (motion["mount"], motion["from"]) == (1, confirmed)
    told = [datetime.fromisoformat(at) for at in motion["columns"]["at"]]
    assert told == sorted(told)
    assert datetime.fromisoformat(confirmed) <= told[0] < told[-1] <= datetime.fromisoformat(motion["to"])


def test_without_a_mounting_there_is_none(api: Api, clock: Clock) -> None:
    device = api.add_device()
    assert ask(device)["mount"] is None
    begun = play(device, clock, chunks()[: plain().confirmed])
    motion = ask(device)
    assert (motion["mount"], motion["origin"]) == (None, None)
    assert not any(motion["columns"].values())
    play(device, clock, chunks(), "b")
    assert ask(device, 200, begun, begun + timedelta(seconds=30))["mount"] is None


def test_each_mounting_counts_in_its_time(api: Api, clock: Clock) -> None:
    """From when it was confirmed until it was in doubt."""
    story, device = remounted(), api.add_device()
    begun = play(device, clock, story.chunks)
    newer, former = device.get("mounts")["items"]
    early = ask(device, 200, begun, begun + timedelta(seconds=CHUNK_SECONDS * (story.confirmed + 2)))
    assert (early["mount"], early["from"]) == (1, former["confirmed_at"])
    assert ask(device)["mount"] == newer["id"] == 2
    doubt = begun + timedelta(seconds=CHUNK_SECONDS * (story.moved + 1))
    before = ask(device, 200, doubt - timedelta(minutes=3), doubt)
    assert before["mount"] == 1
    ended = datetime.fromisoformat(before["to"])
    assert datetime.fromisoformat(before["columns"]["at"][-1]) <= ended < doubt
    lost = datetime.fromisoformat(newer["confirmed_at"]) - timedelta(seconds=20)
    assert ask(device, 200, lost, lost + timedelta(seconds=10))["mount"] is None


def test_thinned_rows_keep_the_peak(api: Api, clock: Clock) -> None:
    story, device = crashed(), api.add_device()
    play(device, clock, story.chunks)
    fine, coarse = ask(device, n=10_000), ask(device, n=50)
    assert 40 <= len(coarse["columns"]["at"]) <= 50
    plans = [np.hypot(column(m, "longitudinal_mps2"), column(m, "lateral_mps2")) for m in (fine, coarse)]
    assert plans[0].max() == plans[1].max() > 50.0
    assert set(coarse["columns"]["at"]) <= set(fine["columns"]["at"])
    t = column(coarse, "t")
    assert np.diff(t).max() < 3 * (t[-1] - t[0]) / 50
    assert len(ask(device, n=2)["columns"]["at"]) == 2


def test_sessions_are_told_in_one_frame(api: Api, clock: Clock) -> None:
    device = api.add_device()
    play(device, clock, chunks(), "a")
    play(device, clock, chunks(), "b")
    motion = ask(device, n=10_000)
    names = np.array(motion["columns"]["session"])
    assert list(dict.fromkeys(names.tolist())) == ["a", "b"]
    east, north = column(motion, "east_m"), column(motion, "north_m")
    both = [
        (float(np.nanmax(x[names == name])), float(np.nanmin(x[names == name]))) for x in (east, north) for name in "ab"
    ]
    # the same streets: the frames of both sessions agree
    assert np.abs(np.subtract(both[::2], both[1::2])).max() < 60.0


def test_a_part_is_told_as_within_the_whole(api: Api, clock: Clock) -> None:
    device = api.add_device()
    begun = play(device, clock, chunks())
    whole = ask(device, n=10_000)
    start, end = begun + timedelta(seconds=150), begun + timedelta(seconds=200)
    part = ask(device, 200, start, end, 10_000)
    rows = dict(zip(whole["columns"]["at"], whole["columns"]["speed_mps"], strict=True))
    both = [
        (rows[at], speed)
        for at, speed in zip(part["columns"]["at"], part["columns"]["speed_mps"], strict=True)
        if at in rows
    ]
    assert len(both) > 2000
    off = np.abs(np.subtract(*np.transpose(both)))
    assert (float(np.median(off)) < 0.15, float(off.max()) < 0.6) == (True, True)


def test_the_accelerometers_errors_are_taken_out_on_demand(api: Api, clock: Clock) -> None:
    device = api.add_device()
    play(device, clock, chunks())
    before = ask(device)
    gain = [[1.1, 0, 0], [0, 1.1, 0], [0, 0, 1.1]]
    calibration = {"gain": gain, "offset": [0.0, 0.0, 0.0]}
    api.call("PATCH", f"/devices/{device.id}", 200, json={"accelerometer_calibration": calibration})
    after = ask(device)
    vertical = [float(np.mean(column(motion, "vertical_mps2"))) for motion in (before, after)]
    assert vertical[0] != pytest.approx(vertical[1], abs=1e-3)


def test_the_class_of_the_vehicle_counts(api: Api, clock: Clock) -> None:
    device = api.add_device(vehicle_class="bus")
    assert api.get(f"/devices/{device.id}")["vehicle_class"] == "bus"
    play(device, clock, chunks())
    as_bus = ask(device)
    api.call("PATCH", f"/devices/{device.id}", 200, json={"vehicle_class": None})
    as_sedan = ask(device)
    assert (as_bus["vehicle"], as_sedan["vehicle"]) == ("bus", "sedan")
    assert as_bus["columns"] != as_sedan["columns"]
    api.call("PATCH", f"/devices/{device.id}", 422, json={"vehicle_class": "tank"})


def test_more_than_six_hours_are_refused(api: Api, clock: Clock) -> None:
    device = api.add_device()
    problem = ask(device, 422, clock.now - timedelta(hours=6, seconds=1), clock.now)
    assert problem["type"].endswith("span-too-long")
    assert "6 hours" in problem["detail"]
    ask(device, 200, clock.now - timedelta(hours=6), clock.now)
    ask(device, 422, clock.now - timedelta(days=1))


@pytest.mark.parametrize("moment", ["0001-01-01T00:00:00Z", "9999-12-31T23:59:59Z", "0001-01-01T00:00:00+14:00"])
def test_any_moment_may_be_asked_for(api: Api, clock: Clock, moment: str) -> None:
    device = api.add_device()
    play(device, clock, chunks()[:1])
    for name in ("from", "to"):
        for what in ("motion", "raw", "events"):
            answer = device.api.call("GET", f"/devices/{device.id}/{what}", params={name: moment})
            assert answer.status_code in {200, 404, 422}, (name, what)


@pytest.mark.parametrize("backend", ["sqlite"], indirect=True)
def test_one_computation_too_many_is_put_off(api: Api, clock: Clock) -> None:
    device = api.add_device()
    gate: Gate = api.client.app_state["gate"]
    taken = [gate.computation() for _ in range(MOST_COMPUTATIONS)]
    for computation in taken:
        computation.__enter__()
    answer = api.call("GET", f"/devices/{device.id}/motion", 503)
    assert 1 <= int(answer.headers["retry-after"]) <= 5
    for computation in taken:
        computation.__exit__(None, None, None)
    ask(device)
