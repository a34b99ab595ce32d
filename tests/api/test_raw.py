"""Samples are kept as they came, and given back as a log."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import sqlalchemy as sa

from api.formats import parse
from api.formats.writer import write_native_csv
from api.services import retention
from api.services.context import Context
from api.settings import Settings
from core import Samples
from storage.database import Database
from storage.models import raw_chunks
from tests.conftest import Clock
from tests.crashes import crashed
from tests.drives import chunks
from tests.formats.test_raw import assert_same, sent, with_everything
from tests.service import Api, Device, Response
from tests.watched import parked, pieces

DAY = 86400.0


@pytest.fixture
def context(settings: Settings, clock: Clock) -> Iterator[Context]:
    made = Context.make(settings, clock)
    yield made
    made.database.close()


def kept(database: Database) -> list[tuple[str, int]]:
    """Give the kept chunks as (columns, seq)."""
    with database.read() as tx:
        columns = sa.select(raw_chunks.c.columns, raw_chunks.c.seq).order_by(raw_chunks.c.session_pk, raw_chunks.c.seq)
        return tx.all(lambda names, seq: (names, seq), columns)


def ask(device: Device, expect: int = 200, accept: str = "*/*", **query: object) -> Response:
    return device.api.call("GET", f"/devices/{device.id}/raw", expect, params=query, headers={"Accept": accept})


def read(answer: Response) -> Samples:
    """Read a log as an upload is read."""
    log = parse(answer.content, answer.headers["content-type"], None)
    assert log.notices == ()
    return log.samples().samples


def play(device: Device, clock: Clock, bodies: tuple[bytes, ...], session: str = "a", seconds: float = 30.0) -> None:
    for seq, body in enumerate(bodies):
        clock.advance(seconds)
        device.send(body, seq, session, expect=200)


@pytest.mark.parametrize("form", ["csv", "arrow"])
def test_what_was_uploaded_comes_back(api: Api, clock: Clock, form: str) -> None:
    device = api.add_device()
    play(device, clock, chunks()[:3])
    whole = parse(b"".join([chunks()[0], *(body.split(b"\n", 1)[1] for body in chunks()[1:3])]), "text/csv", None)
    answer = ask(device, format=form)
    assert answer.headers["livella-session"] == "a"
    assert_same(whole.samples().samples, read(answer))


def test_csv_is_what_was_sent_to_the_last_digit(api: Api, clock: Clock) -> None:
    device = api.add_device()
    play(device, clock, chunks()[:1])
    before, after = sent_numbers(chunks()[0]), sent_numbers(ask(device).content)
    np.testing.assert_array_equal(before, after)


def sent_numbers(log: bytes) -> np.ndarray:
    samples = parse(log, "text/csv", None).samples().samples
    return np.column_stack([samples.t, samples.f_s, samples.w_s])


def test_the_format_is_asked_for_by_accept(api: Api, clock: Clock) -> None:
    device = api.add_device()
    play(device, clock, chunks()[:1])
    arrow = "application/vnd.apache.arrow.stream"
    assert ask(device, accept=arrow).headers["content-type"] == arrow
    assert ask(device, accept=arrow, format="csv").headers["content-type"].startswith("text/csv")
    assert ask(device).headers["content-type"].startswith("text/csv")
    ask(device, 422, format="parquet")


def test_columns_that_only_some_chunks_have_are_empty_in_the_others(api: Api, clock: Clock) -> None:
    device = api.add_device()
    log = with_everything()
    half = len(log) // 2
    bare = replace(log.slice(half, len(log)), m_s=None, steer=None, temperature=None, pressure=None)
    play(device, clock, (write_native_csv(log.slice(0, half)), write_native_csv(bare)), seconds=15.0)
    for form in ("csv", "arrow"):
        after = read(ask(device, format=form))
        assert len(after) == len(log)
        assert after.m_s is not None
        assert after.steer is not None
        assert np.isnan(after.m_s[half:]).all()
        np.testing.assert_allclose(after.steer[:half], sent(log).steer[:half], rtol=2e-7)  # type: ignore[index]


def test_a_period_is_cut_from_it(api: Api, clock: Clock) -> None:
    device = api.add_device()
    play(device, clock, chunks()[:4])
    started = clock.now.timestamp() - 120.0 + 0.02
    moments = [f"{np.datetime64(int(1e6 * (started + t)), 'us')}Z" for t in (25.0, 65.0)]
    query: dict[str, Any] = {"from": moments[0], "to": moments[1]}
    after = read(ask(device, **query))
    assert after.t[0] == pytest.approx(25.0, abs=0.05)
    assert after.t[-1] == pytest.approx(65.0, abs=0.05)
    ask(device, 404, to="2020-01-01T00:00:00Z")


def test_one_of_several_sessions_has_to_be_named(api: Api, clock: Clock) -> None:
    device = api.add_device()
    for session in ("first", "second"):
        play(device, clock, chunks()[:1], session)
    problem = ask(device, 409).json()
    assert problem["type"].endswith("several-sessions")
    assert "first, second" in problem["detail"]
    assert ask(device, session="second").headers["livella-session"] == "second"
    ask(device, 404, session="third")


def test_a_chunk_is_kept_once_when_it_takes_effect(api: Api, clock: Clock, database: Database) -> None:
    device = api.add_device()
    bodies = chunks()
    device.send(bodies[0], 0, expect=200)
    device.send(bodies[0], 0, expect=200)
    device.send(bodies[1], 0, expect=409)
    device.send(bodies[2], 2, expect=202)
    assert [seq for _, seq in kept(database)] == [0]
    device.send(bodies[1], 1, expect=200)
    assert [seq for _, seq in kept(database)] == [0, 1, 2]
    api.call("DELETE", f"/devices/{device.id}", 204)
    assert kept(database) == []


def test_a_calibrated_accelerometer_changes_nothing_of_what_is_kept(api: Api, clock: Clock) -> None:
    gain = [[1.1, 0, 0], [0, 1.0, 0], [0, 0, 0.9]]
    device = api.add_device(accelerometer_calibration={"gain": gain, "offset": [0.1, 0.2, 0.3]})
    play(device, clock, chunks()[:1])
    assert_same(parse(chunks()[0], "text/csv", None).samples().samples, read(ask(device)))


def test_a_thesis_log_comes_back_as_its_samples(api: Api, clock: Clock) -> None:
    rows = [f"{n}\t{40 * n}\t12.5\t45.5\t{20 + n // 25}\t0\t0\t1\t{n % 3}\t{-n % 5}\t100" for n in range(250)]
    log = "\n".join(rows).encode()
    device = api.add_device()
    device.send(log, 0, expect=200, Content_Type="text/vnd.livella.tmd2")
    before = parse(log, "text/vnd.livella.tmd2", None).samples().samples
    assert_same(before, read(ask(device)))


# ---------------------------------------------------------------- how long


def test_samples_go_after_some_days_but_for_those_around_an_impact(
    api: Api, clock: Clock, context: Context, database: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(retention, "RAW_ROWS", 2)
    story = crashed()
    device = api.add_device()
    play(device, clock, story.chunks)
    assert len(kept(database)) == len(story.chunks)
    clock.advance(6.9 * DAY)
    assert not retention.forget_samples(context)
    assert len(kept(database)) == len(story.chunks)
    clock.advance(0.2 * DAY)
    while retention.forget_samples(context):
        pass
    # the crash is in the middle of its chunk: ten seconds before and after reach no other
    assert [seq for _, seq in kept(database)] == [story.struck]
    (event,) = device.get("events", params={"kind": "impact"})["items"]
    assert event["kept"]
    around = read(ask(device))
    assert around.t[0] < event["t"] < around.t[-1]
    clock.advance(4000 * DAY)
    assert not retention.forget_samples(context)
    assert [seq for _, seq in kept(database)] == [story.struck]


@pytest.mark.parametrize("backend", ["sqlite"], indirect=True)
class TestWithoutKeeping:
    @pytest.fixture
    def settings(self, settings: Settings) -> Settings:
        return settings.model_copy(update={"raw_retention_days": 0.0})

    def test_nothing_is_kept_where_that_is_switched_off(self, api: Api, clock: Clock, database: Database) -> None:
        device = api.add_device()
        play(device, clock, tuple(map(write_native_csv, pieces(parked(0.0, 120.0)))))
        assert kept(database) == []
        ask(device, 404)
        assert device.get("motion")["columns"]["at"] == []
