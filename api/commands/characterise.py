"""`livella characterise`: means, drifts and noises of the sensors of a device that lay still."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import typer

from api.commands import logs, output, plots
from api.formats.files import Format
from core import Samples
from core.attitude import CharacteriseError, Characteristics, characterise
from core.quaternion import Floats

UNITS = {"gyroscope": "deg/s", "accelerometer": "m/s²", "magnetometer": "µT"}
HEADS = ("", "axis", "mean", "sigma", "drift /h", "noise /√Hz", "bias instability", "random walk /√s")
LEAST_SECONDS = 60.0
"""s, a shorter log tells of the noise only"""


def run(log: Path, log_format: Format | None, as_json: bool, plot: Path | None) -> None:
    """Characterise the sensors of a log; `plot` is a file for the Allan deviations, None = none is drawn."""
    figure = None if plot is None else plots.new_figure(plot)
    found = _find(log, logs.read(log, log_format))
    if as_json:
        typer.echo(
            json.dumps({"file": str(log)} | {name: _document(it) for name, it in found.items()}, allow_nan=False)
        )
    else:
        _print_table(found)
    if plot is not None:
        _draw(figure, found)
        plots.save(figure, plot)


def _find(log: Path, samples: Samples) -> dict[str, Characteristics]:
    """Give what can be characterised, in the units of `UNITS`."""
    readings = {"gyroscope": np.degrees(samples.w_s), "accelerometer": samples.f_s, "magnetometer": samples.m_s}
    found = {}
    for name, values in readings.items():
        if values is None or not np.isfinite(values).any():
            continue
        try:
            found[name] = characterise(samples.t, values)
        except CharacteriseError as error:
            output.fail(f"{log}: {name}: {error}", output.UNREADABLE)
    return found


def _print_table(found: Mapping[str, Characteristics]) -> None:
    rows = []
    for name, it in found.items():
        for axis in range(3):
            values = (
                it.mean[axis],
                np.sqrt(it.variance[axis]),
                3600 * it.drift[axis],
                it.noise_density[axis],
                it.bias_instability[axis],
                it.random_walk[axis],
            )
            rows.append([f"{name}, {UNITS[name]}" if axis == 0 else "", "xyz"[axis], *map(_cell, values)])
    output.print_table(HEADS, rows)
    seconds = max(it.seconds for it in found.values())
    typer.echo(f"{seconds:.1f} s without a gap. The device has to lie still; `-` is what does not show in this time.")
    if seconds < LEAST_SECONDS:
        output.complain(f"Bias instability and random walk need longer: hours rather than {seconds:.0f} s.")


def _cell(value: float) -> str:
    return f"{value:.4g}" if np.isfinite(value) else "-"


def _document(it: Characteristics) -> dict[str, Any]:
    plain = {
        name: _numbers(getattr(it, name))
        for name in ("mean", "variance", "drift", "noise_density", "bias_instability", "random_walk")
    }
    allan = {"tau": it.allan.tau.tolist(), "deviation": it.allan.deviation.T.tolist()}
    return {"seconds": it.seconds, "rate": it.rate} | plain | {"allan": allan}


def _numbers(values: Floats) -> list[float | None]:
    return [float(value) if np.isfinite(value) else None for value in values]


def _draw(figure: Any, found: Mapping[str, Characteristics]) -> None:
    axes = figure.subplots(1, len(found), squeeze=False)[0]
    for axis, (name, it) in zip(axes, found.items(), strict=True):
        for direction, deviation in zip("xyz", it.allan.deviation.T, strict=True):
            axis.loglog(it.allan.tau, deviation, label=direction)
        axis.set(title=name, xlabel="cluster time, s", ylabel=f"Allan deviation, {UNITS[name]}")
        axis.legend()
        axis.grid(which="both", alpha=0.3)
