"""The load generator: pacing, figures, page, and a small fleet against the real service."""

import asyncio
import math
import shutil
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from api.formats.writer import write_native_csv
from api.services import intake
from benchmarks import naive
from benchmarks.load_study import client, drives, fleet, service
from benchmarks.load_study.cells import CELLS, NAIVE, Cell, why_not
from benchmarks.load_study.client import Device, Run
from benchmarks.load_study.drives import ARROW, CHUNK, CSV
from benchmarks.load_study.measuring import NotSlowedError, loop, measure
from benchmarks.load_study.pacing import Answer, Latency, Plan, errors, measured, next_count, quantiles, schedule
from benchmarks.load_study.page import HTTP, WHOLE, assemble, ratios, targets, with_http
from benchmarks.load_study.processes import TICK, parse
from benchmarks.load_study.result import Meter, Result, Traffic, conclude, largest_held
from benchmarks.load_study.study import Study, carry_out
from benchmarks.sections import with_section
from core.simulation import Scenario, simulate
from storage import installations

PLAN = Plan(4, 20.0, 60.0)


def result(devices: int, p99: float, unanswered: int = 0, wrong: int = 0, cpu: float = 5e-3) -> Result:
    return Result(
        devices=devices,
        seconds=60.0,
        latency=Latency(0.01, 0.02, p99, 0.5),
        chunks=100,
        served=0.8 * devices,
        errors={},
        unanswered=unanswered,
        wrong=wrong,
        server_cpu=cpu,
        database_cpu=0.0,
        generator_cpu=cpu / 9,
        rss=[200.0, 190.0],
        fsyncs=0.5,
        connections=devices,
        cores=1.5,
    )


def test_devices_post_once_a_minute_at_phases_evenly_spread() -> None:
    due = schedule(PLAN)
    assert [at for at, _ in due] == [0.0, 15.0, 30.0, 45.0, 60.0, 75.0]
    order = [device for _, device in due]
    assert sorted(order[:4]) == [0, 1, 2, 3]
    assert order[4:] == order[:2]


