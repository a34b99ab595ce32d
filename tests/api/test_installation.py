from datetime import datetime, timedelta
from typing import Any

import numpy as np
import pytest
import sqlalchemy as sa

import core
from api.services import history, presenting
from api.services.calibration import stage_began
from storage.database import Database
from storage.models import installations
from tests.conftest import Clock
from tests.drives import CHUNK_SECONDS, chunks, plain, remounted
from tests.service import Api, Device


@pytest.fixture
def device(api: Api) -> Device:
    return api.add_device()


@pytest.fixture
def confirmed(device: Device) -> Device:
    device.send_all(chunks())
    return device


def when(text: str) -> datetime:
    return datetime.fromisoformat(text)


def test_a_new_device_waits_for_data(device: Device) -> None:
    assert device.installation() == {
        "device_id": "box-1",
        "stage": "waiting",
        "since": "2024-05-06T07:08:09Z",
        "progress": 0.0,
        "needs": ["data"],
        "hint": "Waiting for data: switch the device on and check that it can send.",
        "estimate": None,
        "verification": {
            "state": "idle",
            "elapsed_s": 0.0,
            "duration_s": 40.0,
            "error_mps": 0.0,
            "limit_mps": 2.5,
            "trace": None,
        },
        "mount": None,
        "limits": {"yaw_sigma_deg": 1.3, "tilt_sigma_deg": 1.2},
        "open_alerts": 0,
        "last_data_at": None,
        "data": None,
        "revision": 0,
    }


def test_the_installation_is_what_the_estimator_says(confirmed: Device) -> None:
    state = core.begin_session(core.DEFAULT, core.initial_state(core.DEFAULT))
    _, outcome = core.advance(core.DEFAULT, state, plain().samples)
    now, shown = outcome.status, confirmed.installation()
    assert now.estimate is not None
    assert now.mount is not None
    assert shown["stage"] == now.stage.word
    assert shown["progress"] == pytest.approx(now.progress, abs=0.02)
    np.testing.assert_allclose(shown["estimate"]["quaternion"], now.estimate.quaternion, atol=1e-4)
    np.testing.assert_allclose(shown["mount"]["quaternion"], now.mount.quaternion, atol=1e-4)
    np.testing.assert_allclose(shown["mount"]["sigma_deg"], np.degrees(now.mount.sigma), atol=1e-2)
    for part in (shown["estimate"], shown["mount"]):
        angles = np.radians([part["angles_deg"][name] for name in ("roll", "pitch", "yaw")])
        np.testing.assert_allclose(core.quaternion.from_angles(*angles), part["quaternion"], atol=1e-9)
        np.testing.assert_allclose(core.quaternion.matrix(part["quaternion"]), part["matrix"], atol=1e-12)


def test_times_are_on_the_devices_clock_and_never_in_the_future(confirmed: Device, clock: Clock) -> None:
    """The drive was replayed at once: it then ended now, and its stages lie in the past."""
    shown, history_ = confirmed.installation(), confirmed.get("estimates")
    seconds = float(plain().samples.t[-1])
    started_at = clock.now - timedelta(seconds=seconds)
    assert when(history_["time"][-1]) <= clock.now
    for t, time in zip(history_["t"], history_["time"], strict=True):
        assert abs(when(time) - started_at - timedelta(seconds=t)) < timedelta(milliseconds=2)
    confirmed_at = when(shown["mount"]["confirmed_at"])
    assert when(shown["since"]) == confirmed_at or abs(when(shown["since"]) - confirmed_at) < timedelta(seconds=5)
    assert started_at < confirmed_at < clock.now
    assert when(shown["last_data_at"]) == clock.now


def test_the_clock_of_a_session_is_set_by_its_least_delayed_chunk(device: Device, clock: Clock) -> None:
    start = clock.now
    for seq, (body, delay) in enumerate(zip(chunks()[:4], (90, 5, 60, 30), strict=True)):
        clock.now = start + timedelta(seconds=(seq + 1) * CHUNK_SECONDS + delay)
        device.send(body, seq, expect=200)
    shown = device.get("estimates")
    error = when(shown["time"][-1]) - (start + timedelta(seconds=shown["t"][-1] + 5))
    assert abs(error) < timedelta(seconds=0.1)


# ---------------------------------------------------------------- mountings


