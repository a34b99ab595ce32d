"""Where the CPU of a chunk goes: the functions of an upload called in one process, without HTTP."""

import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median
from typing import TypeVar

import core
from api.services import access, detecting, ingest, intake
from api.services.context import Context
from benchmarks.load_study import drives, fleet
from benchmarks.load_study.client import Body, Device
from storage import installations, mounts

T = TypeVar("T")
STAGES = ("auth", "parse", "decode", "advance", "detect", "encode", "store and the rest", "answer")
DEVICES = 40


def profile(pool: list[drives.Drive], bodies: list[list[Body]]) -> dict[str, float]:
    """Give the median ms of CPU of each stage, on SQLite."""
    with tempfile.TemporaryDirectory(prefix="livella-load-") as name:
        context = fleet.open_context(f"sqlite:///{name}/livella.db", Path(name))
        try:
            devices = fleet.settle(context, fleet.prototypes(context, pool), bodies, DEVICES)
            chunks = [_chunk(context, device, device.bodies[0]) for device in devices]
        finally:
            context.database.close()
    return {stage: median(times[stage] for times in chunks) for stage in STAGES}


def _chunk(context: Context, device: Device, body: Body) -> dict[str, float]:
    chunk = fleet.chunk(device.first_seq, body)
    times: dict[str, float] = {}
    with context.database.read() as tx:
        row = installations.find(tx, device.name)
        assert row is not None
        mount = mounts.current(tx, row.device_pk)
    assert mount is not None
    assert row.snapshot is not None
    snapshot = row.snapshot
    _timed(times, "auth", lambda: access.authenticate(context, device.key))
    samples = _timed(times, "parse", lambda: ingest.read(context, chunk.body).samples(None)).samples
    state = _timed(times, "decode", lambda: core.decode(snapshot))
    state, outcome = _timed(times, "advance", lambda: core.advance(context.params, state, samples))
    _timed(times, "detect", lambda: detecting.detect(row.motion, mount.quaternion, outcome.events, samples))
    _timed(times, "encode", lambda: core.encode(state))
    answer = _timed(times, "whole", lambda: intake.receive(context, device.name, chunk))
    known = sum(times[stage] for stage in ("parse", "decode", "advance", "detect", "encode"))
    times["store and the rest"] = max(0.0, times.pop("whole") - known)
    _timed(times, "answer", answer.model_dump_json)
    return times


def _timed(times: dict[str, float], stage: str, call: Callable[[], T]) -> T:
    begin = time.process_time()
    result = call()
    times[stage] = 1e3 * (time.process_time() - begin)
    return result
