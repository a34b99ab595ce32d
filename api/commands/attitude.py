"""`livella attitude`: attitude of a device through a log, from its own gyroscope, accelerometer and magnetometer."""

import json
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import typer

from api.commands import logs, output, plots
from api.formats.files import Format
from core import Samples, quaternion
from core.attitude import FILTERS, Attitudes, has_compass
from core.quaternion import Floats

HEADS = ("", "lowest", "highest", "at the end")


class Found(NamedTuple):
    """What there is to tell of a log."""

    attitudes: Attitudes
    angles: Floats
    """(N, 3) deg, roll, pitch, yaw, yaw without jumps"""
    heading: str


def run(log: Path, log_format: Format | None, name: str, every: float, as_json: bool, plot: Path | None) -> None:
    """Run a filter over a log.

    Parameters
    ----------
    log, log_format
        any format, plain or compressed; None = found out
    name
        one of `core.attitude.FILTERS`
    every
        s between two lines of attitude with `as_json`
    as_json
        print lines of JSON instead of the table
    plot
        file for a picture, None = none is drawn
    """
    figure = None if plot is None else plots.new_figure(plot)
    samples = logs.read(log, log_format)
    if not np.isfinite(samples.w_s).all(axis=1).any():
        output.fail(f"{log}: no gyroscope: the columns gx, gy, gz are needed", output.UNREADABLE)
    found = _find(name, samples)
    if as_json:
        _print_lines(log, name, every, found)
    else:
        _print_table(name, found)
    if plot is not None:
        _draw(figure, found)
        plots.save(figure, plot)


def _find(name: str, samples: Samples) -> Found:
    used = FILTERS[name]
    state, attitudes = used.run(samples)
    angles = quaternion.all_angles(attitudes.q_ns)
    angles[:, 2] = np.unwrap(angles[:, 2])
    if not has_compass(state):
        heading = "relative to the start"
    elif used.follows_field:
        heading = "magnetic"
    else:
        heading = "magnetic at the start, then by the gyroscope"
    return Found(attitudes, np.degrees(angles), heading)


def _print_table(name: str, found: Found) -> None:
    t, altitude = found.attitudes.t, found.attitudes.altitude
    rows = [
        [f"{axis}, deg", *(f"{value:.1f}" for value in (values.min(), values.max(), values[-1]))]
        for axis, values in zip(output.ANGLES, found.angles.T, strict=True)
    ]
    if np.isfinite(altitude).any():
        rows.append(["altitude, m", f"{np.nanmin(altitude):.1f}", f"{np.nanmax(altitude):.1f}", f"{altitude[-1]:.1f}"])
    bias = np.degrees(found.attitudes.gyro_bias[-1])
    typer.echo(f"Filter {name}, {t[-1] - t[0]:.1f} s, {t.size} samples. Heading: {found.heading}.")
    output.print_table(HEADS, rows)
    typer.echo("Bias of the gyroscope at the end: " + ", ".join(f"{value:.3f}" for value in bias) + " deg/s")


def _print_lines(log: Path, name: str, every: float, found: Found) -> None:
    t = found.attitudes.t
    for k in np.flatnonzero(np.diff(np.floor((t - t[0]) / every), prepend=-1.0)):
        typer.echo(json.dumps(_line(int(k), found), allow_nan=False))
    typer.echo(json.dumps(_summary(log, name, found), allow_nan=False))


def _line(k: int, found: Found) -> dict[str, Any]:
    at = found.attitudes
    roll, pitch, yaw = found.angles[k].tolist()
    return {
        "type": "attitude",
        "t": float(at.t[k]),
        "quaternion": at.q_ns[k].tolist(),
        "angles_deg": {"roll": roll, "pitch": pitch, "yaw": yaw},
        "sigma_deg": [_number(value) for value in np.degrees(at.sigma[k])],
        "gyro_bias_dps": np.degrees(at.gyro_bias[k]).tolist(),
        "altitude": _number(at.altitude[k]),
        "field_trusted": bool(at.field_trusted[k]),
    }


def _summary(log: Path, name: str, found: Found) -> dict[str, Any]:
    at, altitude = found.attitudes, found.attitudes.altitude
    known = altitude[np.isfinite(altitude)]
    lowest, highest = found.angles.min(axis=0).tolist(), found.angles.max(axis=0).tolist()
    return {
        "type": "summary",
        "file": str(log),
        "filter": name,
        "duration_s": float(at.t[-1] - at.t[0]),
        "samples": at.t.size,
        "heading": found.heading,
        "range_deg": dict(zip(output.ANGLES, zip(lowest, highest, strict=True), strict=True)),
        "gyro_bias_dps": np.degrees(at.gyro_bias[-1]).tolist(),
        "altitude_range": [float(known.min()), float(known.max())] if known.size else None,
    }


def _number(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def _draw(figure: Any, found: Found) -> None:
    at = found.attitudes
    panels = [("deg", found.angles, output.ANGLES), ("gyroscope bias, deg/s", np.degrees(at.gyro_bias), "xyz")]
    if np.isfinite(at.altitude).any():
        panels.append(("altitude, m", at.altitude[:, None], ("altitude",)))
    axes = figure.subplots(len(panels), 1, sharex=True)
    for axis, (label, columns, names) in zip(axes, panels, strict=True):
        for name, values in zip(names, columns.T, strict=True):
            axis.plot(at.t, values, label=name, linewidth=0.8)
        axis.set_ylabel(label)
        axis.legend(loc="upper right")
        axis.grid(alpha=0.3)
    axes[-1].set_xlabel("s")
