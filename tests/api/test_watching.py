"""Every kind of alert that is raised by a rule: a log raises it, and a log ends it."""

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from datetime import datetime, timedelta

import pytest
import sqlalchemy as sa

from api.services import findings, watching
from api.services.context import Context
from api.settings import Settings
from core.simulation_faults import Disturbances
from storage import installations
from storage import models as tables
from storage.database import Database
from tests.conftest import Clock
from tests.service import Api, Json
from tests.watched import Player, alerts, drive, parked, pieces, the_alert, wandering


@pytest.fixture
def player(api: Api, clock: Clock) -> Player:
    return Player(api.add_device(), clock)


@pytest.fixture
def context(settings: Settings, clock: Clock) -> Iterator[Context]:
    """What a scheduled job works with, in a process of its own."""
    made = Context.make(settings, clock)
    yield made
    made.database.close()


def check(alert: Json, state: str, count: int, *words: str) -> None:
    assert (alert["state"], alert["count"]) == (state, count)
    assert alert["severity"] == "warning"
    assert set(alert["data"]) == set(findings.DATA)
    for word in words:
        assert word in alert["message"]
    if state == "resolved":
        assert alert["resolved_by"] == "service"
        assert alert["resolve_note"]
    assert alert["data"]["seen"] >= alert["data"]["threshold"]
    assert alert["data"]["since"] <= alert["data"]["at"]


def test_calibration_stalled_until_it_is_confirmed(player: Player, api: Api) -> None:
    crawl = list(pieces(drive("crawl", 1740.0)))  # not quite half of it above walking pace
    player.play(crawl, "a")
    player.play(crawl, "b")
    assert alerts(api, "calibration_stalled") == []
    player.play(crawl, "c")
    alert = the_alert(api, "calibration_stalled")
    check(alert, "open", 1, "Not confirmed after", "minutes of driving", "firmly fastened")
    assert 1800 <= alert["data"]["seen"] < 1900
    shown = player.device.installation()
    assert shown["open_alerts"] == 1
    player.play(pieces(drive("city", 480.0)), "d")
    assert player.device.installation()["stage"] == "confirmed"
    check(the_alert(api, "calibration_stalled"), "resolved", 1)


def test_verification_failing_until_a_test_is_passed(player: Player, api: Api) -> None:
    chunks = list(pieces(wandering(drive("city", 1500.0), 1.0, 240.0)))[:8]
    player.play(chunks[:3])
    assert alerts(api, "verification_failing") == []
    player.play(chunks[3:5])
    check(the_alert(api, "verification_failing"), "open", 1, "4 drive tests in a row", "restart the calibration")
    player.play(chunks[5:])
    check(the_alert(api, "verification_failing"), "resolved", 1)


def test_gps_lost_until_fixes_last(player: Player, api: Api) -> None:
    t = player.stand(0.0, 5)
    t = player.stand(t, 30, fix=False)
    assert alerts(api, "gps_lost") == []  # each chunk is half a second short of a minute
    t = player.stand(t, 1, fix=False)
    alert = the_alert(api, "gps_lost")
    check(alert, "open", 1, "without a GPS fix", "open sky")
    lost_at = datetime.fromisoformat(alert["opened_at"]) - timedelta(minutes=31)
    assert abs(datetime.fromisoformat(alert["data"]["since"]) - lost_at) < timedelta(seconds=2)
    player.send(parked(t, 30.0), 30.0)
    player.send(parked(t + 30.0, 30.0, fix=False), 30.0)
    assert the_alert(api, "gps_lost")["state"] == "open"
    player.stand(t + 60.0, 2)
    check(the_alert(api, "gps_lost"), "resolved", 1)


def test_a_single_fix_does_not_begin_the_count_of_gps_lost_anew(player: Player, api: Api) -> None:
    t = player.stand(0.0, 20, fix=False)
    player.send(parked(t, 30.0), 30.0)
    player.stand(t + 30.0, 11, fix=False)
    check(the_alert(api, "gps_lost"), "open", 1)


