"""`livella replay`: run the estimator over log files."""

import json
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import replace as with_changes
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import typer

import core
from api.commands import output
from api.commands.logs import read_with_counts, sentences
from api.commands.output import ANGLES
from api.formats import FormatError, Reading, Sense
from api.formats.files import Format
from api.services import presenting
from core import PRESETS, Event, Outcome, Parameters, Samples, Status

PIECE = 60.0
"""s of log time given to the estimator at once"""

HEADS = ("file", "min", "samples", "fixes", "stage", *(f"{angle} °" for angle in ANGLES), "needs", "faults")


class Result(NamedTuple):
    """What came of one file."""

    file: Path
    duration: float
    """s"""
    samples: int
    fixes: int
    rejected: Counter[str]
    status: Status
    faults: tuple[str, ...]
    """names, in the order in which they were found"""


def run(logs: list[Path], log_format: Format | None, preset: str, every: float, course: Sense, as_json: bool) -> None:
    """Run the estimator over each file, which is a device of its own.

    Parameters
    ----------
    logs
        files in any format, plain or compressed
    log_format
        None = found out for each file
    preset
        a key of `core.PRESETS`
    every
        s of log time between the estimates that are printed
    course
        sense of the course in thesis logs
    as_json
        print lines of JSON instead of a table
    """
    params = with_changes(PRESETS[preset], report_interval=every)
    results: list[Result] = []
    for path in logs:
        try:
            reading = read_with_counts(path, log_format, course)
        except (FormatError, OSError) as error:
            output.complain("\n".join(sentences(path, error)))
            continue
        results.append(_replay(path, reading, params, _print_json if as_json else _print_nothing))
        if as_json:
            typer.echo(json.dumps(_summary(results[-1]), allow_nan=False))
    if results and not as_json:
        output.print_table(HEADS, map(_row, results), folded=("file", "needs", "faults"))
        _print_rejected(results)
    if len(results) < len(logs):
        raise typer.Exit(output.UNREADABLE)


def _replay(path: Path, reading: Reading, params: Parameters, show: Callable[[Outcome], None]) -> Result:
    """Run the estimator over one log in pieces, a progress bar on the terminal."""
    state = core.begin_session(params, core.initial_state(params))
    status, used, fixes, rejected = core.status(params, state), 0, 0, Counter(reading.rejected)
    faults: list[str] = []
    samples = reading.samples
    duration = float(samples.t[-1] - samples.t[0])
    with output.progress() as bar:
        task = bar.add_task(path.name, total=duration)
        for piece in _pieces(samples):
            state, outcome = core.advance(params, state, piece)
            show(outcome)
            status, used, fixes = outcome.status, used + outcome.samples, fixes + outcome.fixes
            rejected.update(outcome.rejected)
            faults += [event.fault for event in outcome.events if event.fault]
            bar.update(task, completed=float(piece.t[-1] - samples.t[0]))
    return Result(path, duration, used, fixes, rejected, status, tuple(dict.fromkeys(faults)))


def _pieces(samples: Samples) -> Iterator[Samples]:
    starts = np.flatnonzero(np.diff(np.floor((samples.t - samples.t[0]) / PIECE), prepend=-1.0))
    for start, stop in zip(starts.tolist(), [*starts[1:].tolist(), len(samples)], strict=True):
        yield samples.slice(start, stop)


def _print_nothing(_: Outcome) -> None:
    """Keep the terminal for the table."""


def _print_json(outcome: Outcome) -> None:
    """Print estimates and events in the order of their times."""
    lines = sorted([*_estimates(outcome), *map(_event, outcome.events)], key=lambda line: float(line["t"]))
    for line in lines:
        typer.echo(json.dumps(line, allow_nan=False))


def _estimates(outcome: Outcome) -> Iterator[dict[str, Any]]:
    rows = outcome.estimates
    for k in range(rows.t.size):
        yield {
            "type": "estimate",
            "t": float(rows.t[k]),
            "stage": core.Stage(int(rows.stage[k])).word,
            "quaternion": rows.quaternion[k].tolist(),
            "sigma_deg": presenting.degrees(rows.sigma[k]),
            "stable": bool(rows.stable[k]),
            "reliable": bool(rows.reliable[k]),
            "progress": float(rows.progress[k]),
            "needs": list(core.Needs(int(rows.needs[k])).words),
        }


def _event(event: Event) -> dict[str, Any]:
    """Give an event, of which only what it is about."""
    known = {
        "quaternion": None if event.quaternion is None else event.quaternion.tolist(),
        "sigma_deg": None if event.sigma is None else presenting.degrees(event.sigma),
        "angle_deg": None if event.angle is None else float(np.degrees(event.angle)),
        "axis": None if event.axis is None else event.axis.tolist(),
        "since": event.since,
        "fault": event.fault,
        "reason": event.reason,
        "evidence": None if event.evidence is None else presenting.evidence(event.evidence),
        "verification": None if event.verification is None else presenting.verification(event.verification),
    }
    told = {name: value for name, value in known.items() if value is not None}
    return {"type": "event", "t": event.t, "event": event.kind} | told


def _summary(result: Result) -> dict[str, Any]:
    status = result.status
    return {
        "type": "summary",
        "file": str(result.file),
        "duration_s": result.duration,
        "samples": result.samples,
        "fixes": result.fixes,
        "rejected": dict(result.rejected),
        "stage": status.stage.word,
        "mount": status.mount and _mount(status.mount),
        "estimate": status.estimate and _with_angles(presenting.estimate(status.estimate)),
    }


def _mount(mount: core.Mount) -> dict[str, Any]:
    known = {"quaternion": mount.quaternion.tolist(), "sigma_deg": presenting.degrees(mount.sigma)}
    status = "suspect" if mount.suspect else "in_force"
    test = presenting.verification(mount.verification)
    return {"t": mount.t, **_with_angles(known), "status": status, "verification": test}


def _with_angles(document: dict[str, Any]) -> dict[str, Any]:
    return document | presenting.rotation(document["quaternion"])


def _print_rejected(results: list[Result]) -> None:
    for result in results:
        if result.rejected:
            reasons = ", ".join(f"{reason} {count}" for reason, count in result.rejected.items())
            typer.echo(f"{result.file}: rejected {reasons}")


def _row(result: Result) -> list[str]:
    status = result.status
    return [
        str(result.file),
        f"{result.duration / 60:.1f}",
        str(result.samples),
        str(result.fixes),
        status.stage.word,
        *_angles(status),
        ", ".join(status.needs.words),
        ", ".join(result.faults),
    ]


def _angles(status: Status) -> list[str]:
    """Give the angles of the mounting in force, else those of the estimate."""
    known = status.mount if status.mount and not status.mount.suspect else status.estimate
    if known is None:
        return ["-"] * len(ANGLES)
    return output.angles(known.quaternion, presenting.degrees(known.sigma))
