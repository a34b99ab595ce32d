"""Routes of simulated drives: who drives where and how fast, before any mechanics.

A route is a function that adds one stretch (a block of a town, a bend of a mountain road) to an `Itinerary`; it is
called until the drive is long enough. Speeds in m/s, curvature positive to the left, angles in radians.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import pi, radians, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

LEFT, RIGHT = 1.0, -1.0


class Itinerary:
    """Speed and curvature over time, put together from simple manoeuvres."""

    def __init__(self, rng: np.random.Generator) -> None:
        self.rng = rng
        self.t = 0.0
        self.speed = 0.0
        self.knots = [(0.0, 0.0)]
        """(time, speed), linear between"""
        self.bends: list[tuple[float, float, float]] = []
        """(start, end, curvature 1/m)"""

    def uniform(self, low: float, high: float) -> float:
        """Draw a number."""
        return float(self.rng.uniform(low, high))

    def chance(self, probability: float) -> bool:
        """Toss a coin."""
        return bool(self.rng.random() < probability)

    def side(self) -> float:
        """Draw left or right."""
        return LEFT if self.chance(0.5) else RIGHT

    def hold(self, seconds: float) -> None:
        """Keep the speed."""
        self.t += seconds
        self.knots.append((self.t, self.speed))

    def reach(self, speed: float, rate: float | None = None) -> None:
        """Accelerate or brake to a speed, at `rate` m/s2 or as a driver happens to."""
        seconds = abs(speed - self.speed) / (rate or self.uniform(1.0, 2.4))
        self.speed = speed
        self.hold(seconds)

    def stop(self, seconds: float) -> None:
        """Brake to a standstill and wait."""
        self.reach(0.0)
        self.hold(seconds)

    def bend(self, angle: float, radius: float) -> None:
        """Turn by an angle (left positive) without changing speed."""
        seconds = abs(angle) * radius / abs(self.speed)
        self.bends.append((self.t, self.t + seconds, float(np.sign(angle)) / radius))
        self.hold(seconds)

    def turn(self, angle: float, radius: float, lateral: float) -> None:
        """Take a bend with at most `lateral` m/s2, at a speed changed for it if need be."""
        speed = sqrt(lateral * radius)
        if not 0.5 * speed <= self.speed <= speed:
            self.reach(speed)
        self.bend(angle, radius)

    def roundabout(self, exit_angle: float) -> None:
        """Enter to the right, go round to the left, leave to the right (right-hand traffic)."""
        radius = self.uniform(11, 18)
        self.turn(RIGHT * pi / 5, radius, self.uniform(1.6, 2.6))
        self.bend(LEFT * (exit_angle + 2 * pi / 5), radius)
        self.bend(RIGHT * pi / 5, 1.2 * radius)

    def lane_change(self) -> None:
        """Swerve one lane to a side and straighten up, in about four seconds."""
        side, radius = self.side(), max(self.speed**2 / self.uniform(0.5, 1.2), 20.0)
        angle = 2 * self.speed / radius
        self.bend(side * angle, radius)
        self.bend(-side * angle, radius)

    def back_up(self) -> None:
        """Reverse out of a parking space or into one, in an arc."""
        self.stop(self.uniform(2, 4))
        self.reach(-self.uniform(1.2, 2.2), 0.8)
        self.bend(self.side() * self.uniform(0.6, 1.4), self.uniform(6, 9))
        self.hold(self.uniform(0.5, 2))
        self.reach(0.0, 0.8)
        self.hold(self.uniform(2, 4))


def _city(plan: Itinerary) -> None:
    plan.reach(plan.uniform(8, 15))
    plan.hold(plan.uniform(3, 14))
    if plan.chance(0.35):
        plan.stop(plan.uniform(4, 35))
    what = plan.rng.random()
    if what < 0.60:
        plan.turn(plan.side() * plan.uniform(0.45, 0.55) * pi, plan.uniform(8, 18), plan.uniform(1.4, 3.0))
    elif what < 0.70:
        plan.roundabout(plan.uniform(-0.1, 0.6) * pi)
    elif plan.speed > 5:
        plan.lane_change()


def _hills(plan: Itinerary) -> None:
    plan.reach(plan.uniform(12, 20))
    plan.hold(plan.uniform(1, 8))
    for _ in range(plan.rng.integers(1, 4)):
        plan.turn(plan.side() * plan.uniform(0.3, 1.6), plan.uniform(30, 120), plan.uniform(1.2, 2.8))
    if plan.chance(0.15):
        plan.stop(plan.uniform(4, 20))


def _straight(plan: Itinerary) -> None:
    plan.reach(plan.uniform(10, 20))
    plan.hold(plan.uniform(8, 40))
    if plan.chance(0.6):
        plan.stop(plan.uniform(4, 30))


def _motorway(plan: Itinerary) -> None:
    plan.reach(plan.uniform(26, 36), plan.uniform(0.3, 1.2))
    plan.hold(plan.uniform(5, 40))
    if plan.chance(0.6):
        plan.bend(plan.side() * plan.uniform(0.1, 0.5), plan.uniform(900, 3000))
    else:
        plan.lane_change()


def _parked(plan: Itinerary) -> None:
    plan.hold(60.0)


def _roundabout(plan: Itinerary) -> None:
    if not plan.bends:
        plan.reach(plan.uniform(13, 16))
        plan.hold(plan.uniform(80, 100))
    plan.roundabout(plan.uniform(0.0, 0.5) * pi)
    plan.reach(plan.uniform(10, 15))
    plan.hold(plan.uniform(10, 30))


def _curves(plan: Itinerary) -> None:
    plan.reach(plan.uniform(7, 14))
    plan.hold(plan.uniform(0, 4))
    for _ in range(plan.rng.integers(2, 5)):
        plan.turn(plan.side() * plan.uniform(0.4, 1.8), plan.uniform(10, 40), plan.uniform(1.8, 3.2))


def _constant(plan: Itinerary) -> None:
    """Straight on at one speed, reached without haste."""
    if not plan.speed:
        plan.reach(plan.uniform(22, 33), plan.uniform(0.5, 1.0))
    plan.hold(60.0)


def _ferry(plan: Itinerary) -> None:
    if not plan.speed:
        plan.reach(plan.uniform(7, 9), 0.05)
    plan.hold(plan.uniform(30, 120))
    plan.bend(plan.side() * plan.uniform(0.1, 0.6), plan.uniform(500, 1500))


def _crawl(plan: Itinerary) -> None:
    """Walking pace, stop and go."""
    plan.reach(plan.uniform(0.8, 1.8), plan.uniform(0.3, 0.8))
    plan.hold(plan.uniform(3, 15))
    if plan.chance(0.3):
        plan.bend(plan.side() * plan.uniform(0.2, 1.5), plan.uniform(6, 15))
    if plan.chance(0.6):
        plan.reach(0.0, plan.uniform(0.3, 0.8))
        plan.hold(plan.uniform(2, 20))


def _harsh(plan: Itinerary) -> None:
    """One manoeuvre: braking, setting off or a bend; a third of them harsh."""
    harsh, what = plan.chance(1 / 3), plan.rng.random()
    plan.reach(plan.uniform(10, 20), plan.uniform(1.0, 2.2))
    plan.hold(plan.uniform(4, 12))
    if what < 0.35:
        plan.reach(plan.uniform(0, 4), plan.uniform(4.5, 9.0) if harsh else plan.uniform(1.2, 2.8))
        plan.hold(plan.uniform(3, 8))
    elif what < 0.65:
        plan.reach(plan.uniform(2, 5))
        plan.hold(plan.uniform(3, 6))
        plan.reach(plan.uniform(14, 20), plan.uniform(3.8, 5.5) if harsh else plan.uniform(1.0, 2.4))
        plan.hold(plan.uniform(3, 6))
    else:
        lateral = plan.uniform(5.0, 7.5) if harsh else plan.uniform(1.5, 3.2)
        plan.bend(plan.side() * plan.uniform(0.6, 1.6), plan.speed**2 / lateral)
        plan.hold(plan.uniform(3, 6))


class Road(NamedTuple):
    """What a kind of way does to the vehicle; slopes are smooth in the distance driven and level on average."""

    grade_rms: float
    """rise per run"""
    grade_limit: float
    """rise per run never exceeded"""
    bank_rms: float
    """rad"""
    roughness: float = 1.0
    """vibration relative to an ordinary town road"""
    unsteadiness: float = 0.03
    """share by which the speed wanders"""
    lifted: float = 0.0
    """rad the nose is held up, on a tow truck's lift"""
    swell: float = 0.0
    """rad rms of rolling and of pitching on a ship, where the vehicle stands at any angle to the course; 0 = on land"""

    def scaled(self, relief: float, vibration: float) -> "Road":
        """Give the road with other slopes and another roughness."""
        return self._replace(
            grade_rms=relief * self.grade_rms, bank_rms=relief * self.bank_rms, roughness=vibration * self.roughness
        )


