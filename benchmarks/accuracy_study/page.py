"""Measure sections, keep what was measured, and put the page together from the latest of each."""

import json
import sys
import time
from collections.abc import Callable, Collection, Mapping
from typing import NamedTuple

from benchmarks.accuracy_study import alarms, cells, confirming, drive_tests, hard, parallel, real, remounts
from benchmarks.accuracy_study.options import CACHE, DOCS, Options
from benchmarks.accuracy_study.runs import Json
from benchmarks.accuracy_study.statistics import Target, target_table

INTRODUCTION = """# How accurate, how honest, how careful

What the estimator with the preset `default` does on thousands of simulated drives (`core/simulation.py`: rigid-body
exact, sensor errors, suspension, vibration, road slopes, late and wandering GPS, all drawn at random) and on recorded
ones, beside what was wanted of it. Every figure is computed; made by `make bench-accuracy`, or
`python benchmarks/accuracy.py`. Total error is the angle of the rotation between estimated and true mounting."""


def _no_targets(result: Json) -> list[Target]:
    del result
    return []


class Section(NamedTuple):
    """A part of the page."""

    source: str
    """the measurement it tells of"""
    targets: Callable[[Json], list[Target]]
    text: Callable[[Json], str]


MEASURES: Mapping[str, Callable[[Options], Json]] = {
    "cells": cells.measure,
    "hard": hard.measure,
    "remounts": remounts.measure,
    "alarms": alarms.measure,
    "drive-test": drive_tests.measure,
    "real": real.measure,
}
SECTIONS = {
    "cells": Section("cells", cells.targets, cells.text),
    "confirmations": Section("cells", confirming.targets, confirming.text),
    "hard": Section("hard", hard.targets, hard.text),
    "remounts": Section("remounts", remounts.targets, remounts.text),
    "alarms": Section("alarms", alarms.targets, alarms.text),
    "drive-test": Section("drive-test", _no_targets, drive_tests.text),
    "real": Section("real", real.targets, real.text),
}


def measure(names: Collection[str], options: Options) -> None:
    """Measure what the sections tell of, each once, and keep it under out/accuracy/."""
    parallel.warm_up()
    CACHE.mkdir(parents=True, exist_ok=True)
    for source in dict.fromkeys(SECTIONS[name].source for name in names):
        begin = time.monotonic()
        result = MEASURES[source](options)
        (CACHE / f"{source}.json").write_text(json.dumps(result), encoding="utf-8")
        print(f"accuracy: {source} done in {time.monotonic() - begin:.0f} s", file=sys.stderr, flush=True)


def latest() -> dict[str, Json]:
    """Read the latest measurement of each kind there is."""
    paths = {source: CACHE / f"{source}.json" for source in MEASURES}
    return {source: json.loads(path.read_text(encoding="utf-8")) for source, path in paths.items() if path.exists()}


def assemble(results: Mapping[str, Json]) -> str:
    """Write the page: every target first, then the sections; what was not measured is left out."""
    there = [section for section in SECTIONS.values() if section.source in results]
    targets = [target for section in there for target in section.targets(results[section.source])]
    met = sum(target.met is True for target in targets)
    summary = f"## Targets\n\n{met} of {len(targets)} are met.\n\n{target_table(targets)}"
    texts = [section.text(results[section.source]) for section in there]
    return "\n\n".join([INTRODUCTION, summary, *texts]) + "\n"


def write_page() -> None:
    """Make docs/accuracy.md again from the latest measurements."""
    (DOCS / "accuracy.md").write_text(assemble(latest()), encoding="utf-8")
    print(f"accuracy: wrote {DOCS / 'accuracy.md'}", file=sys.stderr, flush=True)
