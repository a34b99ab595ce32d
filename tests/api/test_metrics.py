"""What Prometheus is told."""

import time
from collections.abc import Iterator
from pathlib import Path

import pytest
import sqlalchemy as sa
from prometheus_client.parser import text_string_to_metric_families
from pydantic import SecretStr
from sqlalchemy.exc import IntegrityError
from starlette.testclient import TestClient

from api import metrics, schemas
from api.app import create_app
from api.services import fleet, publishing, webhooks
from api.services.auditing import SERVICE
from api.services.context import Context
from api.services.monitoring import KEPT, Fleet
from api.settings import Settings
from storage import alerts, devices
from storage.migrate import upgrade
from storage.models import devices as device_table
from storage.prepared import Prepared
from tests.conftest import Clock
from tests.drives import chunks
from tests.service import Api

Figures = dict[tuple[str, frozenset[tuple[str, str]]], float]


def figures(text: str) -> Figures:
    families = text_string_to_metric_families(text)
    return {(s.name, frozenset(s.labels.items())): s.value for family in families for s in family.samples}


def value(found: Figures, name: str, **labels: str) -> float:
    return found.get((name, frozenset(labels.items())), 0.0)


def scrape(client: TestClient) -> Figures:
    answer = client.get("/metrics")
    assert answer.status_code == 200
    assert answer.headers["content-type"].startswith("text/plain; version=")
    return figures(answer.text)


def test_uploads_are_counted_and_timed(api: Api, client: TestClient) -> None:
    device = api.add_device("counted")
    before = scrape(client)
    device.send(chunks()[0], 0, expect=200)
    device.send(chunks()[0], 0, expect=200)
    device.send(chunks()[2], 2, expect=202)
    device.send(b"t,ax\n", 1, expect=422)
    device.send(chunks()[1], 0, expect=409)
    after = scrape(client)

    def more(name: str, **labels: str) -> float:
        return value(after, name, **labels) - value(before, name, **labels)

    for state in ("applied", "duplicate", "waiting"):
        assert more("livella_uploads_total", state=state, format="csv") == 1, state
    assert more("livella_uploads_refused_total", reason="log-422") == 1
    assert more("livella_uploads_refused_total", reason="chunk-conflict") == 1
    assert more("livella_filter_seconds_count") == 1
    assert more("livella_estimate_lag_seconds_count") == 1
    assert more("livella_upload_stage_seconds_count", stage="parse") == 4
    assert more("livella_upload_stage_seconds_count", stage="store") == 3
    route = "/api/v1/devices/{device_id}/chunks"
    assert more("livella_http_requests_total", method="POST", route=route, status="200") == 2
    assert value(after, "livella_uploads_in_work") == 0
    assert value(after, "livella_body_bytes") == 0


def test_the_fleet_is_counted_without_naming_a_device(api: Api, client: TestClient) -> None:
    api.add_device("secret-name").send(chunks()[0], 0, expect=200)
    found = scrape(client)
    assert sum(number for (name, _), number in found.items() if name == "livella_devices") == 1
    assert value(found, "livella_database_up") == 1
    assert value(found, "livella_webhook_backlog") == 0
    assert any(name == "livella_build_info" for name, _ in found)
    text = client.get("/metrics").text
    assert "secret-name" not in text
    client.get("/nothing/at/all")
    client.request("BREW", "/api/v1/devices/secret-name")
    text = client.get("/metrics").text
    assert "nothing" not in text
    assert "BREW" not in text


def test_nothing_is_timed_twice(api: Api, client: TestClient) -> None:
    device = api.add_device("timed")
    before = scrape(client)
    begun = time.perf_counter()
    for seq, body in enumerate(chunks()[:4]):
        device.send(body, seq, expect=200)
    seconds = time.perf_counter() - begun
    after = scrape(client)
    timed = ["livella_filter_seconds_sum", "livella_upload_stage_seconds_sum"]
    parts = {key: after[key] - before.get(key, 0.0) for key in after if key[0] in timed}
    taken = {dict(labels).get("stage", "filter") for (_, labels), part in parts.items() if part > 0}
    assert taken - {"foresee"} == {"filter", "parse", "wait", "store", "commit"}
    assert sum(parts.values()) < seconds