def test_those_connected_together_do_not_post_together() -> None:
    order = [device // 100 for _, device in schedule(Plan(3000, 0.0, 60.0))]
    assert len(order) == 3000
    assert sum(a == b for a, b in pairwise(order)) < 150  # one in 30 by chance
    assert order == [device // 100 for _, device in schedule(Plan(3000, 0.0, 60.0))]


async def _hung_up_on(times: int) -> list[Answer]:
    """Give the answers of a device that so many times is hung up on before it has sent anything."""
    seen: asyncio.Queue[None] = asyncio.Queue()

    def hang_up(_: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        seen.put_nowait(None)
        writer.close()

    async with await asyncio.start_server(hang_up, "127.0.0.1", 0) as server:
        run = Run(server.sockets[0].getsockname()[1], [Device("van-1", "key", "session", [], 0)], 1)
        await run.connect()
        for _ in range(times):
            await asyncio.wait_for(seen.get(), 30.0)
        await run.close()
    return run.answers


def test_who_is_hung_up_on_before_its_first_chunk_connects_again_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(client, "RECONNECT", math.inf)
    assert asyncio.run(_hung_up_on(3)) == []


def test_quantiles_are_values_and_rounded_up() -> None:
    assert quantiles([i / 100 for i in range(1, 101)]) == Latency(0.51, 0.96, 1.0, 1.0)
    assert all(math.isnan(value) for value in quantiles([]))


def test_the_warm_up_is_not_measured_but_its_errors_count() -> None:
    answers = [Answer(1.0, 9.0, 503), Answer(20.0, 0.1, 200), Answer(80.0, 0.1, 200), Answer(30.0, 1.0, 0)]
    assert [answer.due for answer in measured(answers, PLAN)] == [20.0, 30.0]
    assert errors(answers) == {"503": 1, "broken": 1}


@pytest.mark.parametrize(
    ("tried", "beyond", "wanted"),
    [
        ({}, False, 1600),
        ({1600: True}, False, None),
        ({1600: True}, True, 2400),
        ({1600: True, 2400: False}, True, 2000),
        ({1600: False}, False, 800),
        ({1600: False, 800: False}, False, 600),
        ({1600: False, 100: False}, False, None),
        ({1600: False, 800: True}, False, 1200),
        ({1600: False, 1500: True}, True, None),
        ({1600: True, 1500: False}, True, None),
    ],
)
def test_the_target_is_tried_first_then_what_lies_between(
    tried: dict[int, bool], beyond: bool, wanted: int | None
) -> None:
    assert next_count(tried, 1000.0, 1600, 100, beyond) == wanted


def test_a_count_is_held_only_if_nothing_went_wrong() -> None:
    assert result(10, 0.2).held(0.3)
    assert not result(10, 0.4).held(0.3)
    assert not any(result(10, 0.2, **{name: 1}).held(0.3) for name in ("unanswered", "wrong"))
    assert not result(10, 0.2)._replace(errors={"503": 1}).held(0.3)
    assert largest_held([result(10, 0.2), result(20, 0.4)], 0.3) == result(10, 0.2)
    assert largest_held([result(20, 0.4)], 0.3) is None


def test_figures_are_those_between_the_meters() -> None:
    answers = [Answer(1.0, 0.1, 200), Answer(19.9, 0.2, 200), Answer(30.0, 0.3, 200), Answer(79.9, 0.2, 503)]
    seen = conclude(Traffic(answers, 2, 4, 80.0), PLAN, Meter(1.0, 2.0, 3.0, 4.0), Meter(2.0, 2.5, 3.5, 8.0), [100.0])
    assert (seen.server_cpu, seen.database_cpu, seen.generator_cpu, seen.fsyncs) == (0.75, 0.25, 0.25, 2.0)
    assert (seen.generator_share, seen.cores) == (0.25, 2.0 / 60.0)
    assert (seen.chunks, seen.errors, seen.unanswered) == (2, {"503": 1}, 2)


def test_what_was_refused_is_no_chunk_that_shares_the_cost() -> None:
    answers = [Answer(30.0, 0.3, 200), Answer(31.0, 0.1, 503), Answer(32.0, 0.1, 503)]
    seen = conclude(Traffic(answers, 0, 4, 80.0), PLAN, Meter(0, 0, 0, 0), Meter(0.012, 0, 0, 0), [100.0])
    assert (seen.server_cpu, seen.served) == (0.012, 1.0)


def test_a_run_without_hope_counts_for_the_time_it_took() -> None:
    answers = [Answer(25.0, 2.0, 200), Answer(30.0, 9.0, 200)]
    seen = conclude(Traffic(answers, 50, 4, 32.0), PLAN, Meter(0, 0, 0, 0), Meter(6.0, 0, 0, 0), [100.0])
    assert (seen.seconds, seen.chunks, seen.cores, seen.server_cpu, seen.served) == (12.0, 2, 0.5, 6.0, 5.0)
    assert not seen.held(10.0)


def test_a_chunk_without_an_answer_may_be_stored_or_not() -> None:
    device = Device("box", "key", "drive", [], 0)
    device.acknowledged = 3
    assert [device.stored_as_told(count) for count in (2, 3, 4)] == [False, True, False]
    device.unsure = True
    assert [device.stored_as_told(count) for count in (2, 3, 4, 5)] == [False, True, True, False]


def test_what_cannot_be_slowed_down_is_not_measured() -> None:
    def blind(cell: Cell, plan: Plan) -> Result:
        raise NotSlowedError("no fsync was seen")

    postgres = Cell("PostgreSQL", CSV, 10, fsync=5e-3)
    assert why_not(postgres) is not None
    study = carry_out({"sqlite-csv-fsync": CELLS["sqlite-csv-fsync"], "other": postgres}, PLAN, PLAN, 60.0, blind)
    assert study.runs == {}
    assert study.skipped["sqlite-csv-fsync"] == "no fsync was seen"
    assert set(study.skipped) == {"sqlite-csv-fsync", "other"}


def test_where_the_target_is_missed_the_study_finds_what_is_held() -> None:
    def pretend(cell: Cell, plan: Plan) -> Result:
        tried.append((cell.encoding, plan.devices, plan.measure))
        return result(plan.devices, 0.1 if plan.devices <= 700 else 9.0)

    tried: list[tuple[str, int, float]] = []
    cells = {"small": Cell("SQLite", CSV, 640), "large": Cell("SQLite", ARROW, 1600)}
    study = carry_out(cells, PLAN, PLAN._replace(measure=5.0), 1e9, pretend)
    assert tried[:3] == [(CSV, 640, 60.0), (ARROW, 1600, 60.0), (ARROW, 1000, 5.0)]
    assert len(study.runs["small"]) == 1
    best = largest_held(study.runs["large"], 0.2)
    assert best is not None
    assert best.devices == 700
    assert len(carry_out(cells, PLAN, PLAN, 0.0, pretend).runs["large"]) == 1


def test_the_name_of_a_process_may_hold_anything() -> None:
    assert parse(7, "7 (a) b (c) S 3 0 0 0 0 0 0 0 0 0 40 2 0 0 20") == (7, 3, 42 * TICK)


def study() -> Study:
    runs = {
        "sqlite-csv": [result(10_000, 0.2)],
        "sqlite-arrow": [result(30_000, 0.25), result(15_000, 0.1)],
        NAIVE: [result(4000, 0.4), result(2000, 0.2, cpu=50e-3)],
    }
    return Study(runs, {"sqlite-csv-fsync": "gcc is needed"})


def test_the_page_tells_what_was_met_and_what_was_skipped() -> None:
    text = assemble(study(), {"CSV zstd": {"parse": 2.0}}, 60.0)
    assert "| devices, SQLite, CSV zstd, p99 ≤ 300 ms | ≥ 10000 | 10000 | met |" in text
    assert "| devices, SQLite, Arrow zstd, p99 ≤ 200 ms | ≥ 30000 | 15000 | **not met** |" in text
    assert "gcc is needed | not measured" in text
    assert "| sqlite-csv | 10000 | yes | 60 | 10.0 / 20.0 / 200 / 500 | 0 | 5.00 | 0.00 | 0.56 | 10.0 % |" in text
    assert "| parse | 2.00 |" in text
    assert "| devices held | 10000 | 2000 | ×5.00 |" in text


def test_the_stages_are_timed_with_the_settings_of_the_service_under_load(tmp_path: Path) -> None:
    context = fleet.open_context(f"sqlite:///{tmp_path / 'livella.db'}", tmp_path)
    context.database.close()
    assert context.settings.raw_retention_days == float(service.SETTINGS["LIVELLA_RAW_RETENTION_DAYS"])


def test_a_device_of_the_fleet_stands_where_its_prototype_does(tmp_path: Path) -> None:
    context = fleet.open_context(f"sqlite:///{tmp_path / 'livella.db'}", tmp_path)
    try:
        drive = drives.pool(1, during=1)[0]
        (prototype,) = fleet.prototypes(context, [drive])
        body = drives.encode(drive.during[0], drives.ARROW)
        (device,) = fleet.settle(context, [prototype], [[body]], 1)
        chunk = fleet.chunk(device.first_seq, body)
        names = ("prototype-000", device.name)
        told = [intake.receive(context, name, chunk).installation for name in names]
        with context.database.read() as tx:
            motion = [row.motion for row in (installations.find(tx, name) for name in names) if row is not None]
    finally:
        context.database.close()
    expected, found = (one.model_dump(exclude={"device_id", "since", "last_data_at", "mount"}) for one in told)
    assert found == expected
    mounts = [one.mount for one in told]
    assert mounts[0] is not None
    assert mounts[1] is not None
    assert mounts[1].quaternion == mounts[0].quaternion
    assert motion[0] is not None
    assert motion == [motion[0], motion[0]]


def test_a_drive_that_confirms_nothing_is_none_for_the_fleet(tmp_path: Path) -> None:
    context = fleet.open_context(f"sqlite:///{tmp_path / 'livella.db'}", tmp_path)
    try:
        with pytest.raises(fleet.NotConfirmedError):
            fleet.prototypes(context, drives.pool(1, before=1, during=1))
    finally:
        context.database.close()


def test_what_the_stages_do_not_explain_is_http_and_the_rest() -> None:
    complete = with_http({"CSV zstd": {"parse": 2.0}, "Arrow zstd": {"parse": 1.0}}, study())
    assert complete["CSV zstd"] == {"parse": 2.0, HTTP: 3.0, WHOLE: 5.0}
    assert complete["Arrow zstd"] == {"parse": 1.0, HTTP: 4.0, WHOLE: 5.0}


def test_the_baseline_is_compared_only_when_both_were_measured() -> None:
    assert [row[-1] for row in ratios(study())] == ["×5.00", "×10.0"]
    assert ratios(Study({NAIVE: [result(10, 0.1)]}, {})) == []


def test_a_section_is_written_anew_and_leaves_the_others() -> None:
    page = with_section(with_section("", "a", "# A\n\n1"), "b", "# B\n\n2")
    again = with_section(page, "a", "# A\n\n3")
    assert again == page.replace("1", "3")
    assert again.index("# A") < again.index("# B")


def test_the_baseline_finds_the_mounting() -> None:
    drive = simulate(Scenario(seconds=4 * CHUNK, seed=1, gyro=False))
    cuts = [*np.searchsorted(drive.samples.t, CHUNK * np.arange(4)).tolist(), len(drive.samples)]
    kalman = None
    for first, last in pairwise(cuts):
        samples, epochs = naive.read(write_native_csv(drive.samples.slice(first, last)))
        assert samples == last - first
        kalman = naive.Filter.start(epochs) if kalman is None else naive.Filter.load(kalman.dump())
        assert len(naive.run(kalman, "box", epochs)) == CHUNK / 5
    assert kalman is not None
    assert abs(np.dot(kalman.quaternion(), drive.truth.q_vs)) > np.cos(np.radians(3.0) / 2)


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [
        "sqlite-arrow",
        NAIVE,
        pytest.param("postgres-csv", marks=pytest.mark.postgres),
        pytest.param("sqlite-csv-fsync", marks=pytest.mark.skipif(shutil.which("gcc") is None, reason="needs gcc")),
    ],
)
def test_every_chunk_a_small_fleet_sends_is_stored_once(name: str) -> None:
    seen = measure(CELLS[name], Plan(20, 1.0, 5.0))
    assert seen.chunks >= 1
    assert (seen.errors, seen.unanswered, seen.wrong) == ({}, 0, 0)
    assert seen.server_cpu > 0
    assert len(seen.rss) == 2
    assert seen.latency.p50 > CELLS[name].fsync


def test_memory_is_judged_with_as_many_devices_as_are_wanted() -> None:
    few = result(5_000, 0.1)._replace(rss=[900.0, 100.0])
    enough = result(10_000, 9.9)._replace(rss=[550.0, 500.0])
    assert [target.wanted for target in targets(Study({"sqlite-csv": [few]}, {}))].count("≤ 600 MB") == 0
    judged = targets(Study({"sqlite-csv": [few, enough]}, {}))[-1]
    assert (judged.measured, judged.met) == ("577 MB", True)
    assert not targets(Study({"sqlite-csv": [enough, enough._replace(rss=[600.0, 1.0])]}, {}))[-1].met
    more = result(15_000, 9.9)._replace(rss=[900.0, 100.0])
    assert not targets(Study({"sqlite-csv": [enough, more]}, {}))[-1].met


def test_the_speed_of_the_machine_is_measured() -> None:
    assert 0.0 < loop(1000, 3) < 10.0
