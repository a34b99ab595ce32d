"""What is driven to try the events: crashes, hours in which nothing happens but jolts, manoeuvres, devices in hand."""

from dataclasses import replace
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from core import quaternion
from core.motion.events import DEFAULT, EventKind, MotionEvent, advance, initial_state
from core.samples import Samples
from core.simulation import Drive, Scenario, simulate
from core.simulation_events import Crash, clipped, crash, draw_crash, manoeuvres
from core.simulation_jolts import AT_REST, ON_THE_ROAD, Jolt, add, emergency_braking, fall, handle
from core.simulation_motion import GRAVITY

Floats = NDArray[np.float64]
Json = dict[str, Any]

MOUNTING_ERROR = np.radians(1.0)
"""rad per axis, 1 sigma, of the mounting events are told with"""
ROUTES = ("city", "hills", "motorway", "parked")
NEAR = 0.3
"""s within which an event belongs to what was done"""
HARSH = {
    EventKind.HARSH_BRAKING: DEFAULT.harsh_braking,
    EventKind.HARSH_ACCELERATION: DEFAULT.harsh_acceleration,
    EventKind.HARSH_CORNERING: DEFAULT.harsh_cornering,
}
SMOOTHED = 0.4
"""s over which true accelerations are averaged before they are called harsh"""
CLEARLY, NEARLY = 1.15, 0.85
"""Share of its threshold by which a manoeuvre is clearly harsh, and below which it clearly is not"""


class CrashCase(NamedTuple):
    """Crashes of a kind."""

    name: str
    rate: float = 200.0
    full_scale: float = 40.0
    """units of gravity"""
    braking: bool = False
    gyro: bool = True


CRASHES = (
    CrashCase("200 Hz, range 40 g"),
    CrashCase("200 Hz, range 16 g", full_scale=16.0),
    CrashCase("200 Hz, range 8 g", full_scale=8.0),
    CrashCase("no gyroscope, 16 g", full_scale=16.0, gyro=False),
    CrashCase("while braking hard, 16 g", full_scale=16.0, braking=True),
    CrashCase("50 Hz, 16 g", rate=50.0, full_scale=16.0),
    CrashCase("100 Hz, 16 g", rate=100.0, full_scale=16.0),
    CrashCase("400 Hz, 16 g", rate=400.0, full_scale=16.0),
)


def told(samples: Samples, q_vs: Floats, rng: np.random.Generator) -> tuple[MotionEvent, ...]:
    """Give the events with a mounting that is about right."""
    error = quaternion.from_rotation_vector(MOUNTING_ERROR * rng.normal(size=3))
    return advance(DEFAULT, initial_state(), quaternion.multiply(error, q_vs), samples)[1]


@cache
def _base(route: str, seed: int, seconds: float, rate: float, vibration: float) -> Drive:
    return simulate(Scenario(route, seconds, seed, imu_rate=rate, vibration=vibration))


def _without_gyroscope(samples: Samples) -> Samples:
    return replace(samples, w_s=np.full_like(samples.w_s, np.nan))


def crashes(item: tuple[CrashCase, int, int]) -> list[Json]:
    """Crash so many times."""
    case, seed, count = item
    rng = np.random.default_rng([seed, int(case.rate), int(case.full_scale), case.braking, case.gyro])
    return [_one_crash(case, seed, rng) for _ in range(count)]


def _one_crash(case: CrashCase, seed: int, rng: np.random.Generator) -> Json:
    route = str(rng.choice(ROUTES[:3] if case.braking else ROUTES))
    drive, hit = _base(route, seed, 60.0, case.rate, 1.0), draw_crash(rng.uniform(20, 50), rng)
    if case.braking:
        jolt = (hit.t - rng.uniform(0.3, 1.0), emergency_braking(case.rate, rng))
        drive = drive._replace(samples=add(drive.samples, drive.truth.q_vs, [jolt]))
    samples = clipped(crash(drive, hit, rng), case.full_scale * GRAVITY)
    events = told(samples if case.gyro else _without_gyroscope(samples), drive.truth.q_vs, rng)
    impacts = [event for event in events if event.kind == EventKind.IMPACT]
    found = [event for event in impacts if abs(event.t - hit.t) < NEAR]
    return _compared(hit, found[0] if found else None) | {"others": len(impacts) - len(found)}


def _compared(hit: Crash, event: MotionEvent | None) -> Json:
    result: Json = {"velocity_change": float(np.hypot(*hit.velocity_change)), "peak": hit.peak, "found": bool(event)}
    if event is None:
        return result
    error = (event.direction - hit.direction + np.pi) % (2 * np.pi) - np.pi
    return result | {
        "direction_error": float(np.degrees(abs(error))),
        "peak_told": event.peak,
        "velocity_change_told": float(np.hypot(*event.velocity_change)),
        "duration_share": event.duration / hit.duration,
    }


class Roads(NamedTuple):
    """Hours of jolts on a route."""

    route: str
    vibration: float
    jolts: dict[str, Jolt]


ROADS = (
    Roads("city", 2.0, ON_THE_ROAD),
    Roads("hills", 3.5, ON_THE_ROAD),
    Roads("motorway", 1.5, ON_THE_ROAD),
    Roads("parked", 1.0, AT_REST),
)
STINT = 1200.0
"""s between two starts"""
REPEATS = 4
"""times a base drive is taken, with other jolts"""


