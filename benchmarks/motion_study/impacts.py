"""Events: crashes found, hours without one, harsh driving. Writes its section of docs/motion.md and its picture."""

from itertools import product
from math import ceil

import numpy as np

from benchmarks.accuracy_study import parallel
from benchmarks.accuracy_study.options import DOCS
from benchmarks.accuracy_study.statistics import Target, number, percent, quantile, table, target_table
from benchmarks.motion_study import impacts_figures
from benchmarks.motion_study.impacts_runs import (
    CRASHES,
    HARSH,
    ORDINARY,
    REPEATS,
    ROADS,
    STINT,
    Json,
    crashes,
    harsh_driving,
    hours,
    in_hand,
    ordinary,
)
from benchmarks.sections import write_section
from core.motion.events import DEFAULT, SECONDS_AFTER, SECONDS_BEFORE, EventKind
from core.motion.events_state import LAYOUT
from core.params import thresholds

PAGE = DOCS / "motion.md"
PICTURE = DOCS / "pictures" / "motion" / "impacts.png"

SEED = 20000
"""of the first run; no threshold was chosen on these"""
HOURS = 300.0
BATCHES, BATCH = 20, 50
"""of crashes per case"""
HANDS = 200
"""devices taken in hand, and as many that fall"""
MANOEUVRES = 60
DRIVES = 12
"""ordinary ones per route"""
LISTED = 10
NEAR_ENOUGH = 10.0
"""deg"""


def write(share: float = 1.0) -> None:
    """Measure and write; a smaller share is a shorter study, for trying it out."""
    result = measure(share)
    write_section(PAGE, "events", text(result))
    chosen = [case.name for case in CRASHES[:3]]
    figure = impacts_figures.impacts({name: _columns(result["crashes"][name]) for name in chosen})
    impacts_figures.save(figure, PICTURE)


def measure(share: float = 1.0) -> Json:
    """Run everything on all cores."""
    batches = range(SEED, SEED + max(1, round(BATCHES * share)))
    hit = parallel.run("crashes", crashes, [(case, seed, BATCH) for case, seed in product(CRASHES, batches)])
    names = [case.name for case, _ in product(CRASHES, batches)]
    stints = ceil(HOURS * share * 3600 / STINT / REPEATS / len(ROADS))
    driven = parallel.run("hours", hours, list(product(ROADS, range(SEED, SEED + stints))))
    hands = list(product(("removals", "falls"), range(SEED, SEED + max(1, round(HANDS * share)))))
    held = parallel.run("in hand", in_hand, hands)
    drives = list(product(ORDINARY, range(SEED, SEED + max(1, round(DRIVES * share)))))
    return {
        "crashes": {
            case.name: [x for name, runs in zip(names, hit, strict=True) if name == case.name for x in runs]
            for case in CRASHES
        },
        "hours": driven,
        "in_hand": [run | {"kind": kind} for run, (kind, _) in zip(held, hands, strict=True)],
        "harsh": parallel.run("harsh", harsh_driving, range(SEED, SEED + max(1, round(MANOEUVRES * share)))),
        "ordinary": parallel.run("ordinary", ordinary, drives),
    }


