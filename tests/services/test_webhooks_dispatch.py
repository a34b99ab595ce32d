import json
import random
import threading
from collections import defaultdict
from collections.abc import Iterator
from datetime import datetime, timedelta
from pathlib import Path
from typing import get_args

import pytest
from pydantic import SecretStr
from sqlalchemy.dialects import sqlite
from standardwebhooks import Webhook as Library

from api import schemas
from api.services import alerting, fleet, publishing, retention, webhooks, webhooks_queue
from api.services.auditing import SERVICE
from api.services.context import Context
from api.services.webhooks_dispatch import CLAIM, Dispatcher
from api.services.webhooks_sending import Sender, wait_asked_for
from api.settings import Settings
from storage import alerts, deliveries, devices
from storage import webhooks as stored
from storage.alerts import Finding
from storage.deliveries import Delivery
from storage.migrate import upgrade
from tests.conftest import Clock
from tests.receiver import Answer, Call, Receiver, running_receiver

DAY = 86400.0


@pytest.fixture
def receiver() -> Iterator[Receiver]:
    with running_receiver() as running:
        yield running


@pytest.fixture
def context(database_url: str, tmp_path: Path, clock: Clock) -> Iterator[Context]:
    settings = Settings(database_url=SecretStr(database_url), data_dir=tmp_path, webhook_allow_private=True)
    made = Context.make(settings, clock)
    upgrade(made.database)
    yield made
    made.database.close()


class World:
    """Alerts on one side, a dispatcher on the other."""

    def __init__(self, context: Context, clock: Clock, url: str, sender: Sender) -> None:
        self.context = context
        self.sender = sender
        self.clock = clock
        made = webhooks.add(context, SERVICE, schemas.WebhookDraft(name="a", url=url))
        self.pk, self.secret = made.webhook.id, made.secret
        self.numbers: dict[str, int] = {}

    def add_devices(self, *names: str) -> None:
        for name in names:
            fleet.register(self.context, schemas.DeviceDraft(id=name, name=name))
            with self.context.database.read() as tx:
                self.numbers[name] = devices.exists(tx, name) or 0

    def alert(self, device: str, kind: str = "device_loose", severity: str = "critical") -> None:
        with self.context.database.write() as tx:
            finding = Finding(kind, severity, "The device is loose.", {})
            publishing.alert_changed(tx, alerts.raise_(tx, self.numbers[device], finding, self.clock()), self.clock())

    def dispatch(self) -> int:
        """Send what is due, as a process would that has just started; give the number of attempts."""
        n = 0
        dispatcher = Dispatcher(self.context, self.sender)
        for pk in dispatcher.waiting():
            while dispatcher.send_next(pk):
                n += 1
        return n

    def run(self, seconds: float, step: float = 60.0) -> int:
        """Let time go by; give the number of attempts."""
        n = self.dispatch()
        end = self.clock() + timedelta(seconds=seconds)
        while self.clock() < end:
            self.clock.advance(step)
            n += self.dispatch()
        return n

    def deliveries(self) -> list[Delivery]:
        """Oldest first."""
        return webhooks.deliveries_page(self.context, self.pk, 500, None)[::-1]

    def webhook(self) -> schemas.Webhook:
        return webhooks.find(self.context, self.pk)


@pytest.fixture
def world(context: Context, clock: Clock, receiver: Receiver) -> Iterator[World]:
    with Sender(allow_private=True) as sender:
        made = World(context, clock, receiver.url, sender)
        made.add_devices("box-1", "box-2")
        yield made


def is_signed(call: Call, secret: str) -> bool:
    """Compare with what the published library signs, at the time of the simulation."""
    at = datetime.fromtimestamp(int(call.headers["webhook-timestamp"]), Clock().now.tzinfo)
    return Library(secret).sign(call.id, at, call.body.decode()) == call.headers["webhook-signature"]


def test_an_alert_is_sent_once(world: World, receiver: Receiver) -> None:
    world.alert("box-1")
    assert (world.dispatch(), world.dispatch()) == (1, 0)
    (call,) = receiver.calls
    assert is_signed(call, world.secret)
    assert (call.json["type"], call.json["timestamp"]) == ("alert.opened", "2024-05-06T07:08:09Z")
    shown = schemas.Alert.model_validate_json(json.dumps(call.json["data"]))
    assert (shown.device_id, shown.kind, shown.count) == ("box-1", "device_loose", 1)
    assert call.headers["content-type"] == "application/json"
    (delivery,) = world.deliveries()
    assert (delivery.state, delivery.attempts, delivery.last_status) == ("delivered", 1, 204)
    assert world.webhook().last_success_at == world.clock()


