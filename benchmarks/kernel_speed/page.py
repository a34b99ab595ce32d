"""Measure everything in turn, show it, and write docs/performance.md."""

import os
import platform
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path

import filterpy
import numba
import numpy as np
from rich.console import Console
from rich.table import Table

import core
from benchmarks.accuracy_study.options import DOCS
from benchmarks.accuracy_study.statistics import Target, at_most, number, table, target_table
from benchmarks.kernel_speed.drives import collect_epochs, find_drive
from benchmarks.kernel_speed.steps import (
    Minute,
    fullest,
    model_of,
    numpy_joseph_step,
    numpy_step,
    repeat_filterpy,
    repeat_numpy,
    through,
    usual,
)
from benchmarks.kernel_speed.timing import Contender, Timing, in_turn
from benchmarks.sections import write_section

STEPS = 60
"""of numpy and filterpy between two looks at the clock"""
WAYS = ("Livella", "numpy", "numpy, Joseph form", "filterpy")
SIZES: Mapping[str, Callable[..., Minute]] = {"usual measurements": usual, "all measurements": fullest}
SENSORS = {"no gyro": False, "gyro": True}
PHASES = ("not confirmed", "confirmed")
CHUNK_TARGETS = {"no gyro": 1.5e-3, "gyro": 3e-3}
"""s for a minute of data"""
EPOCH_TARGETS = {"no gyro": 3e-6, "gyro": 8e-6}
"""s for an epoch"""

Timings = Mapping[tuple[str, ...], Timing]
"""by sensor and phase, s per minute of data; by sensor, size and way, s per epoch"""
Shapes = Mapping[tuple[str, str], tuple[int, int]]
"""by sensor and size: measurements and states"""

INTRODUCTION = """# How fast

What the estimator with the preset `default` needs on one core, beside a plain numpy filter and one of filterpy of the
same size. Every figure is computed; made by `make bench-kernel`, or `python benchmarks/kernel.py`.

The figures are medians of one run on a shared machine, the shortest time behind the slash. Seconds differ from run to
run, and a target whose figure is near it may go the other way in the next; the ratios are what counts. All contenders
take turns in random order, so that what else the machine does falls on all alike."""

CHUNK_TEXT = """## A minute of data

One call of `core.advance` with 60 s of a town drive, 200 Hz and GPS at 4 Hz, in ms. The device has been driving for
minutes and its filter runs; once the mounting is confirmed, a second filter watches over it."""

STEP_TEXT = """## An epoch of the filter

Prediction and update of one epoch in µs, and in brackets how many times the kernel's time that is. The kernel goes
through the epochs of a real minute inside machine code. numpy and filterpy are handed the matrices that the kernel's
step stands for, and nothing else to do; gating apart, their covariances agree with the kernel's to rounding, which a
test holds. They are called from Python, as such filters are, so part of their time is Python's. The kernel also
computes the predictions, the Jacobian and the noises, gates each measurement and learns its noise. "Usual" are the
measurements taken in motion; "all" adds climb, yaw rate from the course and standstill, which no single epoch of the
preset has."""


def contenders() -> tuple[dict[tuple[str, ...], Contender], Shapes]:
    """Everything that is timed, chunks by two words and steps by three."""
    timed: dict[tuple[str, ...], Contender] = {}
    shapes: dict[tuple[str, str], tuple[int, int]] = {}
    for sensor, gyro in SENSORS.items():
        drive = find_drive(gyro)
        for phase, chunk in zip(PHASES, drive, strict=True):
            timed[sensor, phase] = Contender(partial(core.advance, core.DEFAULT, *chunk), 1)
        epochs = collect_epochs(drive.settling)
        for size, make in SIZES.items():
            minute = make(drive.settling.state.filter, epochs)
            shapes[sensor, size] = model_of(minute).h.shape
            timed |= {(sensor, size, way): contender for way, contender in _ways(minute)}
    return timed, shapes


def _ways(minute: Minute) -> Iterator[tuple[str, Contender]]:
    """The ways to make the same step, named as in `WAYS`."""
    model = model_of(minute)
    calls: tuple[tuple[Callable[[], object], int], ...] = (
        (partial(through, minute), minute.epochs.size),
        (partial(repeat_numpy, numpy_step, model, STEPS), STEPS),
        (partial(repeat_numpy, numpy_joseph_step, model, STEPS), STEPS),
        (partial(repeat_filterpy, model, STEPS), STEPS),
    )
    for way, call in zip(WAYS, calls, strict=True):
        yield way, Contender(*call)