def test_device_silent_until_it_sends(
    player: Player, api: Api, clock: Clock, context: Context, database: Database
) -> None:
    api.add_device("never-sent")
    t = player.stand(0.0, 1)
    revision = player.device.installation()["revision"]
    clock.advance(71.9 * 3600)
    watching.find_silent(context)
    assert alerts(api, "device_silent") == []
    clock.advance(0.2 * 3600)
    watching.find_silent(context)
    watching.find_silent(context)
    alert = the_alert(api, "device_silent")
    check(alert, "open", 1, "sent nothing for 3 days", "has power")
    assert alert["data"]["since"] == "2024-05-06T07:09:09.000Z"
    shown = player.device.installation()
    assert (shown["open_alerts"], shown["revision"]) == (1, revision + 1)
    player.stand(t, 1)
    check(the_alert(api, "device_silent"), "resolved", 1)
    clock.advance(100 * 3600)
    watching.find_silent(context)
    assert [alert["state"] for alert in alerts(api, "device_silent")] == ["open", "resolved"]


def test_a_silence_that_somebody_resolved_is_not_told_again(
    player: Player, api: Api, clock: Clock, context: Context
) -> None:
    t = player.stand(0.0, 1)
    for silences in (1, 2):
        clock.advance(100 * 3600)
        watching.find_silent(context)
        newest = alerts(api, "device_silent")[0]
        api.post(f"/alerts/{newest['id']}/resolve", {"note": "laid up"})
        clock.advance(100 * 3600)
        watching.find_silent(context)
        assert [alert["state"] for alert in alerts(api, "device_silent")] == ["resolved"] * silences
        t = player.stand(t, 1)
        assert [alert["resolved_by"] for alert in alerts(api, "device_silent")] == ["admin"] * silences


