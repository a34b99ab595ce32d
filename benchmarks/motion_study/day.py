"""How long `livella motion` takes for a day of 200 Hz."""

import os
import resource
import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

from api.formats.writer import write_native_csv
from core.simulation import Scenario, simulate

HOURS = 24
RATE = 200.0
MOUNT = ("--mount", "0,0,0")
TARGET = 60.0
"""s"""


def write_day(path: Path) -> int:
    """Write an hour of town 24 times in a row, with the clock going on; gives the number of samples."""
    hour = simulate(Scenario(seconds=3600.0, seed=1, imu_rate=RATE, mount=[1.0, 0.0, 0.0, 0.0])).samples
    with path.open("wb") as out:
        for k in range(HOURS):
            header, _, body = write_native_csv(replace(hour, t=hour.t + 3600.0 * k)).partition(b"\n")
            out.write(body if k else header + b"\n" + body)
    return HOURS * len(hour)


def timed(*arguments: str) -> float:
    begin = time.monotonic()
    subprocess.run(  # noqa: S603 - our own command
        [sys.executable, "-m", "api.cli", "motion", *arguments], check=True, capture_output=True
    )
    return time.monotonic() - begin


def paragraph() -> str:
    """Measure, and say it in a paragraph."""
    with tempfile.TemporaryDirectory() as directory:
        path = Path(directory) / "day.csv"
        samples = write_day(path)
        size = path.stat().st_size / 1e9
        given = timed(str(path), "--vehicle", "sedan", *MOUNT)
        found = timed(str(path), "--vehicle", "sedan")
    memory = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1e6
    return f"""A day of {RATE:.0f} Hz ({samples / 1e6:.1f} million samples, {size:.1f} GB of CSV; an hour of town
24 times in a row, with the clock going on) takes `livella motion --mount` **{given:.0f} s** on {os.cpu_count()} cores,
reading the file included, and {found:.0f} s where the mounting is found first; wanted: {TARGET:.0f} s. It needs
{memory:.1f} GB of memory, most of it for the log."""
