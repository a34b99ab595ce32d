"""`livella steering`: the steering-wheel angle from a second device on the wheel, or from a film of it."""

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import typer

from api.commands import logs, output, plots
from api.formats import FormatError
from api.formats.files import Format
from api.formats.video import MarkerFilm, is_film, read_markers
from api.formats.writer import write_native_csv
from core import Samples
from core.motion.steering import Steering, SteeringError, two_devices
from core.motion.steering_markers import from_markers
from core.motion.steering_zero import find_start


class Options(NamedTuple):
    """What was asked for."""

    wheel: Path | None
    """log of the device on the wheel"""
    log: Path | None
    """log of the vehicle that goes with a film"""
    video_start: float | None
    """s, first frame on the log's clock"""
    straight: float | None
    """s at which the wheel is straight"""
    from_behind: bool
    colour: str | None
    log_format: Format | None
    every: float
    """s between what is printed"""
    as_json: bool
    out: Path | None
    plot: Path | None


class _Found(NamedTuple):
    steering: Steering
    facts: dict[str, Any]
    """what else was found, for the summary"""
    samples: Samples | None
    """of the vehicle's log"""


def run(source: Path, options: Options) -> None:
    """Find the steering-wheel angle from a film, or from a log of the vehicle and one of the wheel."""
    film = is_film(source)
    _check(film, options)
    try:
        found = _from_film(source, options) if film else _from_logs(source, options)
    except SteeringError as error:
        output.fail(f"{source}: {error}", output.UNREADABLE)
    if options.out is not None:
        _write_log(options.out, found)
    if options.plot is not None:
        _plot(options.plot, found.steering)
    if options.as_json:
        for line in _lines(source, found, options.every):
            typer.echo(json.dumps(line, allow_nan=False))
    else:
        _print(source, found, options.every)


def _check(film: bool, options: Options) -> None:
    if not film and options.wheel is None:
        raise typer.BadParameter("a log needs that of the device on the wheel beside it", param_hint="--wheel")
    if film and options.wheel is not None:
        raise typer.BadParameter("a film needs no second device; with --log it goes with a log", param_hint="--wheel")
    if film and options.out is not None and options.log is None:
        raise typer.BadParameter("a film needs the log the steering angle is added to", param_hint="--log")


def _from_logs(source: Path, options: Options) -> _Found:
    car, wheel = (logs.read(path, options.log_format) for path in (source, options.wheel) if path is not None)
    found = two_devices(car, wheel, straight=options.straight)
    facts = {
        "method": "two_devices",
        "clock_offset_s": found.clock.offset,
        "clock_skew_ppm": 1e6 * found.clock.skew,
        "axis": found.axis_w.tolist(),
        "quaternion": found.q_cw.tolist(),
        "zero_sigma_deg": _number(np.degrees(found.zero_sigma)),
    }
    return _Found(found.steering, facts, car)


def _from_film(source: Path, options: Options) -> _Found:
    samples = None if options.log is None else logs.read(options.log, options.log_format)
    film = _read_film(source, options.colour)
    found = from_markers(film.t, film.points, from_behind=options.from_behind, straight=options.straight)
    steering, start = found.steering, options.video_start
    if samples is not None and start is None:
        start = find_start(samples, steering)
    facts = {
        "method": "markers",
        "colour": film.colour,
        "markers": found.figure.size,
        "frames_steadied": film.steadied,
        "video_start_s": start,
    }
    return _Found(steering._replace(t=steering.t + (start or 0.0)), facts, samples)


def _read_film(source: Path, colour: str | None) -> MarkerFilm:
    with output.progress() as bar:
        task = bar.add_task(source.name, total=None)
        try:
            return read_markers(source, colour, seen=lambda t, total: bar.update(task, completed=t, total=total))
        except (OSError, FormatError) as error:
            bar.stop()
            logs.refuse(source, error)


def _rows(steering: Steering, every: float) -> list[int]:
    """Choose the first moment of each interval."""
    steps = np.floor((steering.t - steering.t[0]) / every + 1e-9)
    return np.flatnonzero(np.diff(steps, prepend=-1.0)).tolist()


def _lines(source: Path, found: _Found, every: float) -> Iterator[dict[str, Any]]:
    steering = found.steering
    for k in _rows(steering, every):
        yield {
            "type": "steering",
            "t": float(steering.t[k]),
            "angle_deg": _number(np.degrees(steering.angle[k])),
            "rate_deg_s": _number(np.degrees(steering.rate[k])),
            "sigma_deg": _number(np.degrees(steering.sigma[k])),
        }
    yield {"type": "summary", "file": str(source), **_extent(steering), **found.facts}


def _extent(steering: Steering) -> dict[str, Any]:
    known = np.isfinite(steering.angle)
    return {
        "duration_s": float(steering.t[-1] - steering.t[0]),
        "known": float(known.mean()),
        "least_deg": _number(np.degrees(steering.angle[known].min(initial=np.inf))),
        "most_deg": _number(np.degrees(steering.angle[known].max(initial=-np.inf))),
        "median_sigma_deg": _number(np.degrees(np.median(steering.sigma[known]))) if known.any() else None,
    }


def _number(value: Any) -> float | None:
    """Give a number for JSON, which knows no nan."""
    return float(value) if np.isfinite(value) else None


def _print(source: Path, found: _Found, every: float) -> None:
    steering = found.steering
    rows = [
        [f"{steering.t[k]:.2f}", *(_cell(x[k]) for x in (steering.angle, steering.rate, steering.sigma))]
        for k in _rows(steering, every)
    ]
    output.print_table(("t s", "angle °", "rate °/s", "sigma °"), rows)
    extent = _extent(steering)
    typer.echo(f"{source}: {extent['duration_s']:.1f} s, the angle is known in {100 * extent['known']:.1f} % of it")


def _cell(radians: float) -> str:
    return f"{np.degrees(radians):.1f}" if np.isfinite(radians) else "-"


def _write_log(out: Path, found: _Found) -> None:
    """Write the vehicle's log with the steering angle as a column; empty where it is not known."""
    samples, steering = found.samples, found.steering
    if samples is None:
        return
    known = np.isfinite(steering.angle)
    steer = np.interp(samples.t, steering.t[known], steering.angle[known], left=np.nan, right=np.nan)
    after = np.clip(np.searchsorted(steering.t, samples.t), 1, steering.t.size - 1)
    steer[~(known[after] & known[after - 1])] = np.nan
    try:
        out.write_bytes(write_native_csv(replace(samples, steer=steer)))
    except OSError as error:
        output.fail(f"{error.filename}: {error.strerror}", output.UNREADABLE)


def _plot(out: Path, steering: Steering) -> None:
    figure = plots.new_figure(out)
    figure.set_size_inches(10.0, 4.0)
    axes = figure.add_subplot(xlabel="t, s", ylabel="steering-wheel angle, ° to the left")
    angle, sigma = np.degrees(steering.angle), np.degrees(steering.sigma)
    axes.fill_between(steering.t, angle - 2 * sigma, angle + 2 * sigma, alpha=0.3, label="2 sigma")
    axes.plot(steering.t, angle, linewidth=0.9)
    axes.grid(alpha=0.3)
    axes.legend()
    plots.save(figure, out)
