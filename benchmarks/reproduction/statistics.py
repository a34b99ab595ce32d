"""Many drives: errors of 79 estimates (table 5.3), what the drive test accepts, what limits the estimate."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import count, cycle, islice
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.reproduction import figures
from benchmarks.reproduction.angles import Angles, error, from_thesis, to_thesis, wrapped
from benchmarks.reproduction.common import (
    BASE,
    FIRST_MOUNT,
    PICTURES,
    SEED,
    case,
    columns_table,
    median_error,
    picture,
    table,
)
from benchmarks.reproduction.runs import PRESETS, Believed, drive_test, restarted
from core import quaternion
from core.simulation import Drive, Scenario, simulate

Floats = NDArray[np.float64]
Found = list[tuple[Drive, Believed]]

MOUNTS: tuple[Angles, ...] = (
    FIRST_MOUNT, (0, 0, 0), (0, 180, 0), (0, -90, 180), (20, 10, -90), (0, 45, -60), (30, -120, 20), (-45, 60, 150),
)  # fmt: skip
"""away from theta = 90 deg, where the error of a single angle means nothing"""
ROUTES = ("city", "curves", "straight", "roundabout", "hills")
PRINTED = ((3.6428, 5.0191), (2.3623, 2.8730), (5.1307, 7.1856))
ESTIMATES = 79
OFFSETS = (0.0, 2.0, 5.0, 10.0, 17.0, 45.0)
"""deg, wrong mountings on the drive test"""


def statistics() -> str:
    """Figures 5.13 to 5.15, table 5.3."""
    found = _collect()
    errors = {name: _angle_errors(estimates) for name, estimates in found.items()}
    figures.save(figures.histograms(errors, ("theta", "phi", "psi")), PICTURES / "errors.png")
    groups = {
        "`thesis`, STABLE": found["thesis"],
        "of these, RELIABLE too": [x for x in found["thesis"] if x[1].reliable],
        "of these, straight and roundabout": [x for x in found["thesis"] if _starts_straight(x[0])],
        "of these, town, curves, hills": [x for x in found["thesis"] if not _starts_straight(x[0])],
        "`default`, STABLE and RELIABLE": found["default"],
    }
    rows = [["printed", "79", *(f"{mean:.1f} / {std:.1f}" for mean, std in PRINTED), "", ""]]
    rows += [[name, *_statistics_row(estimates)] for name, estimates in groups.items()]
    columns = ["", "estimates", "theta", "phi", "psi", "total: median", "total: within 5°"]
    return f"""## Errors of {ESTIMATES} estimates (thesis 5.2.3, figures 5.13 to 5.15, table 5.3)

Town, curves, straight, roundabouts and hills, {len(MOUNTS)} orientations; each estimate starts from nothing and is
taken when STABLE, then all is forgotten. Mean of the absolute error and standard deviation of the error, degrees.

{picture("errors", "Histograms of the errors of the three angles")}

{table(columns, rows)}