def test_the_filter_is_taken_out_of_the_lap_that_holds_it() -> None:
    def stage(name: str) -> float:
        return value(figures(metrics.render().decode()), "livella_upload_stage_seconds_sum", stage=name)

    before = stage("foresee"), stage("store")
    watch = metrics.Upload("text/csv")
    with watch:
        watch.lap("parse")
        with metrics.estimator():
            time.sleep(0.2)
        watch.lap("foresee")
        time.sleep(0.1)
        with metrics.estimator():
            time.sleep(0.2)
        watch.lap("store")
    assert stage("foresee") - before[0] < 0.1
    assert 0.1 <= stage("store") - before[1] < 0.2


@pytest.fixture
def context(database_url: str, tmp_path: Path, clock: Clock) -> Iterator[Context]:
    settings = Settings(database_url=SecretStr(database_url), data_dir=tmp_path, webhook_allow_private=True)
    made = Context.make(settings, clock)
    upgrade(made.database)
    yield made
    made.database.close()


def test_the_fleet_is_counted_now_and_then(context: Context, settings: Settings, clock: Clock) -> None:
    now = 0.0
    fleet = Fleet(context, lambda: now)
    assert b'livella_devices{stage="waiting"} 0.0' in fleet.render()
    with TestClient(create_app(settings, clock)) as client:
        Api(client).add_device()
    now = KEPT - 0.1
    assert b'livella_devices{stage="waiting"} 0.0' in fleet.render()
    now = KEPT
    assert b'livella_devices{stage="waiting"} 1.0' in fleet.render()


def test_messages_to_webhooks_are_counted_until_they_are_delivered(context: Context) -> None:
    fleet.register(context, schemas.DeviceDraft(id="box", name="box"))
    webhook = webhooks.add(context, SERVICE, schemas.WebhookDraft(name="a", url="http://127.0.0.1:9/"))
    assert b"livella_webhook_backlog 0.0" in Fleet(context).render()
    with context.database.write() as tx:
        finding = alerts.Finding("device_loose", "critical", "The device is loose.", {})
        raised = alerts.raise_(tx, devices.exists(tx, "box") or 0, finding, context.clock())
        publishing.alert_changed(tx, raised, context.clock())
    assert b"livella_webhook_backlog 1.0" in Fleet(context).render()
    webhooks.remove(context, SERVICE, webhook.webhook.id)
    assert b"livella_webhook_backlog 0.0" in Fleet(context).render()


def test_a_database_that_is_gone_is_told(tmp_path: Path) -> None:
    gone = Context.make(Settings(database_url=SecretStr(f"sqlite:///{tmp_path}/missing/livella.db")))
    told = Fleet(gone).render()
    gone.database.close()
    assert b"livella_database_up 0.0" in told
    assert b"livella_devices" not in told


def test_a_token_can_be_asked_for(settings: Settings, clock: Clock) -> None:
    token = "token-of-prometheus"  # noqa: S105 - made up
    with TestClient(create_app(settings.model_copy(update={"metrics_token": SecretStr(token)}), clock)) as client:
        assert client.get("/metrics").status_code == 401
        assert client.get("/metrics", headers={"Authorization": "Bearer wrong"}).status_code == 401
        assert client.get("/metrics", headers={"Authorization": f"Bearer {token}"}).status_code == 200


def database_errors() -> float:
    return value(figures(metrics.render().decode()), "livella_database_errors_total", kind="IntegrityError")


def test_errors_of_the_database_are_counted(context: Context) -> None:
    before, statement = database_errors(), sa.insert(device_table)
    with pytest.raises(IntegrityError), context.database.write() as tx:
        tx.execute(statement, id="a", name=None, created_at=context.clock(), search="")
    assert database_errors() == before + 1


def test_errors_of_prepared_statements_are_counted_too(context: Context) -> None:
    """They reach SQLite's driver without SQLAlchemy."""
    before, statement = database_errors(), Prepared(sa.insert(device_table))
    with pytest.raises(IntegrityError), context.database.write() as tx:
        tx.run(statement, id="a", name=None, created_at=context.clock(), search="")
    assert database_errors() == before + 1