def test_nothing_is_stored_for_an_alert_that_is_rolled_back(world: World) -> None:
    def fail() -> None:
        with world.context.database.write() as tx:
            finding = Finding("device_loose", "critical", "", {})
            alert = alerts.raise_(tx, world.numbers["box-1"], finding, world.clock())
            publishing.alert_changed(tx, alert, world.clock())
            raise InterruptedError

    with pytest.raises(InterruptedError):
        fail()
    assert world.deliveries() == []


def test_only_wanted_alerts_are_told(world: World) -> None:
    webhooks.edit(world.context, SERVICE, world.pk, {"kinds": ["gps_lost"], "severities": ["warning", "critical"]})
    world.alert("box-1", "gps_lost", "info")
    world.alert("box-1", "device_loose", "critical")
    world.alert("box-2", "gps_lost", "warning")
    webhooks.edit(world.context, SERVICE, world.pk, {"active": False})
    world.alert("box-2", "gps_lost", "warning")
    assert [delivery.device_id for delivery in world.deliveries()] == ["box-2"]


def test_every_change_has_its_type(world: World, receiver: Receiver) -> None:
    world.alert("box-1")
    world.clock.advance(1)
    world.alert("box-1")
    with world.context.database.write() as tx:
        (alert,) = alerts.find_open(tx, world.numbers["box-1"], ["device_loose"])
        alerts.acknowledge(tx, alert.pk, "m", None, world.clock())
        publishing.alert_changed(tx, alert.pk, world.clock())
    world.clock.advance(1)
    world.alert("box-1")
    with world.context.database.write() as tx:
        alerts.resolve(tx, alert.pk, "m", None, world.clock())
        publishing.alert_changed(tx, alert.pk, world.clock())
    world.dispatch()
    expected = ["opened", "updated", "acknowledged", "updated", "resolved"]
    assert [call.json["type"] for call in receiver.calls] == [f"alert.{word}" for word in expected]


def test_an_alert_that_is_opened_again_is_told_as_opened(world: World, receiver: Receiver) -> None:
    finding, device = Finding("gps_lost", "warning", "No GPS.", {}), world.numbers["box-1"]
    for step in ("raise", "raise", "end", "raise", "raise", "end"):
        world.clock.advance(60)
        with world.context.database.write() as tx:
            if step == "raise":
                alerting.raise_(tx, world.context, device, finding, world.clock())
            else:
                alerting.end(tx, device, [finding.kind], "There is GPS again.", world.clock())
    world.dispatch()
    expected = ["opened", "updated", "resolved", "opened", "updated", "resolved"]
    assert [call.json["type"] for call in receiver.calls] == [f"alert.{word}" for word in expected]
    assert [call.json["data"]["count"] for call in receiver.calls] == [1, 2, 2, 3, 4, 4]
    assert len({call.json["data"]["id"] for call in receiver.calls}) == 1


@pytest.mark.parametrize("kind", get_args(schemas.AlertKind))
def test_every_kind_reaches_webhooks(world: World, receiver: Receiver, kind: str) -> None:
    with world.context.database.write() as tx:
        finding = Finding(kind, "warning", "It is so.", {})
        alerting.raise_(tx, world.context, world.numbers["box-1"], finding, world.clock())
    world.dispatch()
    (call,) = receiver.calls
    assert (call.json["type"], call.json["data"]["kind"]) == ("alert.opened", kind)


def test_the_schedule_of_standard_webhooks_then_given_up(world: World, receiver: Receiver) -> None:
    receiver.answer = Answer(500)
    world.alert("box-1")
    begun, waits = world.clock(), []
    world.dispatch()
    while (due := world.deliveries()[0].next_attempt_at) is not None:
        waits.append((due - world.clock()).total_seconds())
        world.clock.now = due - timedelta(microseconds=1)
        assert world.dispatch() == 0
        world.clock.now = due
        assert world.dispatch() == 1
    assert [w / s for w, s in zip(waits, webhooks_queue.SCHEDULE, strict=True)] == pytest.approx([1.05] * 9, abs=0.051)
    (delivery,) = world.deliveries()
    assert (delivery.state, delivery.attempts, delivery.last_status) == ("failed", 10, 500)
    assert delivery.last_error == "the receiver answered 500"
    assert world.webhook().failing_since == begun
    assert len({call.id for call in receiver.calls}) == 1


