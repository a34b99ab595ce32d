"""The section on the page of docs/performance.md."""

import os
from collections.abc import Iterator
from statistics import median

from benchmarks.accuracy_study.statistics import Target, at_most, number, table, target_table
from benchmarks.kernel_speed.page import processor
from benchmarks.page_study.loading import QUIET, SLOW_DOWN, largest
from benchmarks.page_study.study import DEVICES, Study

SCRIPT = 200.0
"""kB"""
USABLE = 1.5
"""s"""
TEXT = """## The page

How quickly the page comes and moves in Chromium, made by `make bench-page`, with {devices:,} devices in the service.

First visits: nothing is kept from an earlier one, a phone's screen, the processor made {slow} times slower, the service
on the same machine. "Usable" is the time from the beginning of the visit until what the view is for has been painted:
the field for the key, the first rows of the list, the stage of a device. JavaScript is what comes over the network,
compressed with Brotli, until {quiet:.0f} s after that; over plain http from another machine browsers take gzip only,
which is about an eighth more. The 3D picture of a device is not counted, it comes last and only where it is shown.
Frames a second are counted on a desk's screen without slowing the processor down, while the page is moved with every
frame for 3 s; Chromium draws without a graphics card here, and 60 is the most it draws.

Times are medians of {times} with the slowest behind the slash, frames medians with the fewest behind it.

Measured on: {machine}, shared with other work (load average {load:.1f}, this included)."""


def assemble(study: Study) -> str:
    """Write the section."""
    text = TEXT.format(
        devices=DEVICES,
        slow=SLOW_DOWN,
        quiet=QUIET / 1000,
        times=len(study.frames[0].rates),
        machine=processor(),
        load=os.getloadavg()[1],
    )
    return "\n\n".join([text, target_table(list(targets(study))), _first_visits(study)])


def targets(study: Study) -> Iterator[Target]:
    """Judge everything."""
    yield at_most("JavaScript of any first visit", [largest(study.visits)], [SCRIPT], " kB")
    slowest = max(study.visits, key=lambda one: one.usable)
    yield at_most(f"usable, slowest view ({slowest.view.name})", [slowest.usable], [USABLE], " s")
    for frames in study.frames:
        rate = median(frames.rates)
        wanted = f"≥ {frames.wanted:.0f} frames/s"
        measured = f"{rate:.0f} / {min(frames.rates):.0f} frames/s"
        yield Target(frames.what, wanted, measured, rate >= frames.wanted)


def _first_visits(study: Study) -> str:
    rows = [
        [one.view.name, f"{one.script:.0f}", f"{number(one.usable)} / {number(one.slowest)}"] for one in study.visits
    ]
    return table(["first visit", "JavaScript, kB", "usable after, s"], rows)
