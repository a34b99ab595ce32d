"""Both databases of a pair measured, one against the other."""

import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

from benchmarks.age_study import looks, uploads
from benchmarks.age_study.databases import maker
from benchmarks.age_study.pair import Pair, Size, pair
from benchmarks.age_study.uploads import AGES, Uploads
from benchmarks.kernel_speed.timing import Contender, Timing, in_turn
from benchmarks.load_study.drives import pool

DRIVES = 5
"""different ones, each driven by several devices"""
BEFORE, DURING = 5, 15
"""minutes of a drive"""


class Effort(NamedTuple):
    """How often things are done."""

    rounds: int = 60
    """chunks of each device"""
    repeats: int = 40
    """of each list and chart"""


class Study(NamedTuple):
    """What was measured on a kind of database."""

    uploads: Uploads
    looks: Mapping[tuple[str, str], Timing]
    """by age and name, s"""
    size: Size


def carry_out(kind: str, size: Size, effort: Effort) -> Study:
    """Build a pair of databases and measure them."""
    with tempfile.TemporaryDirectory(prefix="livella-age-") as name:
        directory = Path(name)
        with maker(kind, directory) as made, pair(made, directory, size) as compared:
            return _measure(compared, effort)


def _measure(compared: Pair, effort: Effort) -> Study:
    contexts = dict(zip(AGES, (compared.old, compared.fresh), strict=True))
    found = {
        (age, name): Contender(look, 1)
        for age, context in contexts.items()
        for kind in (looks.lists, looks.alerts, looks.charts)
        for name, look in kind(context)
    }
    timings = in_turn(found, effort.repeats)
    return Study(uploads.measure(compared, pool(DRIVES, BEFORE, DURING), effort.rounds), timings, compared.size)