def test_a_mounting_is_read_until_it_changes(confirmed: Device) -> None:
    path = f"/devices/{confirmed.id}/mount"
    first = confirmed.api.call("GET", path, 200)
    tag = first.headers["etag"]
    for given in (tag, f"W/{tag}", f'"x", {tag}'):
        unchanged = confirmed.api.call("GET", path, 304, headers={"If-None-Match": given})
        assert unchanged.content == b""
        assert unchanged.headers["etag"] == tag
    assert first.json() == confirmed.get("mounts/1") == confirmed.get("mounts")["items"][0]
    confirmed.admin.post(f"/devices/{confirmed.id}/installation/restart")
    confirmed.api.call("GET", path, 404, headers={"If-None-Match": tag})


def test_an_installation_is_read_until_it_changes(device: Device) -> None:
    path = f"/devices/{device.id}/installation"
    first = device.api.call("GET", path, 200)
    tag = first.headers["etag"]
    unchanged = device.api.call("GET", path, 304, headers={"If-None-Match": tag})
    assert (unchanged.content, unchanged.headers["etag"]) == (b"", tag)
    device.send(plain().chunks[0], 0, expect=200)
    changed = device.api.call("GET", path, 200, headers={"If-None-Match": tag})
    assert changed.json()["revision"] > first.json()["revision"]
    assert changed.headers["etag"] != tag
    device.admin.call("DELETE", f"/devices/{device.id}", 204)
    again = device.admin.add_device(device.id)
    assert again.installation()["revision"] == first.json()["revision"]
    again.api.call("GET", path, 200, headers={"If-None-Match": tag})


def test_no_mounting_yet_is_a_problem_that_says_so(device: Device) -> None:
    problem = device.get("mount", 404)
    assert problem["detail"] == "No mounting is confirmed yet."
    assert device.get("mounts") == {"items": [], "next_cursor": None}
    assert device.get("mounts/1", 404)["status"] == 404
    assert device.get("mounts/0", 422)["errors"][0]["pointer"] == "/path/n"


def test_a_moved_device_makes_its_mounting_suspect_until_a_new_one_is_confirmed(device: Device) -> None:
    story = remounted()
    device.send_all(story.chunks[: story.moved])
    tag = device.api.call("GET", f"/devices/{device.id}/mount", 200).headers["etag"]
    suspect = device.send(story.chunks[story.moved], story.moved).json()["installation"]
    assert suspect["mount"]["status"] == "suspect"
    assert suspect["open_alerts"] == 1
    moved = device.api.call("GET", f"/devices/{device.id}/mount", 200, headers={"If-None-Match": tag})
    assert moved.json()["status"] == "suspect"
    done = device.send_all(story.chunks[story.moved + 1 :], start=story.moved + 1)["installation"]
    assert (done["mount"]["id"], done["mount"]["status"], done["open_alerts"]) == (2, "in_force", 0)
    newest, oldest = device.get("mounts")["items"]
    assert (newest["id"], oldest["id"], oldest["status"]) == (2, 1, "superseded")
    assert oldest["verification"]["state"] == "passed"
    page = device.get("mounts", params={"limit": 1})
    assert [m["id"] for m in page["items"]] == [2]
    assert [m["id"] for m in device.get("mounts", params={"cursor": page["next_cursor"]})["items"]] == [1]


def test_a_restart_forgets_the_mounting_and_keeps_the_history(confirmed: Device, clock: Clock) -> None:
    before = confirmed.get("estimates")
    clock.advance(100)
    revision = confirmed.installation()["revision"]
    fresh = confirmed.admin.post(f"/devices/{confirmed.id}/installation/restart")
    assert fresh["stage"] in {"waiting", "aligning"}
    assert fresh["mount"] is None
    assert fresh["progress"] < 0.2
    assert when(fresh["since"]) == clock.now
    assert fresh["revision"] > revision
    assert confirmed.get("estimates") == before
    assert [m["status"] for m in confirmed.get("mounts")["items"]] == ["superseded"]
    again = confirmed.send_all(chunks(4), session="b")["installation"]
    assert (again["stage"], again["mount"]["id"]) == ("confirmed", 2)


def test_a_snapshot_of_another_version_starts_the_calibration_anew(confirmed: Device, database: Database) -> None:
    with database.write() as tx:
        tx.execute(sa.update(installations).values(snapshot=b"of another version"))
    answer = confirmed.send(chunks(4)[0], 0, "b", expect=200).json()["installation"]
    assert answer["stage"] != "confirmed"
    assert answer["mount"]["status"] == "in_force"
    assert confirmed.send_all(chunks(4)[1:], "b", 1)["installation"]["mount"]["id"] == 2


# ---------------------------------------------------------------- history


