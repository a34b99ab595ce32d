"""What the service decides by is told as it is, in units for people."""

import math
from itertools import groupby
from pathlib import Path
from typing import Any

import pytest
from pydantic import SecretStr

from api import schemas
from api.services import thresholds
from api.services.context import Context
from api.settings import Settings
from core import DEFAULT
from tests.service import Api

SECRETS: dict[str, Any] = {
    "admin_key": SecretStr("a-secret-key"),
    "metrics_token": SecretStr("a-secret-token-of-metrics"),
}


def listed(directory: Path, **settings: Any) -> dict[str, schemas.Threshold]:
    url = SecretStr(f"sqlite:///{directory / 'livella.db'}")
    context = Context.make(Settings(database_url=url, data_dir=directory, **(SECRETS | settings)))
    items = thresholds.listed(context).items
    found = {item.name: item for item in items}
    assert len(found) == len(items)
    return found


def test_angles_are_in_degrees_and_the_rest_is_as_it_is(tmp_path: Path) -> None:
    found = listed(tmp_path)
    yaw = found["settling.yaw_sigma"]
    assert (yaw.group, yaw.unit) == ("settling", "deg")
    assert yaw.value == pytest.approx(math.degrees(DEFAULT.settling.yaw_sigma), abs=1e-6)
    assert found["settling.stable_rate"].unit == "deg/s"
    limit = found["verification.limit"]
    assert (limit.value, limit.unit, limit.group) == (DEFAULT.verification.limit, "m/s", "verification")
    assert (found["limits.sound_driving"].value, found["limits.sound_driving"].unit) == (300.0, "s")
    assert not [item for item in found.values() if "rad" in item.unit or not item.meaning]


def test_settings_are_told_as_they_are_set(tmp_path: Path) -> None:
    found = listed(tmp_path, alert_silent_hours=5, history_days=3.5, gap_timeout=20.0)
    told = {
        name: (found[name].value, found[name].unit) for name in ("alert_silent_hours", "history_days", "gap_timeout")
    }
    assert told == {"alert_silent_hours": (5, "h"), "history_days": (3.5, "d"), "gap_timeout": (20, "s")}
    assert found["alert_silent_hours"].meaning == Settings.model_fields["alert_silent_hours"].description


def test_no_secret_is_told(tmp_path: Path) -> None:
    told = " ".join(item.model_dump_json() for item in listed(tmp_path).values())
    assert "secret" not in told
    assert "livella.db" not in told


def test_what_is_switched_off_has_no_number(tmp_path: Path) -> None:
    assert listed(tmp_path, preset="thesis")["change.window"].value == "infinite"


@pytest.mark.parametrize("backend", ["sqlite"], indirect=True)
def test_they_come_group_by_group(api: Api) -> None:
    groups = [item["group"] for item in api.get("/thresholds")["items"]]
    assert [group for group, _ in groupby(groups)] == [
        "settling",
        "verification",
        "change",
        "events",
        "alerts",
        "upload",
        "retention",
    ]
