"""`livella calibrate`: find gains and offsets of an accelerometer from logs in which it lay still in various poses."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import typer

from api.commands import output
from api.commands.logs import read
from api.formats.files import Format
from core import CalibrationError
from core.accelerometer import AccelerometerCalibration, apply
from core.accelerometer_calibration import PARAMETERS, Fit, fit
from core.poses import AXES, Pose, find_poses

POSE_HEADS = ("pose", "s", *(f"{axis} m/s²" for axis in AXES), "|reading| m/s²", "|calibrated| m/s²")
PARAMETER_HEADS = ("axis", *(f"gain {axis}" for axis in AXES), "offset m/s²")


def run(logs: list[Path], log_format: Format | None, as_json: bool, out: Path | None) -> None:
    """Calibrate one accelerometer.

    Parameters
    ----------
    logs
        of one device, in any format, plain or compressed
    log_format
        None = found out for each file
    as_json
        print one JSON object instead of the tables
    out
        file for the setting of the device, None = none is written
    """
    recordings = [read(path, log_format) for path in logs]
    poses = find_poses(recordings)
    try:
        found = fit(poses)
    except CalibrationError as error:
        if poses and not as_json:
            output.print_table(POSE_HEADS[:6], (row[:6] for row in _pose_rows(poses, None)))
        output.fail(str(error), output.UNREADABLE)
    if as_json:
        typer.echo(json.dumps(_document(poses, found), allow_nan=False))
    else:
        _print(poses, found)
    if out is not None:
        _write(out, found)


def _print(poses: list[Pose], found: Fit) -> None:
    output.print_table(POSE_HEADS, _pose_rows(poses, found.calibration))
    output.print_table(PARAMETER_HEADS, _parameter_rows(found))
    typer.echo(f"|f| - g over the poses: {found.rms_before:.4f} m/s² rms before, {found.rms:.4f} after")
    if found.pose_count == PARAMETERS:
        typer.echo("Nine poses give nine parameters exactly; further poses would also test them.")


def _pose_rows(poses: list[Pose], calibration: AccelerometerCalibration | None) -> list[list[str]]:
    return [
        [
            str(number),
            f"{pose.seconds:.1f}",
            *(f"{value:.3f}" for value in pose.reading),
            f"{np.linalg.norm(pose.reading):.4f}",
            "" if calibration is None else f"{np.linalg.norm(apply(calibration, pose.reading)):.4f}",
        ]
        for number, pose in enumerate(poses, 1)
    ]


def _parameter_rows(found: Fit) -> list[list[str]]:
    gain, offset = found.calibration
    return [
        [
            axis,
            *(f"{value:.5f} ±{sigma:.5f}" for value, sigma in zip(gain[i], found.gain_sigma[i], strict=True)),
            f"{offset[i]:.4f} ±{found.offset_sigma[i]:.4f}",
        ]
        for i, axis in enumerate(AXES)
    ]


def _setting(found: Fit) -> dict[str, Any]:
    """Give what `PATCH /devices/{id}` takes."""
    gain, offset = found.calibration
    return {"accelerometer_calibration": {"gain": gain.tolist(), "offset": offset.tolist()}}


def _document(poses: list[Pose], found: Fit) -> dict[str, Any]:
    return _setting(found) | {
        "gain_sigma": found.gain_sigma.tolist(),
        "offset_sigma": found.offset_sigma.tolist(),
        "rms_before_mps2": found.rms_before,
        "rms_after_mps2": found.rms,
        "poses": [{"reading": pose.reading.tolist(), "seconds": pose.seconds} for pose in poses],
    }


def _write(out: Path, found: Fit) -> None:
    try:
        out.write_text(json.dumps(_setting(found), indent=1) + "\n")
    except OSError as error:
        output.fail(f"{error.filename}: {error.strerror}", output.UNREADABLE)