def test_the_history_is_that_of_the_drive_at_once(confirmed: Device) -> None:
    params = core.DEFAULT.__class__(**{**core.DEFAULT.__dict__, "report_interval": 5.0})
    state = core.begin_session(params, core.initial_state(params))
    rows = core.advance(params, state, plain().samples)[1].estimates
    shown = confirmed.get("estimates")
    np.testing.assert_allclose(shown["t"], rows.t)
    assert shown["stage"] == [core.Stage(stage).word for stage in rows.stage]
    assert shown["stable"] == rows.stable.tolist()
    assert shown["reliable"] == rows.reliable.tolist()
    np.testing.assert_allclose(shown["quaternion"], rows.quaternion, atol=1e-4)
    np.testing.assert_allclose(shown["sigma_deg"], np.degrees(rows.sigma), rtol=1e-2, atol=1e-4)
    assert {len(column) for name, column in shown.items() if name != "angles_deg"} == {rows.t.size}
    for name, column in shown["angles_deg"].items():
        assert column[-1] == pytest.approx(confirmed.installation()["estimate"]["angles_deg"][name], abs=1.0)
    assert set(shown["session"]) == {"a"}


def test_the_history_is_cut_to_a_period(confirmed: Device) -> None:
    everything = confirmed.get("estimates")
    start, end = everything["time"][5], everything["time"][20]
    part = confirmed.get("estimates", params={"from": start, "to": end})
    assert part["time"] == everything["time"][5:21]
    assert confirmed.get("estimates", params={"from": everything["time"][-1]})["t"] == everything["t"][-1:]
    assert confirmed.get("estimates", params={"to": "2000-01-01T00:00:00Z"})["t"] == []
    plus_two = when(start).astimezone().isoformat()
    assert confirmed.get("estimates", params={"from": plus_two, "to": end})["time"] == part["time"]
    for wrong in ("yesterday", "2024-05-06T07:08:09"):
        assert confirmed.get("estimates", 422, params={"from": wrong})["errors"][0]["pointer"] == "/query/from"


def test_the_history_is_thinned(confirmed: Device) -> None:
    everything = confirmed.get("estimates")
    thin = confirmed.get("estimates", params={"max_points": 10})
    assert len(thin["t"]) <= 10
    assert (thin["t"][0], thin["t"][-1]) == (everything["t"][0], everything["t"][-1])
    assert stages(thin["stage"]) == stages(everything["stage"])


def stages(column: list[str]) -> list[str]:
    return [stage for n, stage in enumerate(column) if n == 0 or stage != column[n - 1]]


@pytest.mark.parametrize("max_points", [2, 3, 10, 99, 100, 101])
@pytest.mark.parametrize("changes", [0, 1, 5, 99])
def test_thinning_keeps_first_last_and_changes(max_points: int, changes: int) -> None:
    stage = np.zeros(100, np.uint8)
    at = np.random.default_rng(changes).permutation(np.arange(1, 100))[:changes]
    for start in at:
        stage[start:] += 1
    kept = history.thin(stage, max_points)
    assert kept.size <= max_points
    assert (np.diff(kept) > 0).all()
    assert (kept[0], kept[-1]) == (0, 99)
    if changes + 2 <= max_points:
        assert set(at) <= set(kept.tolist())
    if max_points >= 100:
        assert kept.size == 100


# ---------------------------------------------------------------- words


def test_hints_cover_every_need() -> None:
    assert set(presenting.HINTS) == {word for need in core.Needs for word in need.words}
    assert presenting.hint("aligning", ["turn", "gps_fix"]).startswith("Waiting for a GPS fix")
    assert presenting.hint("confirmed", []) == presenting.NOTHING_NEEDED
    assert presenting.hint("settling", []) == presenting.HINTS["time"]


@pytest.mark.parametrize(
    ("before", "rows", "final", "began"),
    [
        (0, [0, 0, 0], 0, None),
        (0, [0, 1, 1], 1, 20.0),
        (1, [1, 1, 1], 2, 35.0),
        (0, [1, 1, 1], 1, 10.0),
        (4, [4, 1, 4], 4, 30.0),
        (0, [], 1, 35.0),
        (1, [], 1, None),
    ],
)
def test_a_stage_began_at_the_first_row_that_shows_it(
    before: int, rows: list[int], final: int, began: float | None
) -> None:
    none: Any = np.empty(0)
    t = np.array([10.0 * n for n in range(1, len(rows) + 1)])
    table = core.Estimates(t, none, none, np.array(rows, np.int64), none, none, none, none)
    status: Any = type("Status", (), {"stage": core.Stage(final)})
    outcome = core.Outcome(1, 0, {}, table, (), status, np.nan, core.Speeds(none, none, none, none))
    assert stage_began(core.Stage(before), outcome, 35.0) == began
