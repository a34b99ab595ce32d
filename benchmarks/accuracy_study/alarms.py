"""Hours of driving during which nothing happens to the device: no alarm may be raised."""

from dataclasses import replace
from typing import NamedTuple

import core
from benchmarks.accuracy_study import hard, parallel
from benchmarks.accuracy_study.options import Options
from benchmarks.accuracy_study.runs import Json, of_kind
from benchmarks.accuracy_study.statistics import Target, none_of, table
from core import DEFAULT, EventKind
from core.simulation import Scenario, simulate
from core.simulation_faults import Disturbances

HOURS = 300.0
SECONDS = 1800.0
LISTED = 20
"""alarms told one by one"""
NIGHT = Scenario(
    "parked", 6 * 3600.0, imu_rate=10.0, gps_rate=1.0, vibration=0.1, disturbances=Disturbances(bias_drift=0.1)
)


class Story(NamedTuple):
    """Drives one after the other, switched off between them."""

    sessions: tuple[Scenario, ...]
    counted: bool = True


def _town(**fields: object) -> Scenario:
    return replace(Scenario(seconds=SECONDS, imu_rate=50.0), **fields)  # type: ignore[arg-type]


ORDINARY = {
    f"{route}, {sensor}": Story((_town(route=route, sensor=sensor),))
    for route in ("city", "hills", "straight", "motorway", "curves")
    for sensor in ("mems", "tmd2")
}
CHAINS = {
    "town, off, town, off, hills": Story((_town(), _town(), _town(route="hills"))),
    "town, then a ferry, then town": Story((_town(), _town(route="ferry"), _town())),
    "town, then a night, then town": Story((_town(), NIGHT, _town())),
    "town, then steep hills": Story((_town(), _town(route="steep"))),
    "town, then reversing and crawling": Story((_town(), _town(reverse=True), _town(route="crawl"))),
    "town, then multipath": Story((_town(), _town(disturbances=Disturbances(multipath=3.0)))),
    "town, then towed": Story((_town(), _town(route="towed")), counted=False),
}
HARD = [name for name, kind in hard.KINDS.items() if kind.counted and not kind.sensor_fault]
STORIES = ORDINARY | CHAINS


def sessions_of(name: str, seed: int) -> list[Scenario]:
    """Make up the drives of a story."""
    if name in HARD:
        return [hard.scenario_of(name, seed, SECONDS)]
    return [replace(scenario, seed=seed, session=k) for k, scenario in enumerate(STORIES[name].sessions)]


def follow(item: tuple[str, int]) -> Json:
    """Run one story; events are told with the drive they happened on, s."""
    state, hours, raised, confirmed = core.initial_state(DEFAULT), 0.0, [], False
    for number, scenario in enumerate(sessions_of(*item)):
        samples = simulate(scenario).samples
        state, outcome = core.advance(DEFAULT, core.begin_session(DEFAULT, state), samples)
        hours += scenario.seconds / 3600
        confirmed |= bool(of_kind(outcome.events, EventKind.CONFIRMED))
        for kind in (EventKind.ORIENTATION_CHANGED, EventKind.FAULT):
            raised += [[str(event.fault or kind), number, event.t] for event in of_kind(outcome.events, kind)]
    return {"seed": item[1], "hours": hours, "raised": raised, "confirmed": confirmed}


def measure(options: Options) -> Json:
    """Run the stories until the hours are full."""
    names = [*STORIES, *HARD]
    wanted, hours, items, seed = HOURS * options.drives / 100, 0.0, list[tuple[str, int]](), 5000
    while hours < wanted:
        items += [(name, seed) for name in names]
        hours += sum(scenario.seconds for name in names for scenario in sessions_of(name, seed)) / 3600
        seed += 1
    results = parallel.run("alarms", follow, items)
    return {name: [r for r, (n, _) in zip(results, items, strict=True) if n == name] for name in names}


def _counted(result: Json) -> list[Json]:
    return [run for name, runs in result.items() if name not in STORIES or STORIES[name].counted for run in runs]


def _raised(runs: list[Json], change: bool) -> int:
    kinds = [kind for run in runs for kind, _, _ in run["raised"]]
    return sum((kind == EventKind.ORIENTATION_CHANGED) == change for kind in kinds)


def targets(result: Json) -> list[Target]:
    """No false alarm, no false fault."""
    runs = _counted(result)
    hours = round(sum(run["hours"] for run in runs))
    return [
        none_of("false orientation changes", _raised(runs, True), hours, "h"),
        none_of("false faults", _raised(runs, False), hours, "h"),
    ]


def text(result: Json) -> str:
    """Table."""
    rows = []
    for name, runs in result.items():
        confirmed = sum(run["confirmed"] for run in runs)
        counts = [str(_raised(runs, change)) for change in (True, False)]
        rows.append([name, f"{sum(run['hours'] for run in runs):.1f}", f"{confirmed} of {len(runs)}", *counts])
    return f"""## False alarms

Drives of half an hour, and chains of drives with the device switched off between them, on which nobody touches the
device. A night is six hours parked while the temperature changes the biases. A car lifted by a tow truck after its
device was confirmed does look like a device that was tilted: shown, and not counted.

{table(["", "hours", "confirmed", "orientation changes", "faults"], rows)}

{_found(result)}"""


def _found(result: Json) -> str:
    """Say which drives of `alarms.sessions_of(name, seed)` to look at."""
    lines = [
        f"- {name}, seed {run['seed']}: {kind} on drive {number + 1} after {t:.0f} s"
        for name, runs in result.items()
        for run in runs
        for kind, number, t in run["raised"]
    ]
    more = [f"- and {len(lines) - LISTED} more"] if len(lines) > LISTED else []
    return "\n".join(["What was raised:", "", *lines[:LISTED], *more]) if lines else "Nothing was raised."
