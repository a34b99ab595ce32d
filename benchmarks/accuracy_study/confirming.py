"""Confirmations in the drives of the cells: when, how good, and whether the stated sigma holds."""

import numpy as np

from benchmarks.accuracy_study.cells import CELLS
from benchmarks.accuracy_study.runs import Json, size
from benchmarks.accuracy_study.statistics import (
    REGION,
    Target,
    at_least,
    at_most,
    percent,
    quantile,
    share_of,
    spread,
    table,
)

TOWN = [name for name, cell in CELLS.items() if cell.route == "city"]
SLOWEST = (120.0, 240.0)
"""s from the first motion: median, 90th percentile"""
WITHIN = 0.99


def waits(drives: list[Json]) -> list[float]:
    """Give the time from the first motion to the first confirmation of each drive, s; infinite = never."""
    return [drive["confirmed"][0]["t"] - drive["moving"] if drive["confirmed"] else np.inf for drive in drives]


def first_ones(drives: list[Json]) -> list[Json]:
    """Pick each drive's first confirmation."""
    return [drive["confirmed"][0] for drive in drives if drive["confirmed"]]


def in_region(found: list[Json]) -> float:
    """Give the share of confirmations with the truth inside the joint three-sigma region."""
    return share_of([np.sum(np.square(np.divide(c["error"], c["sigma"]))) < REGION for c in found])


def in_axes(found: list[Json]) -> float:
    """Give the share of axes with the truth within three sigma."""
    return share_of([np.abs(np.divide(c["error"], c["sigma"])) < 3 for c in found])


def targets(result: Json) -> list[Target]:
    """Speed in town, honesty everywhere."""
    town = [wait for name in TOWN for wait in waits(result[name])]
    found = [c for drives in result.values() for c in first_ones(drives)]
    return [
        at_most(
            "town: time from first motion to confirmation, median / 90th percentile",
            (quantile(town, 0.5), quantile(town, 0.9)),
            SLOWEST,
            " s",
        ),
        at_least("confirmations with the truth inside the stated 3-sigma region", in_region(found), WITHIN),
        at_least("the same, axis by axis", in_axes(found), WITHIN),
    ]


def text(result: Json) -> str:
    """Table."""
    rows = []
    for name, drives in result.items():
        found = first_ones(drives)
        confirmed = share_of([bool(drive["confirmed"]) for drive in drives])
        wait, off = spread(waits(drives), 0.9), spread([size(c) for c in found])
        rows.append([name, percent(confirmed), wait, off, percent(in_region(found)), percent(in_axes(found))])
    columns = ["", "confirmed", "after, s", "error, °", "in the 3-sigma region", "axes within 3 sigma"]
    return f"""## Confirmations

The same drives. Seconds from the first motion to the first confirmation, median / 90th percentile, drives never
confirmed counting as infinitely slow; total error at confirmation, median / 95th percentile; how often the truth lies
inside what was stated with it (99.73 % if all errors were Gaussian).

{table(columns, rows)}"""
