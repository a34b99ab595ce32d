"""`livella motion`: reconstruct the motion of a vehicle from a log."""

import json
import math
import tomllib
from collections.abc import Iterator
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import typer
from numpy.typing import NDArray

import core
from api.commands import logs, output
from api.commands.motion_summary import Summary
from api.formats import Sense
from api.formats.files import Format
from api.services import presenting
from core import Samples, quaternion
from core.motion import (
    DEFAULT,
    VEHICLES,
    Motion,
    Parameters,
    Vehicle,
    VehicleError,
    advance,
    initial_state,
    vehicle_from,
)

Floats = NDArray[np.float64]

PIECE = 300.0
"""s of log time taken at once"""
MOST_POINTS = 20_000
"""rows of a picture"""
COLUMNS = Motion._fields[:-1]


class Mounting(NamedTuple):
    """Where the mounting comes from."""

    q_vs: Floats
    source: str
    """given, confirmed or estimate"""
    latency: float
    """s, of the fixes"""


def run(
    log: Path,
    log_format: Format | None,
    course: Sense,
    vehicle: str,
    mount: str | None,
    latency: float | None,
    every: float,
    as_json: bool,
    plot: Path | None,
) -> None:
    """Reconstruct the motion and say what is worth saying of it.

    Parameters
    ----------
    log, log_format, course
        as for `livella replay`
    vehicle
        a class, or a file in TOML
    mount
        yaw, pitch, roll, degrees; None = found by the estimator first
    latency
        s from a moment to the arrival of its fix; None = as the estimator finds it, 0 with a given mounting
    every
        s between the rows with JSON
    as_json
        print lines of JSON instead of a table
    plot
        file for a picture, None = none
    """
    car, given = _vehicle(vehicle), None if mount is None else _given(mount)
    samples = logs.read(log, log_format, course)
    mounting = Mounting(given, "given", 0.0) if given is not None else _found(log, samples)
    params = replace(DEFAULT, latency=min(max(mounting.latency if latency is None else latency, 0.0), 1.0))
    summary, drawn = Summary(params.rate), list[Motion]()
    next_row = float(samples.t[0])
    for motion in _reconstruct(log.name, samples, car, mounting.q_vs, params):
        summary.add(motion)
        if as_json:
            next_row = _print_rows(motion, next_row, every)
        if plot is not None:
            drawn.append(_thinned(motion, samples, params))
    document = _document(log, samples, vehicle, mounting, params, summary)
    if as_json:
        typer.echo(json.dumps(document, allow_nan=False))
    else:
        output.print_table(("", "", ""), _table(document))
    if plot is not None:
        _draw(drawn, plot)


# ---------------------------------------------------------------------------------------------------- what is given


def _vehicle(text: str) -> Vehicle:
    try:
        if text in VEHICLES:
            return VEHICLES[text]
        return vehicle_from(tomllib.loads(Path(text).read_text(encoding="utf-8")))
    except FileNotFoundError:
        output.fail(f"{text}: neither a file nor one of {', '.join(VEHICLES)}", output.UNREADABLE)
    except OSError as error:
        output.fail(f"{text}: {error.strerror or error}", output.UNREADABLE)
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, VehicleError) as error:
        output.fail(f"{text}: {error}", output.UNREADABLE)


def _given(text: str) -> Floats:
    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) != 3 or not np.isfinite(numbers).all():
        raise typer.BadParameter(f"expected 3 numbers separated by commas, found {text!r}", param_hint="--mount")
    return quaternion.from_angles(*np.radians(numbers[::-1]))


def _found(path: Path, samples: Samples) -> Mounting:
    """Run the estimator over the log: the mounting in force at its end, else the best estimate."""
    state = core.begin_session(core.DEFAULT, core.initial_state(core.DEFAULT))
    with output.progress() as bar:
        task = bar.add_task("mounting", total=_duration(samples))
        for piece in _pieces(samples):
            state, outcome = core.advance(core.DEFAULT, state, piece)
            bar.update(task, completed=float(piece.t[-1] - samples.t[0]))
    latency = float(state.filter["latency"][0]) if state.filter["running"][0] else 0.0
    mount, estimate = outcome.status.mount, outcome.status.estimate
    if mount is not None and not mount.suspect:
        return Mounting(mount.quaternion, "confirmed", latency)
    if estimate is None:
        output.fail(f"{path}: the log does not show how the device is mounted; give --mount", output.UNREADABLE)
    angles = ", ".join(output.angles(estimate.quaternion, presenting.degrees(estimate.sigma)))
    output.complain(f"{path}: no mounting was confirmed; the best estimate is used (roll, pitch, yaw {angles} degrees)")
    return Mounting(estimate.quaternion, "estimate", latency)


# ------------------------------------------------------------------------------------------------------- the motion


def _reconstruct(name: str, samples: Samples, vehicle: Vehicle, q_vs: Floats, params: Parameters) -> Iterator[Motion]:
    state = initial_state()
    with output.progress() as bar:
        task = bar.add_task(name, total=_duration(samples))
        for piece in _pieces(samples):
            state, motion = advance(params, vehicle, state, q_vs, piece)
            bar.update(task, completed=float(piece.t[-1] - samples.t[0]))
            yield motion