STABLE says nothing about truth, as the print finds too. Our means and deviations are larger than the print's because
a share of the estimates settles tens of degrees off, nearly all on straight roads or on the straight that begins a
roundabout drive; on the other routes they are the print's or smaller, but for one estimate that is the wrong way round.
In print errors above 10° are the exception; which drives and orientations its 79 estimates come from, and its threshold
of STABLE, are not told. RELIABLE hardly sorts them, because driving off and stopping set it, too."""


def _starts_straight(drive: Drive) -> bool:
    return drive.truth.scenario.route in {"straight", "roundabout"}


def _collect() -> dict[str, Found]:
    """The first so many estimates of each preset, over drives of five minutes with routes and mountings in turn."""
    found: dict[str, Found] = {name: [] for name in PRESETS}
    for drive in islice(_mixed_drives(), 60):
        for name, params in PRESETS.items():
            if len(found[name]) < ESTIMATES:
                found[name] += [(drive, x) for x in restarted(params, drive, only_reliable=name == "default")]
    return {name: estimates[:ESTIMATES] for name, estimates in found.items()}


def _mixed_drives() -> Iterator[Drive]:
    for seed, route, mount in zip(count(100), cycle(ROUTES), cycle(MOUNTS), strict=False):
        yield case(route, 300.0, mount, seed)


def _angle_errors(found: Sequence[tuple[Drive, Believed]]) -> Floats:
    rows = []
    for drive, estimate in found:
        mount = min(MOUNTS, key=lambda m: error(from_thesis(m), drive.truth.q_vs))
        rows.append(wrapped(np.array(to_thesis(estimate.q_vs, mount)) - mount))
    return np.array(rows)


def _statistics_row(found: Sequence[tuple[Drive, Believed]]) -> list[str]:
    total = np.array([error(estimate.q_vs, drive.truth.q_vs) for drive, estimate in found])
    each = [f"{np.mean(np.abs(column)):.1f} / {np.std(column):.1f}" for column in _angle_errors(found).T]
    return [str(len(found)), *each, f"{np.median(total):.1f}", f"{100 * np.mean(total < 5):.0f} %"]


def acceptance() -> str:
    """Which mountings pass the drive test."""
    town, hills = replace(BASE, seconds=600), replace(BASE, seconds=600, route="hills")
    flat = replace(town, relief=0.0)
    columns = {
        "`thesis`, flat town": _accepted("thesis", flat),
        "flat town, 3 mg": _accepted("thesis", replace(flat, sensor="calibrated", gyro=False)),
        "town": _accepted("thesis", town),
        "hills": _accepted("thesis", hills),
        "`default`, town": _accepted("default", town),
        "hills ": _accepted("default", hills),
    }
    return f"""### What the drive test accepts

Share of tests passed by mountings turned through an angle about a random axis: for `thesis` starting from the true
mounting, for `default` from its own estimate after five minutes and more, which comes with an estimated bias. Four
drives, five starts each.

{columns_table("turned by", [f"{offset:.0f}°" for offset in OFFSETS], columns)}

As printed the test is one of sensor and road rather than of the mounting: only on a flat road and with a sensor
calibrated to a few mg does it tell right from wrong. `default` compares energies, so that slopes cancel, and takes off
the estimated bias. No test of the forward axis sees a turn about that axis: hence the passes at large angles."""


def _accepted(preset: str, scenario: Scenario) -> list[str]:
    rng = np.random.default_rng(SEED)
    drives = [simulate(replace(scenario, seed=seed)) for seed in range(1, 5)]
    starts = [(drive, start) for drive in drives for start in (300.0, 350.0, 400.0, 450.0, 500.0)]
    shares = []
    for offset in OFFSETS:
        turns = np.radians(offset) * quaternion.rotate(quaternion.random(rng, len(starts)), [1.0, 0.0, 0.0])
        verdicts = [
            drive_test(PRESETS[preset], drive, drive.truth.q_vs if preset == "thesis" else None, turn, start)
            for (drive, start), turn in zip(starts, turns, strict=True)
        ]
        shares.append(f"{100 * np.mean([verdict for verdict in verdicts if verdict is not None]):.0f} %")
    return shares


def limits() -> str:
    """Take the disturbances away one by one."""
    calibrated = {"sensor": "calibrated", "gyro": False}
    ideal_place = {"latency": 0.0, "lever_arm": (0.0, 0.0, 0.0)}
    changes: dict[str, dict[str, Any]] = {
        "as it is": {},
        "flat road": {"relief": 0.0},
        "sensor calibrated to 3 mg": calibrated,
        "GPS not late, device at the turning point": ideal_place,
        "all three": {"relief": 0.0} | calibrated | ideal_place,
    }
    rows = []
    for name, change in changes.items():
        drives = [simulate(replace(BASE, seconds=300, seed=seed, **change)) for seed in range(1, 9)]
        rows.append([name, *(median_error(params, drives) for params in PRESETS.values())])
    return f"""## What limits the estimate

Median total error in degrees after five minutes of town driving, eight drives, random mountings.

{table(["", *(f"`{name}`" for name in PRESETS)], rows)}"""