def verdicts(timings: Timings, shapes: Shapes) -> list[Target]:
    """Judge the medians of what was measured."""
    targets = []
    for name, timing in timings.items():
        if len(name) == 2:
            what = f"a minute of data, {name[0]}, {name[1]}"
            targets.append(at_most(what, [timing.median * 1e3], [CHUNK_TARGETS[name[0]] * 1e3], " ms"))
        elif name[2] == WAYS[0]:
            measurements, states = shapes[name[0], name[1]]
            what = f"an epoch, {states} states, {measurements} measurements"
            targets.append(at_most(what, [timing.median * 1e6], [EPOCH_TARGETS[name[0]] * 1e6], " µs"))
    return targets


def chunk_rows(timings: Timings) -> list[list[str]]:
    """Rows of the table of chunks: a sensor each, a phase per column."""
    return [[sensor, *(_figures(timings[sensor, phase], 1e3) for phase in PHASES)] for sensor in SENSORS]


def step_rows(timings: Timings, shapes: Shapes) -> list[list[str]]:
    """Rows of the table of steps: a size each, a way per column, with the ratio to the kernel."""
    rows = []
    for (sensor, size), (measurements, states) in shapes.items():
        own, *others = (timings[sensor, size, way] for way in WAYS)
        cells = [f"{_figures(other, 1e6)} (×{number(other.median / own.median)})" for other in others]
        rows.append([f"{states} states, {measurements} measurements ({size.split()[0]})", _figures(own, 1e6), *cells])
    return rows


def _figures(timing: Timing, scale: float) -> str:
    return f"{number(timing.median * scale)} / {number(timing.least * scale)}"


def machine() -> str:
    """Say in a line what it was measured on."""
    versions = f"numpy {np.__version__}, numba {numba.__version__}, filterpy {filterpy.__version__}"
    return f"{processor()}, {versions}."


def processor() -> str:
    """Name the processor, its cores, and Python."""
    cpuinfo = Path("/proc/cpuinfo")
    lines = cpuinfo.read_text(encoding="utf-8").splitlines() if cpuinfo.exists() else []
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    name = names[0] if names else platform.processor() or platform.machine()
    return f"{name}, {os.cpu_count()} cores; Python {platform.python_version()}"


def assemble(timings: Timings, shapes: Shapes, repeats: int) -> str:
    """Write the page."""
    targets = verdicts(timings, shapes)
    met = sum(target.met is True for target in targets)
    parts = [
        INTRODUCTION,
        f"Measured {repeats} times on: {machine()}",
        f"## Targets\n\n{met} of {len(targets)} are met.\n\n{target_table(targets)}",
        f"{CHUNK_TEXT}\n\n{table(['', *PHASES], chunk_rows(timings))}",
        f"{STEP_TEXT}\n\n{table(['', *WAYS], step_rows(timings, shapes))}",
    ]
    return "\n\n".join(parts) + "\n"


def _show(title: str, columns: tuple[str, ...], rows: list[list[str]]) -> None:
    shown = Table(title=title)
    for column in ("", *columns):
        shown.add_column(column, justify="right" if column else "left")
    for row in rows:
        shown.add_row(*row)
    Console(width=140).print(shown)


def write_page(repeats: int) -> None:
    """Measure, show the tables, and make docs/performance.md again."""
    timed, shapes = contenders()
    timings = in_turn(timed, repeats)
    _show("A minute of data, ms, median / shortest", PHASES, chunk_rows(timings))
    _show("An epoch of the filter, µs, median / shortest", WAYS, step_rows(timings, shapes))
    words = {True: "met", False: "not met", None: "not measured"}
    judged = [[t.what, t.wanted, t.measured, words[t.met]] for t in verdicts(timings, shapes)]
    _show("Targets", ("target", "measured", "verdict"), judged)
    write_section(DOCS / "performance.md", "kernel", assemble(timings, shapes, repeats))
    print(f"kernel: wrote {DOCS / 'performance.md'}", flush=True)