def test_what_was_given_up_can_be_sent_again(world: World, receiver: Receiver) -> None:
    receiver.answer = Answer(500)
    for _ in range(2):
        world.alert("box-1")
    world.run(8 * DAY, 3600)
    assert [delivery.state for delivery in world.deliveries()] == ["failed", "failed"]
    receiver.answer = Answer()
    receiver.calls.clear()
    assert webhooks.redeliver(world.context, SERVICE, world.pk).deliveries == 2
    assert world.dispatch() == 2
    assert [call.json["data"]["count"] for call in receiver.calls] == [1, 2]
    assert world.webhook().failing_since is None


def test_a_later_message_of_a_device_waits_for_the_earlier(world: World, receiver: Receiver) -> None:
    receiver.answer = lambda call: Answer(500 if call.json["data"]["device_id"] == "box-1" else 200)
    for name in ("box-1", "box-1", "box-2", "box-2"):
        world.alert(name)
    assert world.dispatch() == 3
    assert [(c.json["data"]["device_id"], c.json["data"]["count"]) for c in receiver.calls] == [
        *(("box-1", 1), ("box-2", 1), ("box-2", 2)),
    ]
    receiver.answer = Answer()
    world.clock.advance(10)
    assert world.dispatch() == 2
    assert [call.json["data"]["count"] for call in receiver.calls[-2:]] == [1, 2]


def test_a_receiver_down_for_a_day_gets_everything_in_order(world: World, receiver: Receiver) -> None:
    """Alerts come all the while, of devices that are tried at different times; every attempt by a new dispatcher."""
    generator = random.Random(1)
    world.add_devices("box-3", "box-4")
    receiver.answer = Answer(503)
    for _ in range(48):
        world.alert(generator.choice(["box-1", "box-2", "box-3"]))
        world.run(1800, 600)
    failed = len(receiver.calls)
    assert {delivery.state for delivery in world.deliveries()} == {"pending"}
    assert world.webhook().failing_since is not None
    receiver.answer = Answer()
    world.alert("box-4")
    world.run(60)
    assert_everything_came_in_order(world, receiver.calls[failed:])
    assert {delivery.state for delivery in world.deliveries()} == {"delivered"}
    assert world.webhook().failing_since is None


def assert_everything_came_in_order(world: World, calls: list[Call]) -> None:
    came: dict[str, list[str]] = defaultdict(list)
    sent: dict[str, list[str]] = defaultdict(list)
    for call in calls:
        assert is_signed(call, world.secret)
        if call.id not in came[call.json["data"]["device_id"]]:
            came[call.json["data"]["device_id"]].append(call.id)
    for delivery in world.deliveries():
        sent[str(delivery.device_id)].append(delivery.message_id)
    assert came == sent


def test_after_a_day_the_schedule_alone_is_enough(world: World, receiver: Receiver) -> None:
    receiver.answer = Answer(503)
    for name in ("box-1", "box-1", "box-2"):
        world.alert(name)
    world.run(DAY, 600)
    receiver.calls.clear()
    receiver.answer = Answer()
    world.run(DAY, 600)
    assert_everything_came_in_order(world, receiver.calls)


def test_an_attempt_cut_short_is_made_again(world: World, receiver: Receiver) -> None:
    """A process dies after it has claimed a delivery: another one sends it when the claim has run out."""
    world.alert("box-1")
    world.alert("box-1")
    assert Dispatcher(world.context, world.sender)._claim(world.pk) is not None
    assert world.dispatch() == 0
    world.clock.advance(CLAIM.total_seconds())
    assert world.dispatch() == 2
    assert [call.json["data"]["count"] for call in receiver.calls] == [1, 2]
    assert world.deliveries()[0].attempts == 1


def test_a_claim_that_ran_out_settles_nothing(world: World, receiver: Receiver) -> None:
    """The receiver takes so long that another process has delivered meanwhile."""

    def slow(_: Call) -> Answer:
        receiver.answer = Answer()
        world.clock.advance(CLAIM.total_seconds())
        assert world.dispatch() == 1
        return Answer(500)

    receiver.answer = slow
    world.alert("box-1")
    world.dispatch()
    (delivery,) = world.deliveries()
    assert (delivery.state, delivery.attempts) == ("delivered", 1)
    assert len(receiver.calls) == 2