def _columns(runs: list[Json]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    found = [run for run in runs if run["found"]]
    error, true, told = (
        np.array([run[name] for run in found])
        for name in ("direction_error", "velocity_change", "velocity_change_told")
    )
    return error, true, told


def targets(result: Json) -> list[Target]:
    """Give what was wanted of impacts."""
    runs = [run for case in CRASHES[:2] for run in result["crashes"][case.name]]
    share, error = float(np.mean([run["found"] for run in runs])), _columns(runs)[0]
    false, total = sum(len(run["impacts"]) for run in result["hours"]), sum(run["hours"] for run in result["hours"])
    middle, high, most = (quantile(error, level) for level in (0.5, 0.95, 1.0))
    near = float(np.mean(error <= NEAR_ENOUGH))
    measured = f"{percent(near)}; median {number(middle)}, 95 % {number(high)}, largest {number(most)}°"
    return [
        Target("impacts found, 200 Hz, ranges 40 g and 16 g", "≥ 99 %", percent(share), share >= 0.99),
        Target(f"of these, direction within {NEAR_ENOUGH:.0f}°", "≥ 99 %", measured, near >= 0.99),
        Target("impacts told where there was none", "0", f"{false} in {total:.0f} h", false == 0),
    ]


def text(result: Json) -> str:
    """Write the section."""
    return "\n\n".join([_method(), _measured(result), _limits()])


def _method() -> str:
    return f"""## Events

`core/motion/events.py` tells, in the vehicle's axes, what happens to a vehicle whose mounting is known: impacts, harsh
braking, acceleration and cornering, and potholes. It needs an accelerometer; fixes and a gyroscope make it surer.

Gravity on slopes, the road's bank and the bias of the accelerometer are what the acceleration of the fixes (difference
of the speeds; speed times change of the course) does not explain, averaged over {DEFAULT.offset_time:.0f} s, or over
{DEFAULT.offset_time_without_fixes:.0f} s where there are no fixes. What departs by more than
{DEFAULT.offset_clip:.0f} m/s² counts as that much. The rest is the acceleration on the plan.

- **Harsh driving**: that acceleration behind two low-passes, divided by what dive and lean of the body add, stays
  beyond its threshold. A vehicle that stands by its fixes does not drive harshly.
- **Potholes**: the vertical acceleration between {DEFAULT.pothole_low:.0f} and {DEFAULT.pothole_high:.0f} Hz exceeds
  its threshold and what is usual on this road. Kerbs and humps taken fast are potholes in this sense.
- **Impacts**: a pulse on the plan, from the full band. It has to be larger than anything tyres can do, both in all and
  over the acceleration just before it (so that braking hard adds nothing), to change the velocity while it is so, to
  point one way and not swing back (doors, rough roads and mounts that ring do), to last (knocks are short) and to be
  horizontal rather than vertical (kerbs, potholes, humps). The direction is that of the change of the velocity. Where
  an axis is at the end of its range, the direction is the one from which a push explains all readings best, those at
  the end of the range being lower bounds; the peak is then a lower bound too.
- **A device in hand**: while it turns out of the level (gyroscope), or gravity is not where it was, nothing is told.
  An impact is therefore told {DEFAULT.impact_wait:.0f} s after the pulse, but at once when the samples end: a device
  that was crashed may send no more. The fixes are not asked whether the speed changed: the least impacts change it by
  little more than a receiver errs, and the late fixes of a second would have to be waited for.

Worth keeping about an impact: {SECONDS_BEFORE:.0f} s before and {SECONDS_AFTER:.0f} s after it. The state between two
uploads takes {LAYOUT.itemsize} bytes.

{_threshold_table()}"""


def _threshold_table() -> str:
    rows = [[f"`{x.name}`", f"{x.value:.4g}", x.unit, x.meaning] for x in thresholds(DEFAULT)]
    return table(["threshold", "value", "unit", "meaning"], rows)


def _measured(result: Json) -> str:
    return f"""### Measured

{target_table(targets(result))}

Simulated crashes (`core/simulation_events.py`): pulses as a haversine, half-sine or triangle of 3 to 40 g over 60 to
150 ms that change the velocity by 2 to 70 km/h, from any side, half of them oblique and beside the centre of gravity,
so that the vehicle spins; the structure rings with 5 to 30 % of the peak at 30 to 90 Hz; the vehicle slides to rest. In
towns, hills, on motorways and parked, in any mounting, which is known to 1° per axis. Errors of the direction in
degrees, of the found ones; the last three columns are medians of what was told over what was true.

{_crash_table(result)}

![Direction and change of the velocity](pictures/motion/impacts.png)

Hours of driving on roads 1.5 to 3.5 times as rough as usual, and parked, with about thirty jolts an hour of each kind
(`core/simulation_jolts.py`), every other stint without a gyroscope:

{_hours_table(result)}

{_found(result)}

Devices taken off, turned in hand and clicked back, or falling to the floor, that were told as an impact:

{_hands_table(result)}

Manoeuvres: clearly harsh is 15 % beyond the threshold for half a second; told rightly is whatever comes within 15 % of
it. At 10, 50, 100 and 200 Hz, with and without gyroscope.

{_harsh_table(result)}

Ordinary drives, on which nobody drives harshly (towns, hills, motorways, bends, roundabouts, grades of 20 %): told per
100 km

{_ordinary_table(result)}"""


def _crash_table(result: Json) -> str:
    rows = []
    for name, runs in result["crashes"].items():
        found = [run for run in runs if run["found"]]
        error = _columns(runs)[0]
        ratios = [
            np.median([run["peak_told"] / run["peak"] for run in found]),
            np.median([run["velocity_change_told"] / run["velocity_change"] for run in found]),
            np.median([run["duration_share"] for run in found]),
        ]
        figures = [number(quantile(error, share)) for share in (0.5, 0.95, 1.0)]
        rows.append([name, str(len(runs)), percent(len(found) / len(runs)), *figures, *map(number, ratios)])
    columns = ["", "crashes", "found", "median", "95 %", "largest", "peak", "velocity change", "duration"]
    return table(columns, rows)


def _hours_table(result: Json) -> str:
    jolts: dict[str, int] = {}
    potholes: dict[str, int] = {}
    for run in result["hours"]:
        for total, part in ((jolts, run["jolts"]), (potholes, run["potholes"])):
            for name, count in part.items():
                total[name] = total.get(name, 0) + count
    impacts = [impact for run in result["hours"] for impact in run["impacts"]]
    rows = [
        [name, str(count), str(sum(name in impact["near"] for impact in impacts)), str(potholes.get(name, 0))]
        for name, count in jolts.items()
    ]
    return table(["", "how many", "told as an impact", "as a pothole"], rows)


def _found(result: Json) -> str:
    impacts = [impact for run in result["hours"] for impact in run["impacts"]]
    if not impacts:
        return f"No impact was told in {sum(run['hours'] for run in result['hours']):.0f} h."
    lines = [
        f"- seed {impact['seed']} at {impact['t']:.0f} s, {impact['peak']:.0f} m/s²: {', '.join(impact['near'])}"
        for impact in impacts[:LISTED]
    ]
    return "\n".join(["What was told:", "", *lines])


def _hands_table(result: Json) -> str:
    rows = []
    for kind, gyro in product(("removals", "falls"), (True, False)):
        runs = [run for run in result["in_hand"] if run["kind"] == kind and run["gyro"] == gyro]
        told = sum(run["impacts"] > 0 for run in runs)
        rows.append([f"{kind}, {'with' if gyro else 'no'} gyroscope", f"{told} of {len(runs)}"])
    return table(["", "told as an impact"], rows)


def _harsh_table(result: Json) -> str:
    rows = []
    for kind in HARSH:
        clear, found, told, true = (
            sum(run[kind][name] for run in result["harsh"]) for name in ("clear", "found", "told", "true")
        )
        recall, precision = (part / whole if whole else float("nan") for part, whole in ((found, clear), (true, told)))
        words = kind.value.replace("_", " ")
        rows.append([words, str(clear), percent(recall), str(told), percent(precision)])
    return table(["", "clearly harsh", "found", "told", "rightly"], rows)


def _ordinary_table(result: Json) -> str:
    hundred = sum(run["metres"] for run in result["ordinary"]) / 1e5
    rows = [
        [kind.value.replace("_", " "), number(sum(run[kind] for run in result["ordinary"]) / hundred)]
        for kind in EventKind
    ]
    return table([f"{hundred * 100:.0f} km", "per 100 km"], rows)


def _limits() -> str:
    return """### Limits

- The direction is that of the device's place. A vehicle that is hit beside its centre of gravity spins, and a device
  far from the centre is pushed sideways by that: most of the error that is left.
- At the end of the range the change of the velocity and the duration are what was read: too small. Shorter ranges than
  16 g spoil the direction of heavy crashes too.
- A vehicle hit so lightly that it is pushed by less than the thresholds say is not told from one whose door was
  slammed.
- A device that is pulled off its place with a jerk of a few g looks like a light hit until it turns; without a
  gyroscope it has to turn far.
- A roll-over is told as the impact it begins with, if any.
- Receivers that give no speed tell no speed before an event, and slopes are then averaged over the longer time.
- Pulses, tyres and structures are simulated: no recorded crash was at hand. Recorded ordinary drives are looked at in
  the tests."""