def hours(item: tuple[Roads, int]) -> Json:
    """Drive `REPEATS` stints full of jolts; every other one without a gyroscope."""
    roads, seed = item
    rng = np.random.default_rng([seed, ROADS.index(roads)])
    drive = simulate(Scenario(roads.route, STINT, seed, vibration=roads.vibration))
    counts: dict[str, int] = {}
    impacts, potholes = list[Json](), dict[str, int]()
    for repeat in range(REPEATS):
        samples = drive.samples if repeat % 2 else _without_gyroscope(drive.samples)
        jolts = _draw_jolts(roads, rng)
        for name, _, _ in jolts:
            counts[name] = counts.get(name, 0) + 1
        laid = add(samples, drive.truth.q_vs, [(t, jolt) for _, t, jolt in jolts])
        for event in told(laid, drive.truth.q_vs, rng):
            near = sorted({name for name, t, jolt in jolts if t - NEAR < event.t < t + len(jolt) / 200 + NEAR})
            if event.kind == EventKind.IMPACT:
                impacts.append({"seed": seed, "t": event.t, "peak": event.peak, "near": near})
            if event.kind == EventKind.POTHOLE:
                for name in near or ["none of these"]:
                    potholes[name] = potholes.get(name, 0) + 1
    return {"hours": REPEATS * STINT / 3600, "jolts": counts, "impacts": impacts, "potholes": potholes}


def _draw_jolts(roads: Roads, rng: np.random.Generator) -> list[tuple[str, float, Floats]]:
    """About ten of each kind in a stint, at any time; one braking never falls into another."""
    drawn = list[tuple[str, float, Floats]]()
    for name, jolt in roads.jolts.items():
        count = int(rng.integers(5, 15))
        slots = STINT / count * (np.arange(count) + rng.uniform(0, 0.5, count))
        drawn += [(name, float(t), jolt(200.0, rng)) for t in slots]
    return drawn


def in_hand(item: tuple[str, int]) -> Json:
    """Take the device off or let it fall, on a short drive."""
    kind, seed = item
    rng = np.random.default_rng([seed, len(kind)])
    drive = _base(str(rng.choice(["city", "parked"])), seed // 20, 60.0, 200.0, 1.0)
    gyro = bool(seed % 2)
    samples = drive.samples if gyro else _without_gyroscope(drive.samples)
    samples = (fall if kind == "falls" else handle)(samples, rng.uniform(20, 40), rng)
    events = told(samples, drive.truth.q_vs, rng)
    return {"gyro": gyro, "impacts": sum(event.kind == EventKind.IMPACT for event in events)}


def harsh_driving(seed: int) -> Json:
    """Drive manoeuvres harsh and not; what lies between is neither asked for nor held against."""
    drive = manoeuvres(seed, 600.0, float([10, 50, 100, 200][seed % 4]), gyro=bool(seed % 2))
    events = advance(DEFAULT, initial_state(), drive.q_vs, drive.samples)[1]
    rate = 1 / (drive.t[1] - drive.t[0])
    window = np.ones(max(1, round(SMOOTHED * rate)))
    forward, left = (np.convolve(a, window / window.size, "same") for a in drive.a_v.T)
    signals = dict(zip(HARSH, (-forward, forward, np.abs(left)), strict=True))
    return {
        kind: _matched([e for e in events if e.kind == kind], signals[kind] / threshold, rate)
        for kind, threshold in HARSH.items()
    }


def _matched(events: list[MotionEvent], share: Floats, rate: float) -> Json:
    end = share.size / rate - 3.0
    clear = [span for span in _spans(share > CLEARLY, rate, 0.5) if span[1] < end]
    near = _spans(share > NEARLY, rate, 0.0)
    spans = [(e.start - NEAR, e.start + e.duration + NEAR) for e in events]
    return {
        "clear": len(clear),
        "found": sum(_meets(span, spans) for span in clear),
        "told": len(spans),
        "true": sum(_meets(span, near) for span in spans),
    }


def _spans(on: NDArray[np.bool_], rate: float, least: float) -> list[tuple[float, float]]:
    """Spans of time, s, in which `on` holds for at least `least` s."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], on, [False]]).astype(np.int8))).reshape(-1, 2) / rate
    return [(float(a), float(b)) for a, b in edges if b - a >= least]


def _meets(span: tuple[float, float], others: list[tuple[float, float]]) -> bool:
    return any(span[0] < b and a < span[1] for a, b in others)


ORDINARY = ("city", "hills", "motorway", "curves", "straight", "roundabout", "steep")


def ordinary(item: tuple[str, int]) -> Json:
    """Drive as people do; count what is told."""
    route, seed = item
    drive = simulate(Scenario(route, 1800.0, seed, imu_rate=50.0, gyro=bool(seed % 2)))
    events = told(drive.samples, drive.truth.q_vs, np.random.default_rng([seed, ORDINARY.index(route)]))
    metres = float(np.trapezoid(np.abs(drive.truth.speed), drive.truth.t))
    return {"metres": metres} | {kind.value: sum(e.kind == kind for e in events) for kind in EventKind}
