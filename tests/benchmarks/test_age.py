"""What age costs: a small fleet with a short past through the real study, and how its figures are judged."""

import shutil
from collections.abc import Mapping
from pathlib import Path

import pytest
import sqlalchemy as sa

from benchmarks.age_study.databases import maker, why_not
from benchmarks.age_study.page import LISTS, YEAR, assemble, growth, slowest, targets
from benchmarks.age_study.pair import CHARTED, SENDS, Size, pair
from benchmarks.age_study.study import Effort, Study, carry_out
from benchmarks.age_study.uploads import Latency, Uploads
from benchmarks.kernel_speed.timing import Timing
from benchmarks.load_study.cells import POSTGRESQL, SQLITE
from storage import models
from storage.database import Database

SMALL = Size(devices=120, senders=2, alerts_each=2, days=20, sessions_a_day=2, hours=0.1)
KINDS = [SQLITE, pytest.param(POSTGRESQL, marks=pytest.mark.postgres)]


def count(database: Database, table: sa.Table, device_pk: int | None = None) -> int:
    statement = sa.select(sa.func.count()).select_from(table)
    if device_pk is not None:
        statement = statement.where(table.c.device_pk == device_pk)
    with database.read() as tx:
        return int(tx.value(statement))


@pytest.mark.parametrize("kind", KINDS)
def test_a_year_is_in_one_database_and_not_in_the_other(kind: str, tmp_path: Path) -> None:
    with maker(kind, tmp_path) as made, pair(made, tmp_path, SMALL) as compared:
        old, fresh = compared.old.database, compared.fresh.database
        assert count(old, models.devices) == count(fresh, models.devices) == SMALL.devices + 1
        assert count(old, models.alerts) - count(fresh, models.alerts) == SMALL.devices * SMALL.alerts_each
        tables = (models.sessions, models.estimates, models.estimates_coarse, models.mounts)
        past = [[count(old, table, pk) for table in tables] for pk in (1, 2)]
        assert past[0] == past[1]
        assert min(past[0]) > 0
        assert not any(count(fresh, table, 1) for table in tables)
        assert compared.senders == [SENDS.format(0), SENDS.format(1)]
        assert count(old, models.chunks) > count(fresh, models.chunks) > 0
        with old.read() as tx:
            assert tx.value(sa.select(models.devices.c.pk).where(models.devices.c.id == CHARTED)) == SMALL.devices + 1


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_a_small_study(kind: str) -> None:
    study = carry_out(kind, SMALL, Effort(rounds=2, repeats=1))
    assert study.uploads.number == 2 * SMALL.senders
    page = assemble({kind: study})
    assert f"growth: upload, median, {kind}" in page
    assert "| devices, q box |" in page


def study_of(times: Mapping[str, tuple[float, float]], p99: float = 0.01) -> Study:
    looks = {
        (age, name): Timing(seconds, seconds)
        for name, both in times.items()
        for age, seconds in zip(("old", "fresh"), both, strict=True)
    }
    return Study(Uploads(Latency(0.005, p99), Latency(0.005, 0.01), 10), looks, SMALL)


TIMES = {
    "devices": (0.002, 0.002),
    "devices, q box": (0.060, 0.040),
    "devices, q box, a page in the middle": (0.030, 0.030),
    "alerts": (0.002, 0.002),
    "alerts, state resolved": (0.004, 0.001),
    "chart of an hour": (0.001, 0.001),
    YEAR: (0.09, 0.001),
}


def test_growth_is_that_of_what_shows_the_same() -> None:
    study = study_of(TIMES)
    assert growth(study, LISTS) == pytest.approx([1.0, 1.5, 1.0])
    assert growth(study, "alerts") == growth(study, "chart") == [1.0]
    assert slowest(study, LISTS) == pytest.approx(0.060)


def test_verdicts() -> None:
    judged = {target.what: target.met for target in targets({SQLITE: study_of(TIMES, 0.013), POSTGRESQL: "not there"})}
    assert judged == {
        "growth: upload, median, SQLite": True,
        "growth: upload, p99, SQLite": False,
        "growth: lists of devices, SQLite": True,
        "growth: lists of alerts, SQLite": True,
        "growth: charts, SQLite": True,
        "slowest list of devices, SQLite": False,
        "slowest list of alerts, SQLite": True,
        "chart of a year, SQLite": True,
        "PostgreSQL": None,
    }


def test_what_is_not_there_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shutil, "which", lambda _: None)
    monkeypatch.setattr("glob.glob", lambda _: [])
    assert why_not(SQLITE) is None
    assert why_not(POSTGRESQL) == "PostgreSQL is not installed"
    assert "not measured" in assemble({SQLITE: study_of(TIMES), POSTGRESQL: "not there"})
