"""Recorded drives of other people, which are not part of the project: figures only."""

import json
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from api import formats
from benchmarks.accuracy_study import gyroscopes, parallel
from benchmarks.accuracy_study.options import Options
from benchmarks.accuracy_study.procrustes import procrustes
from benchmarks.accuracy_study.runs import Json, confirmations_of, degrees_off, error_vector, plain, run
from benchmarks.accuracy_study.statistics import REGION, Target, at_least, at_most, number, quantile, share_of, table
from core import DEFAULT, THESIS, Outcome, Samples, quaternion

Floats = NDArray[np.float64]

PAIRS = (
    ("hipnuc_20220320_dev11", "hipnuc_20220320_dev12"),
    ("wid_skoda_trial02_mru", "wid_skoda_trial02_dot"),
    ("wid_skoda_trial08_mru", "wid_skoda_trial08_dot"),
)
"""two devices on one drive"""
TURNS = 20
DISCREPANCY = 0.05
"""deg; the answer turns with the log"""
SEED = 11


def load(path: Path) -> Samples:
    """Read a recorded drive."""
    log = formats.parse(path.read_bytes(), "text/csv", "gzip", formats.FILE_LIMITS)
    return log.samples().samples


def turned(samples: Samples, q: Floats) -> Samples:
    """Give what the device would have recorded, had it been turned by `q`."""
    r = quaternion.matrix(q)
    return replace(samples, f_s=samples.f_s @ r.T, w_s=samples.w_s @ r.T)


def rotations(rng: np.random.Generator) -> Floats:
    """(20, 4) rotations: any, about 90 and about 180 degrees."""
    axes = quaternion.rotate(quaternion.random(rng, TURNS), [0.0, 0.0, 1.0])
    angles = np.concatenate([rng.uniform(0, 180, 8), rng.normal(90, 0.5, 6), rng.normal(180, 0.5, 6)])
    return quaternion.from_rotation_vector(np.radians(angles)[:, None] * axes)


def follow(path: Path) -> Json:
    """Run one recorded drive; deg."""
    samples = load(path)
    about = json.loads(path.with_name(path.name.removesuffix(".csv.gz") + ".json").read_text(encoding="utf-8"))
    truth = quaternion.from_matrix(about["R_sensor_to_vehicle"]) if about["mount_known"] else None
    outcome = run(DEFAULT, samples)
    return {
        "known": truth is not None,
        "seconds": float(samples.t[-1] - samples.t[0]),
        "errors": None if truth is None else accuracy(samples, truth),
        "confirmed": None if truth is None else [plain(c) for c in confirmations_of(outcome, truth)],
        "halves": halves(samples),
        "turning": turning(samples, outcome),
        "estimate": _final(outcome),
    }


def accuracy(samples: Samples, truth: Floats) -> Json:
    """Errors after 2 minutes and at the end; the log is turned at random, or identity might help the thesis' start."""
    q = quaternion.random(np.random.default_rng(SEED))
    log, truth = turned(samples, q), quaternion.multiply(truth, quaternion.conjugate(q))
    times = np.array([log.t[0] + 120.0, log.t[-1]])
    found = {"procrustes": plain(degrees_off(procrustes(log, times), truth))}
    for name, params in (("default", DEFAULT), ("thesis", THESIS)):
        estimates = run(params, log).estimates
        newest = np.searchsorted(estimates.t, times, side="right") - 1
        found[name] = plain(np.append(degrees_off(estimates.quaternion, truth), np.nan)[newest])
    return found


def halves(samples: Samples) -> Json | None:
    """Compare the estimates of the two halves of a drive; None when one of them has none."""
    middle = int(np.searchsorted(samples.t, 0.5 * (samples.t[0] + samples.t[-1])))
    parts = (samples.slice(0, middle), samples.slice(middle, len(samples)))
    first, second = (run(DEFAULT, part).status.estimate for part in parts)
    if first is None or second is None:
        return None
    apart = error_vector(first.quaternion, second.quaternion)
    variance = first.sigma**2 + second.sigma**2
    return {"angle": float(np.degrees(np.linalg.norm(apart))), "square": float(np.sum(apart**2 / variance))}


def turning(samples: Samples, outcome: Outcome) -> float | None:
    """Turn the log 20 times: the largest departure of the estimate from turning with it, deg."""
    here = outcome.status.estimate
    if here is None:
        return None
    worst = 0.0
    for q in rotations(np.random.default_rng(SEED)):
        there = run(DEFAULT, turned(samples, q)).status.estimate
        expected = quaternion.multiply(here.quaternion, quaternion.conjugate(q))
        worst = max(worst, 180.0 if there is None else float(degrees_off(there.quaternion, expected)))
    return worst


def _final(outcome: Outcome) -> Json | None:
    estimate = outcome.status.estimate
    if estimate is None:
        return None
    return {"q_vs": estimate.quaternion.tolist(), "sigma": estimate.sigma.tolist()}