def _pieces(samples: Samples) -> Iterator[Samples]:
    starts = np.flatnonzero(np.diff(np.floor((samples.t - samples.t[0]) / PIECE), prepend=-1.0))
    for start, stop in zip(starts.tolist(), [*starts[1:].tolist(), len(samples)], strict=True):
        yield samples.slice(start, stop)


def _duration(samples: Samples) -> float:
    return float(samples.t[-1] - samples.t[0])


# --------------------------------------------------------------------------------------------------- what is printed


def _print_rows(motion: Motion, next_row: float, every: float) -> float:
    """Print the first row of each `every` seconds; gives the time of the next one."""
    while (k := int(np.searchsorted(motion.t, next_row))) < motion.t.size:
        next_row += every * (1 + math.floor((motion.t[k] - next_row) / every))
        typer.echo(json.dumps(_row(motion, k), allow_nan=False))
    return next_row


def _row(motion: Motion, k: int) -> dict[str, Any]:
    """Give one moment; null where nothing is known."""
    roll, pitch, yaw = np.degrees(quaternion.angles(motion.q_nv[k]))
    numbers = {
        "speed": np.hypot(*motion.velocity_v[k]),
        "velocity": motion.velocity_v[k],
        "velocity_sigma": motion.velocity_sigma[k],
        "acceleration": motion.a_v[k],
        "yaw_rate_deg": np.degrees(motion.w_v[k, 2]),
        "roll_deg": roll,
        "pitch_deg": pitch,
        "heading_deg": (90.0 - yaw) % 360.0,
        "sideslip_deg": np.degrees(motion.sideslip[k]),
        "sideslip_sigma_deg": np.degrees(motion.sideslip_sigma[k]),
        "position": motion.position_n[k],
        "position_sigma": motion.position_sigma[k],
    }
    told = {name: _number(value) for name, value in numbers.items()}
    return {"type": "motion", "t": float(motion.t[k]), **told, "dead_reckoned": bool(motion.dead_reckoned[k])}


def _number(value: Any) -> Any:
    if np.ndim(value):
        return value.tolist() if np.isfinite(value).all() else None
    return float(value) if np.isfinite(value) else None


def _document(
    log: Path, samples: Samples, vehicle: str, mounting: Mounting, params: Parameters, summary: Summary
) -> dict[str, Any]:
    return {
        "type": "summary",
        "file": str(log),
        "duration_s": _duration(samples),
        "samples": len(samples),
        "fixes": int(samples.fix_valid.sum()),
        "vehicle": vehicle,
        "mount": presenting.rotation(mounting.q_vs.tolist()) | {"source": mounting.source},
        "latency_s": params.latency,
        **summary.document(),
    }


def _table(document: dict[str, Any]) -> Iterator[tuple[str, str, str]]:
    acceleration, slip, outages = (document[name] for name in ("acceleration_mps2", "sideslip_deg", "outages"))
    yield "duration", f"{document['duration_s'] / 60:.1f}", "min"
    yield "motion known", f"{document['known_s'] / 60:.1f}", "min"
    yield "distance", f"{document['distance_m'] / 1000:.3f}", "km"
    yield "top speed", f"{document['top_speed_mps'] * 3.6:.1f}", "km/h"
    for name, (low, high) in ((name, pair) for name, pair in acceleration.items() if pair):
        yield f"{name} acceleration", f"{low:.2f} to {high:.2f}", "m/s²"
    if slip:
        yield "sideslip", f"{slip['range'][0]:.2f} to {slip['range'][1]:.2f}, rms {slip['rms']:.2f}", "degrees"
    else:
        yield "sideslip", "not known", ""
    yield "outages bridged", f"{outages['count']}", ""
    if outages["count"]:
        yield "longest outage", f"{outages['longest_s']:.1f}", "s"
        yield "position after it, 1 sigma", f"{outages['position_sigma_m']:.1f}", "m"


# -------------------------------------------------------------------------------------------------------- the picture


def _thinned(motion: Motion, samples: Samples, params: Parameters) -> Motion:
    stride = max(1, round(_duration(samples) * params.rate / MOST_POINTS))
    columns: dict[str, Any] = {name: getattr(motion, name)[::stride] for name in COLUMNS}
    return motion._replace(**columns)


def _draw(parts: list[Motion], path: Path) -> None:
    try:
        picture = import_module("api.commands.motion_plot")  # matplotlib is an extra
    except ImportError:
        output.fail("--plot needs matplotlib: pip install 'livella[plot]'", output.UNREADABLE)
    columns: dict[str, Any] = {name: np.concatenate([getattr(part, name) for part in parts]) for name in COLUMNS}
    try:
        picture.draw(parts[-1]._replace(**columns), path)
    except (OSError, ValueError) as error:
        output.fail(f"{path}: {error}", output.UNREADABLE)