@dataclass(frozen=True)
class Route:
    """How a kind of route is driven, and on what road."""

    stretch: Callable[[Itinerary], None]
    road: Road


_TOWN = Road(grade_rms=0.015, grade_limit=0.06, bank_rms=0.02)

ROUTES = {
    "city": Route(_city, _TOWN),
    "hills": Route(_hills, Road(grade_rms=0.06, grade_limit=0.12, bank_rms=0.03, roughness=1.2)),
    "straight": Route(_straight, _TOWN),
    "motorway": Route(_motorway, Road(grade_rms=0.012, grade_limit=0.05, bank_rms=0.02, roughness=0.6)),
    "parked": Route(_parked, _TOWN),
    "roundabout": Route(_roundabout, _TOWN),
    "curves": Route(_curves, _TOWN),
    "constant": Route(
        _constant, Road(grade_rms=0.008, grade_limit=0.04, bank_rms=0.02, roughness=0.6, unsteadiness=0.002)
    ),
    "steep": Route(_hills, Road(grade_rms=0.12, grade_limit=0.2, bank_rms=0.03, roughness=1.2)),
    "crawl": Route(_crawl, _TOWN),
    "harsh": Route(_harsh, _TOWN),
    "towed": Route(_city, _TOWN._replace(lifted=radians(8.0))),
    "ferry": Route(
        _ferry,
        Road(grade_rms=0.0, grade_limit=0.01, bank_rms=0.0, roughness=0.3, unsteadiness=0.002, swell=radians(1.5)),
    ),
}

REVERSE_EVERY = 150.0
"""s between reversing manoeuvres, where they are asked for."""


def plan_route(name: str, seconds: float, reverse: bool, rng: np.random.Generator) -> Itinerary:
    """Lay out a drive of at least `seconds`, standing still at first.

    Raises
    ------
    ValueError
        there is no route of this name.
    """
    if name not in ROUTES:
        raise ValueError(f"no route {name!r}; there are {', '.join(ROUTES)}")
    plan = Itinerary(rng)
    plan.hold(plan.uniform(2, 6))
    next_reverse = 0.0
    while plan.t < seconds:
        if reverse and plan.t >= next_reverse:
            plan.back_up()
            next_reverse = plan.t + REVERSE_EVERY
        ROUTES[name].stretch(plan)
    return plan


def sample_route(plan: Itinerary, t: Floats) -> tuple[Floats, Floats]:
    """Give speed m/s and curvature 1/m at the times `t`, as planned: with corners still."""
    times, speeds = np.array(plan.knots).T
    curvature = np.zeros(t.size)
    for start, end, value in plan.bends:
        first, last = np.searchsorted(t, (start, end))
        curvature[first:last] = value
    return np.interp(t, times, speeds), curvature