def test_silent_devices_are_found_in_batches(
    api: Api, clock: Clock, context: Context, database: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(watching, "BATCH", 2)
    for n in range(5):
        api.add_device(f"box-{n}")
    with database.write() as tx:
        tx.execute(sa.update(tables.installations).values(last_data_at=clock.now))
    clock.advance(100 * 3600)
    watching.find_silent(context)
    assert len(alerts(api, "device_silent")) == 5
    with database.read() as tx:
        assert installations.silent(tx, "device_silent", clock.now, 0, 10) == []


def test_several_processes_may_look_for_silent_devices_at_once(
    api: Api, clock: Clock, context: Context, database: Database
) -> None:
    for n in range(8):
        api.add_device(f"box-{n}")
    with database.write() as tx:
        tx.execute(sa.update(tables.installations).values(last_data_at=clock.now))
    clock.advance(100 * 3600)
    with ThreadPoolExecutor(4) as pool:
        list(pool.map(watching.find_silent, [context] * 4))
    assert [alert["count"] for alert in alerts(api, "device_silent")] == [1] * 8


def test_clock_fault_when_it_runs_back(player: Player, api: Api) -> None:
    player.stand(1000.0, 3)
    player.stand(1100.0, 2)  # 80 s back
    check(the_alert(api, "clock_fault"), "open", 1, "run back by 80 s", "never be set")
    t = player.stand(1220.0, 59)
    assert the_alert(api, "clock_fault")["state"] == "open"
    player.stand(t, 3)
    check(the_alert(api, "clock_fault"), "resolved", 1)


def test_clock_fault_when_it_stands_still(player: Player, api: Api) -> None:
    chunk = parked(0.0)
    frozen = type(chunk).make(chunk.t * 0.0 + 5.0, chunk.f_s, None, chunk.fix_row, chunk.fix_valid, chunk.fix)
    player.send(frozen)
    check(the_alert(api, "clock_fault"), "open", 1, "stands still")


@pytest.mark.parametrize("minutes", [15, 25])
def test_clock_fault_when_it_jumps_ahead(player: Player, api: Api, minutes: int) -> None:
    t = player.stand(0.0, minutes)
    assert alerts(api, "clock_fault") == []
    player.stand(t + 3600.0, 2)
    check(the_alert(api, "clock_fault"), "open", 1, "3600 s ahead of the time of day")


def test_clock_fault_when_it_is_fast(player: Player, api: Api) -> None:
    player.stand(0.0, 60, pace=1.5)
    check(the_alert(api, "clock_fault"), "open", 1, "fast by 50 per cent")


def test_clock_fault_when_it_is_a_little_fast(player: Player, api: Api) -> None:
    player.stand(0.0, 100, pace=1.015)
    check(the_alert(api, "clock_fault"), "open", 1, "ahead of the time of day")


def test_late_data_are_no_clock_fault(player: Player, api: Api, clock: Clock) -> None:
    t = player.stand(0.0, 20)
    clock.advance(3600.0)  # no network, the device goes on
    for _ in range(60):
        player.send(parked(t), 1.0)
        t += 60.0
    t = player.stand(t, 12)
    clock.advance(7200.0)  # the vehicle slept, and so did the clock
    player.stand(t, 12)
    assert alerts(api, "clock_fault") == []


@pytest.mark.parametrize("pace", [0.7, 0.98, 1.0, 2.0, 10.0, 1e6])
def test_kept_data_replays_and_slow_clocks_are_no_clock_fault(player: Player, api: Api, pace: float) -> None:
    t = player.stand(0.0, 45, pace)
    player.stand(t, 15)
    assert alerts(api, "clock_fault") == []


def test_sensor_fault_until_it_is_sound(player: Player, api: Api) -> None:
    stuck = drive("city", 240.0, disturbances=Disturbances(stuck=(0, 60.0)))
    sound = list(pieces(drive("city", 600.0)))
    player.play(pieces(stuck))
    alert = the_alert(api, "sensor_fault")
    assert (alert["state"], alert["data"]["fault"]) == ("open", "stuck_axis")
    player.play(sound[:3], "b")
    assert the_alert(api, "sensor_fault")["state"] == "open"
    player.play(sound[3:], "b")
    assert the_alert(api, "sensor_fault")["resolve_note"].startswith("The sensor's readings have been right for")


def test_the_same_chunks_give_the_same_memory(api: Api, clock: Clock, database: Database) -> None:
    chunks = [*pieces(drive("crawl", 180.0)), *(parked(180.0 + 60.0 * n, fix=False) for n in range(4))]
    begun = clock.now
    for name in ("one", "other"):
        clock.now = begun
        Player(api.add_device(name), clock).play(chunks)
    one, other = (memory(database, name) for name in ("one", "other"))
    assert set(one) >= {"gps_lost", "clock_fault", "calibration_stalled"}
    assert one == other


def memory(database: Database, device_id: str) -> Json:
    """Give what the rules remember, without the numbers of sessions."""
    with database.read() as tx:
        row = installations.find(tx, device_id)
    assert row is not None
    assert row.watch is not None
    return {kind: {**known, "session": None} for kind, known in row.watch.items()}


def test_a_recurrence_soon_after_opens_the_same_alert_again(player: Player, api: Api, clock: Clock) -> None:
    t = player.stand(0.0, 31, fix=False)
    t = player.stand(t, 2)
    assert the_alert(api, "gps_lost")["state"] == "resolved"
    t = player.stand(t, 31, fix=False)
    alert = the_alert(api, "gps_lost")
    check(alert, "open", 2)
    assert (alert["resolved_at"], alert["resolve_note"]) == (None, None)
    t = player.stand(t, 2)
    clock.advance(3600.0)
    player.stand(t, 31, fix=False)
    assert [alert["state"] for alert in alerts(api, "gps_lost")] == ["open", "resolved"]


def test_after_somebody_resolved_it_the_rule_begins_anew(player: Player, api: Api) -> None:
    t = player.stand(0.0, 31, fix=False)
    api.post(f"/alerts/{the_alert(api, 'gps_lost')['id']}/resolve", {"note": "it is in the garage"})
    t = player.stand(t, 30, fix=False)
    assert len(alerts(api, "gps_lost")) == 1
    player.stand(t, 1, fix=False)
    new, old = alerts(api, "gps_lost")
    assert (new["state"], new["count"], old["resolved_by"]) == ("open", 1, "admin")


def test_a_refit_ends_what_is_about_the_mounting(player: Player, api: Api) -> None:
    player.play(list(pieces(wandering(drive("city", 1500.0), 1.0, 240.0)))[:5])
    player.stand(300.0, 31, fix=False, session="b")
    api.post(f"/devices/{player.device.id}/installation/restart")
    assert the_alert(api, "gps_lost")["state"] == "open"
    alert = the_alert(api, "verification_failing")
    assert (alert["state"], alert["resolve_note"]) == ("resolved", "The calibration was restarted.")