def measure(options: Options) -> Json:
    """Run every recorded drive there is."""
    paths = sorted(options.data.glob("*.csv.gz"))
    if not paths:
        print(f"real: skipped, no recorded drives in {options.data}", file=sys.stderr, flush=True)
    names = [path.name.removesuffix(".csv.gz") for path in paths]
    drives = dict(zip(names, parallel.run("real", follow, paths), strict=True)) if paths else {}
    place = dict(zip(names, paths, strict=True))
    pairs = {
        f"{a}, {b.removeprefix(a[:-3])}": relative(drives[a], drives[b], load(place[a]), load(place[b]))
        for a, b in PAIRS
        if a in drives and b in drives
    }
    return {"drives": drives, "pairs": pairs}


def relative(a: Json, b: Json, log_a: Samples, log_b: Samples) -> Json | None:
    """Compare the rotation between two devices in one car with what their gyroscopes show; deg."""
    if a["estimate"] is None or b["estimate"] is None:
        return None
    q_a, q_b = (np.array(x["estimate"]["q_vs"]) for x in (a, b))
    shown = gyroscopes.relative_rotation(log_a, log_b)
    # f_v = R_a f_a = R_b f_b, so w_a = R_a' R_b w_b; R_a (shown) R_b' would be 1, its rotation is about vehicle axes
    apart = quaternion.rotation_vector(quaternion.multiply(quaternion.multiply(q_a, shown), quaternion.conjugate(q_b)))
    variance = np.square(a["estimate"]["sigma"]) + np.square(b["estimate"]["sigma"])
    return {"angle": float(np.degrees(np.linalg.norm(apart))), "square": float(np.sum(apart**2 / variance))}


def _known(result: Json, estimator: str, k: int) -> Floats:
    return np.array(
        [drive["errors"][estimator][k] for drive in result["drives"].values() if drive["known"]], np.float64
    )


def targets(result: Json) -> list[Target]:
    """Where the mounting is known the error; everywhere what can be asked without knowing it."""
    drives = list(result["drives"].values())
    both = [drive["halves"]["square"] < REGION for drive in drives if drive["halves"]]
    pairs = [pair["square"] < REGION for pair in result["pairs"].values() if pair]
    turns = [drive["turning"] for drive in drives if drive["turning"] is not None]
    worst = max(turns) if turns else float("nan")
    medians = [quantile(_known(result, "default", k), 0.5) for k in (0, 1)]
    ours, theirs = (_known(result, estimator, 1) for estimator in ("default", "procrustes"))
    no_worse = [bool(x <= y) for x, y in zip(ours, theirs, strict=True)]
    return [
        at_most("real drives: median error after 2 min / at the end", medians, (2.5, 1.5), "°"),
        at_least("real drives: no worse than Procrustes at the end", share_of(no_worse), 1.0),
        at_least("real drives: the halves agree within the stated 3 sigma", share_of(both), 1.0),
        at_least("real drives: two devices agree with their gyroscopes within 3 sigma", share_of(pairs), 1.0),
        at_most("real drives: the answer turns with the log, worst", (worst,), (DISCREPANCY,), "°"),
    ]


def text(result: Json) -> str:
    """Tables."""
    if not result["drives"]:
        return "## Real drives\n\nThe recorded drives, which are not part of the project, were not there: skipped."
    names = ("default", "thesis", "procrustes")
    rows = [_accuracy_row(name, d, names) for name, d in result["drives"].items() if d["known"]]
    rows.append(["median", "", *(number(quantile(_known(result, e, k), 0.5)) for e in names for k in (0, 1)), ""])
    columns = ["", "s", *(f"{e}, {when}" for e in ("`default`", "`thesis`", "Procrustes") for when in ("2 min", "end"))]
    return f"""## Real drives

Recordings other people made in their own vehicles (cars of several makes, phones and sensor modules, IMU at 10 to
400 Hz, GPS at 0.4 to 20 Hz). They are not part of the project; where they are missing this section is skipped. Total
error in degrees against the documented mounting, which itself is known to 1 to 3 degrees only, after a random rotation
of the log.

{table([*columns, "confirmed"], rows)}

Without knowing the truth: do the estimates of the first and the second half agree within their stated 3 sigma, and
does the estimate turn with the log ({TURNS} rotations, some close to 90 and 180 degrees)?

{table(["", "halves apart, °", "within 3 sigma", "worst departure when turned, °"], _consistency(result))}

Two devices in one car: the rotation between their estimated mountings against the one between their gyroscopes.

{table(["", "apart, °", "within 3 sigma"], _pair_rows(result))}"""


def _accuracy_row(name: str, drive: Json, names: tuple[str, ...]) -> list[str]:
    each = [_figure(drive["errors"][estimator][k]) for estimator in names for k in (0, 1)]
    confirmed = ", ".join(number(float(np.linalg.norm(c))) for c in drive["confirmed"]) or "–"
    return [name, f"{drive['seconds']:.0f}", *each, confirmed]


def _consistency(result: Json) -> list[list[str]]:
    rows = []
    for name, drive in result["drives"].items():
        both = drive["halves"]
        turn = "–" if drive["turning"] is None else f"{drive['turning']:.4f}"
        rows.append([name, *_agreement(both), turn])
    return rows


def _pair_rows(result: Json) -> list[list[str]]:
    return [[name, *_agreement(pair)] for name, pair in result["pairs"].items()]


def _agreement(found: Json | None) -> list[str]:
    if not found:
        return ["–", "–"]
    return [number(found["angle"]), "yes" if found["square"] < REGION else "**no**"]


def _figure(value: float | None) -> str:
    return "none" if value is None else number(value)