def test_many_dispatchers_do_no_work_twice(world: World, receiver: Receiver) -> None:
    for n in range(60):
        world.alert(f"box-{1 + n % 2}", ("device_loose", "gps_lost")[n % 3 == 0])
    threads = [threading.Thread(target=world.dispatch) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    world.dispatch()
    assert len(receiver.calls) == 60
    assert_everything_came_in_order(world, receiver.calls)


def test_gone_switches_off(world: World, receiver: Receiver) -> None:
    receiver.answer = Answer(410)
    world.alert("box-1")
    world.alert("box-1")
    assert world.dispatch() == 1
    assert not world.webhook().active
    assert [delivery.state for delivery in world.deliveries()] == ["failed", "pending"]
    receiver.answer = Answer()
    webhooks.edit(world.context, SERVICE, world.pk, {"active": True})
    assert world.dispatch() == 1


@pytest.mark.parametrize("status", [429, 503])
def test_a_busy_receiver_is_left_alone(world: World, receiver: Receiver, status: int) -> None:
    receiver.answer = Answer(status, (("Retry-After", "3600"),))
    world.alert("box-1")
    world.dispatch()
    assert world.deliveries()[0].next_attempt_at == world.clock() + timedelta(hours=1)


def test_how_long_a_receiver_wants_to_be_left_alone(clock: Clock) -> None:
    now = clock()
    assert wait_asked_for(500, "60", now) is None
    assert wait_asked_for(429, None, now) is None
    assert wait_asked_for(429, "soon", now) is None
    assert wait_asked_for(429, "60", now) == timedelta(minutes=1)
    assert wait_asked_for(429, "999999999", now) == timedelta(hours=24)
    assert wait_asked_for(429, "Mon, 06 May 2024 07:18:09 GMT", now) == timedelta(minutes=10)
    assert wait_asked_for(429, "Mon, 06 May 2024 07:00:00 GMT", now) == timedelta(0)


def test_one_bad_message_does_not_burn_its_schedule(world: World, receiver: Receiver) -> None:
    receiver.answer = lambda call: Answer(500 if call.json["data"]["device_id"] == "box-1" else 200)
    world.alert("box-1")
    for _ in range(30):
        world.alert("box-2")
        world.run(60)
    assert world.deliveries()[0].state == "pending"


def test_old_deliveries_are_removed_and_counted_while_they_wait(world: World) -> None:
    world.alert("box-1")
    with world.context.database.read() as tx:
        assert webhooks.backlog(tx) == 1
    world.dispatch()
    with world.context.database.read() as tx:
        assert webhooks.backlog(tx) == 0
    world.clock.advance(91 * DAY)
    world.alert("box-1")
    retention.tidy(world.context)
    assert [delivery.state for delivery in world.deliveries()] == ["pending"]


def test_what_still_waits_is_not_removed_however_old(world: World, receiver: Receiver) -> None:
    receiver.answer = Answer(410)
    world.alert("box-1")
    world.alert("box-1")
    world.dispatch()
    world.clock.advance(91 * DAY)
    retention.tidy(world.context)
    receiver.answer = Answer()
    webhooks.edit(world.context, SERVICE, world.pk, {"active": True})
    assert world.dispatch() == 1
    assert [delivery.state for delivery in world.deliveries()] == ["delivered"]


def test_a_removed_webhook_takes_its_deliveries_along(world: World) -> None:
    world.alert("box-1")
    webhooks.remove(world.context, SERVICE, world.pk)
    assert world.dispatch() == 0
    world.alert("box-1")
    with world.context.database.read() as tx:
        assert (stored.count(tx), webhooks.backlog(tx)) == (0, 0)


def test_the_next_delivery_is_found_by_its_index_however_many_wait(world: World) -> None:
    if not world.context.database.is_sqlite:
        pytest.skip("PostgreSQL chooses its plan by what is in the table")
    compiled = deliveries._next.compile(dialect=sqlite.dialect(), compile_kwargs={"render_postcompile": True})
    with world.context.database.read() as tx:
        values = tuple(0 for _ in compiled.positiontup or ())
        plan = tx.connection.exec_driver_sql(f"EXPLAIN QUERY PLAN {compiled}", values).fetchall()
    steps = " ".join(row[-1] for row in plan)
    assert "ix_webhook_deliveries_due" in steps
    assert "ix_webhook_deliveries_pending" in steps
    assert "TEMP B-TREE" not in steps
