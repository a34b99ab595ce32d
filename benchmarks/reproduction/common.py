"""What all experiments share: drives, mountings, places of the files, and how numbers are written."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.reproduction.angles import Angles, error, from_thesis, to_thesis
from benchmarks.reproduction.runs import PRESETS, Trace, final_error, trace
from core import Parameters
from core.simulation import Drive, Scenario, simulate

Floats = NDArray[np.float64]

DOCS = Path(__file__).resolve().parents[2] / "docs"
PICTURES = DOCS / "pictures" / "thesis"

SEED = 1
"""of single runs"""
SEEDS = range(1, 11)
"""of medians"""
BASE = Scenario(sensor="tmd2", seed=SEED)
FIRST_MOUNT: Angles = (-180.0, 90.0, 0.0)
"""thesis 5.2.2"""
SECOND_MOUNT: Angles = (-90.0, 0.0, 40.0)
"""thesis table 5.2"""


def case(route: str, seconds: float, mount: Angles, seed: int = SEED) -> Drive:
    """Simulate a drive with the thesis' sensor."""
    return simulate(replace(BASE, route=route, seconds=seconds, mount=from_thesis(mount), seed=seed))


def beginning(drive: Drive, seconds: float) -> Drive:
    """The first seconds of a drive."""
    return Drive(drive.samples.slice(0, int(np.searchsorted(drive.samples.t, seconds))), drive.truth)


def traces(drive: Drive) -> dict[str, Trace]:
    """Run both presets."""
    return {name: trace(params, drive) for name, params in PRESETS.items()}


def median_error(params: Parameters, drives: Sequence[Drive]) -> str:
    """Median of the final errors of the drives that came to an estimate."""
    errors = np.array([final_error(params, drive) for drive in drives])
    known = errors[np.isfinite(errors)]
    return number(float(np.median(known)) if known.size else np.nan)


def table(columns: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Markdown table."""
    lines = [columns, ["---"] * len(columns), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def columns_table(corner: str, names: Sequence[str], columns: Mapping[str, Sequence[str]]) -> str:
    """Markdown table from columns."""
    rows = [[name, *(column[k] for column in columns.values())] for k, name in enumerate(names)]
    return table([corner, *columns], rows)


def picture(name: str, text: str) -> str:
    """Markdown picture."""
    return f"![{text}](pictures/thesis/{name}.png)"


def number(value: float, unit: str = "") -> str:
    """One decimal, or `none`."""
    return f"{value:.1f}{unit}" if np.isfinite(value) else "none"


def angles_text(angles: Angles) -> str:
    """Three angles."""
    return ", ".join(f"{a:.1f}" for a in angles)


def printed_text(angles: Angles, mount: Angles) -> str:
    """Angles of the print and their total error."""
    return f"{angles_text(angles)} ({error(from_thesis(angles), from_thesis(mount)):.1f})"


def estimate_text(q_vs: Floats, mount: Angles) -> str:
    """Angles of an estimate and its total error."""
    if not np.all(np.isfinite(q_vs)):
        return "none"
    return f"{angles_text(to_thesis(q_vs, mount))} ({error(q_vs, from_thesis(mount)):.1f})"
