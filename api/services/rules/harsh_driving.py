"""`harsh_driving`: much harsh braking, acceleration and cornering within a short time of driving."""

from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

from api.services.rules.limits import MINUTE, Limits
from api.services.rules.seen import Over, Rule, Seen, Verdict, finding
from core.motion.events import EventKind, MotionEvent

KIND = "harsh_driving"
WORDS = {
    EventKind.HARSH_BRAKING: "braking",
    EventKind.HARSH_ACCELERATION: "acceleration",
    EventKind.HARSH_CORNERING: "cornering",
}


class Memory(NamedTuple):
    """What is remembered."""

    driving: float = 0.0
    """s, since the first of those that count"""
    recent: Sequence[tuple[float, str, str | None]] = ()
    """those that count: s of `driving`, kind, time as RFC 3339"""
    quiet: float = 0.0
    """s of data since the last one"""
    told: bool = False


def step(memory: Memory, seen: Seen, limits: Limits) -> tuple[Memory, Verdict]:
    """Count what happened within the window; raise at the threshold, and begin to count anew; quiet data end it."""
    harsh = [event for event in seen.happened if event.kind in WORDS]
    if not harsh:
        return _quiet(memory, seen, limits)
    verdict: Verdict = None
    recent = list(memory.recent)
    for event in harsh:
        at = memory.driving + seen.driving * _share(event, seen)
        recent = [other for other in recent if other[0] > at - limits.harsh_window]
        recent.append((at, str(event.kind), seen.moment(event.t)))
        if len(recent) >= limits.harsh_events:
            verdict, recent = _finding(recent, seen, limits), []
    told = memory.told or verdict is not None
    return _counted(memory.driving + seen.driving, recent, limits)._replace(told=told), verdict


def _quiet(memory: Memory, seen: Seen, limits: Limits) -> tuple[Memory, Verdict]:
    counted = _counted(memory.driving + seen.driving, memory.recent, limits)
    quiet = memory.quiet + seen.span if memory.told else 0.0
    if not memory.told or quiet < limits.harsh_quiet:
        return counted._replace(quiet=quiet, told=memory.told), None
    return counted, Over(f"No harsh driving in {quiet / MINUTE:.0f} minutes of data.")


def _counted(driving: float, recent: Sequence[tuple[float, str, str | None]], limits: Limits) -> Memory:
    """Give the memory of those still within the window, counted from the first of them."""
    kept = [other for other in recent if other[0] > driving - limits.harsh_window]
    if not kept:
        return Memory()
    first = kept[0][0]
    return Memory(driving - first, [(at - first, kind, moment) for at, kind, moment in kept])


def _share(event: MotionEvent, seen: Seen) -> float:
    """Tell where in the chunk an event was, from 0 to 1."""
    length = seen.t_last - seen.t_first
    return min(max((event.t - seen.t_first) / length, 0.0), 1.0) if length > 0 else 1.0


def _finding(recent: Sequence[tuple[float, str, str | None]], seen: Seen, limits: Limits) -> Verdict:
    counts = Counter(WORDS[EventKind(kind)] for _, kind, _ in recent)
    told = ", ".join(f"{word} {counts[word]}" for word in WORDS.values() if counts[word])
    message = (
        f"Harsh driving: {len(recent)} events within {limits.harsh_window / MINUTE:.0f} minutes of driving ({told}). "
        "Talk to the driver; look at the events of the device."
    )
    measured = (float(len(recent)), float(limits.harsh_events), "events")
    return finding(KIND, seen, message, measured, recent[0][2], severity="info")


RULE = Rule(KIND, Memory(), step, of_mounting=False, open=Memory(told=True))
