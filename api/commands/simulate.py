"""`livella simulate`: write a simulated drive with a known mounting."""

import gzip
import json
from pathlib import Path
from typing import Any

import numpy as np
import typer

from api.commands import output
from api.formats.writer import write_native_csv
from api.services import presenting
from core import quaternion
from core.quaternion import Floats
from core.simulation import Scenario, Truth, simulate

SUFFIXES = (".csv", ".csv.gz")
TRUTH = ".truth.json"


def run(
    out: Path, route: str, seconds: float, seed: int, mount: str | None, sensor: str, remount_at: str | None
) -> None:
    """Write the log to `out`, .csv or .csv.gz, and what is true of it beside it; angles in text, degrees."""
    if not out.name.endswith(SUFFIXES):
        output.fail(f"{out}: expected a name that ends in {' or '.join(SUFFIXES)}", output.UNREADABLE)
    scenario = Scenario(
        route=route,
        seconds=seconds,
        seed=seed,
        mount=None if mount is None else _rotation(_numbers(mount, 3, "--mount")),
        sensor=sensor,
        remount=None if remount_at is None else _remount(_numbers(remount_at, 4, "--remount-at")),
    )
    try:
        drive = simulate(scenario)
    except ValueError as error:
        output.fail(str(error), output.UNREADABLE)
    log = write_native_csv(drive.samples)
    try:
        out.write_bytes(gzip.compress(log, 6, mtime=0) if out.suffix == ".gz" else log)
        Path(f"{out}{TRUTH}").write_text(json.dumps(_truth(drive.truth), indent=1) + "\n")
    except OSError as error:
        output.fail(f"{error.filename}: {error.strerror}", output.UNREADABLE)


def _numbers(text: str, count: int, option: str) -> list[float]:
    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) != count or not np.isfinite(numbers).all():
        raise typer.BadParameter(f"expected {count} numbers separated by commas, found {text!r}", param_hint=option)
    return numbers


def _rotation(yaw_pitch_roll: list[float]) -> Floats:
    """Give q_vs of angles in degrees."""
    return quaternion.from_angles(*np.radians(yaw_pitch_roll[::-1]))


def _remount(numbers: list[float]) -> tuple[float, Floats]:
    return numbers[0], _rotation(numbers[1:])


def _truth(truth: Truth) -> dict[str, Any]:
    """Give the truth: the mountings as in the API, beside them every number of the simulation in SI units."""
    after = truth.remounted
    return {
        "mount": presenting.rotation(truth.q_vs.tolist()),
        "remount": None if after is None else {"t": after[0], **presenting.rotation(after[1].tolist())},
        "simulation": truth.as_dict(),
    }
