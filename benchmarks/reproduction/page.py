"""Run the experiments of thesis chapter 5 and write docs/thesis.md with its pictures."""

import time

from benchmarks.reproduction.common import DOCS, SEED, SEEDS
from benchmarks.reproduction.observability import estimates, observability
from benchmarks.reproduction.roundabout import roundabout
from benchmarks.reproduction.statistics import acceptance, limits, statistics

INTRODUCTION = f"""# The experiments of the thesis, made again

Chapter 5 of the thesis, run with the preset `thesis` (the 9-state filter with table 5.1, started from identity) and
beside it with the preset `default`. The thesis' recordings are not available, so the drives are simulated
(`core/simulation.py`): its accelerometer (200 Hz, counts of 1 % of g, 20 mg bias per axis, no gyroscope), GPS at 4 Hz
and 0 to 0.5 s late, ordinary suspension and vibration, roads with 1 to 2 % of grade. The numbers show whether the
behaviour is the same, not whether the digits are. Single runs use seed {SEED}; medians are over {len(SEEDS)} seeds.

Installation angles are the thesis': theta about z, phi about y, psi about x, vehicle axes forward, right, down. In
brackets stands the total rotation between estimate and truth, because single angles mean little near theta = ±90°.
Made by `make bench`, or `python benchmarks/thesis.py`."""


def write_page() -> None:
    """Make docs/thesis.md again, saying how far it is."""
    begin = time.monotonic()
    parts = [INTRODUCTION]
    for section in (observability, estimates, roundabout, acceptance, statistics, limits):
        parts.append(section())
        print(f"thesis: {section.__name__} done after {time.monotonic() - begin:.0f} s", flush=True)
    (DOCS / "thesis.md").write_text("\n\n".join(parts) + "\n", encoding="utf-8")
    print(f"thesis: wrote {DOCS / 'thesis.md'}", flush=True)
