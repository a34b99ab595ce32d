"""`clock_fault`: the device's clock runs back, stands still, or is faster than the time of day.

A chunk may come late, by any time, so one that arrives later than its clock says is innocent; data cannot arrive
before they were taken, so a clock that gets ahead of the time of day is not. Data that were kept while there was no
network look like a fast clock while they are sent. So a clock is believed to agree with the time of day only after a
window of time in which both have gone equally fast, and is ahead only relative to that; a clock that was never seen to
agree is called fast when its rate is the same window after window and slower than kept data are usually sent.
"""

from collections.abc import Sequence
from typing import NamedTuple

from api.services.rules.limits import Limits
from api.services.rules.seen import Over, Rule, Seen, Verdict, finding
from storage.models import microseconds

KIND = "clock_fault"
REMEDY = (
    "Within a session its clock must run evenly and never be set: update the device's software, "
    "switch it off and on, and replace it if this comes back."
)


class Fault(NamedTuple):
    """Something wrong with a clock."""

    sentence: str
    measured: tuple[float, float, str]


class Memory(NamedTuple):
    """What is remembered; arrivals in s since 1970."""

    session: int = 0
    t: float = 0.0
    """s, newest time of the session"""
    window_t: float = 0.0
    window_r: float = 0.0
    """time and arrival at which the window began"""
    least: float = 0.0
    """s since 1970, least zero of the clock that a chunk of the window has shown"""
    agreed: float | None = None
    """s since 1970, the zero of a clock that has agreed with the time of day"""
    rates: Sequence[float] = ()
    """of the last windows, while they are too fast and the same"""
    sound: float = 0.0
    """s of data without anything wrong"""
    told: bool = False


def step(memory: Memory, seen: Seen, limits: Limits) -> tuple[Memory, Verdict]:
    """Compare the clock with itself and with the arrivals."""
    fault = _back(memory, seen, limits) or _standing(seen, limits)
    memory, ahead = _follow(memory, seen, limits)
    fault = fault or ahead
    if fault is not None:
        return _judge(memory, seen, limits, fault)
    if not _is_sound(memory, seen, limits) or not memory.told:
        return memory, None
    memory = memory._replace(sound=memory.sound + seen.span)
    if memory.sound < limits.clock_sound:
        return memory, None
    return memory._replace(sound=0.0, told=False), Over("The clock has been right for an hour of data.")


def _judge(memory: Memory, seen: Seen, limits: Limits, fault: Fault) -> tuple[Memory, Verdict]:
    """Raise an alert, unless this is the same episode still."""
    goes_on = memory.told and memory.sound < limits.clock_episode
    memory = memory._replace(sound=0.0, told=True)
    if goes_on:
        return memory, None
    since = seen.moment(seen.t_first)
    return memory, finding(KIND, seen, f"{fault.sentence} {REMEDY}", fault.measured, since, fault.sentence)


def _back(memory: Memory, seen: Seen, limits: Limits) -> Fault | None:
    back = memory.t - seen.t_first
    if seen.session_pk != memory.session or not seen.back or back < limits.clock_back:
        return None
    sentence = f"The device's clock has run back by {back:.0f} s, and data are not used until it has caught up."
    return Fault(sentence, (back, limits.clock_back, "s"))


def _standing(seen: Seen, limits: Limits) -> Fault | None:
    share = seen.repeated / max(seen.samples, 1)
    if share < limits.clock_standing:
        return None
    return Fault("The device's clock stands still.", (share, limits.clock_standing, "share of samples"))


def _follow(memory: Memory, seen: Seen, limits: Limits) -> tuple[Memory, Fault | None]:
    """Compare the time since the window began with the time of day, and both with what has agreed."""
    arrival = microseconds(seen.received_at) * 1e-6
    zero = arrival - seen.t_last
    if seen.session_pk != memory.session:
        fresh = Memory(seen.session_pk, seen.t_last, seen.t_last, arrival, zero)
        return fresh._replace(sound=memory.sound, told=memory.told), None
    if seen.t_last <= memory.t:
        return memory, None
    memory = memory._replace(t=seen.t_last, least=min(memory.least, zero))
    if memory.agreed is not None and memory.agreed - zero > limits.clock_ahead:
        return _begin(memory, seen.t_last, arrival)._replace(agreed=zero), _ahead(memory.agreed - zero, limits)
    if arrival - memory.window_r < limits.clock_window:
        return memory, None
    rate = (seen.t_last - memory.window_t) / (arrival - memory.window_r)
    return _measured(memory, rate, zero, limits, seen.t_last, arrival)


def _measured(
    memory: Memory, rate: float, zero: float, limits: Limits, t: float, arrival: float
) -> tuple[Memory, Fault | None]:
    """Judge the rate of a window, and begin the next one."""
    after = _begin(memory, t, arrival)
    if abs(rate - 1) <= limits.clock_rate:
        return after._replace(agreed=memory.least if memory.agreed is None else memory.agreed, rates=()), None
    late = memory.agreed is not None and zero - memory.agreed > limits.clock_late
    if late or not 0 < rate - 1 <= limits.clock_backlog_rate:
        return after._replace(rates=()), None
    alike = [other for other in memory.rates if abs(other - rate) <= limits.clock_steady]
    rates = [*alike, rate][-limits.clock_windows :]
    return after._replace(rates=rates), _fast(rate, limits) if len(rates) == limits.clock_windows else None


def _begin(memory: Memory, t: float, arrival: float) -> Memory:
    return memory._replace(window_t=t, window_r=arrival, least=arrival - t)


def _ahead(ahead: float, limits: Limits) -> Fault:
    sentence = f"The device's clock has got {ahead:.0f} s ahead of the time of day: it jumped, or it is fast."
    return Fault(sentence, (ahead, limits.clock_ahead, "s"))


def _fast(rate: float, limits: Limits) -> Fault:
    percent = 100 * (rate - 1)
    sentence = f"The device's clock is fast by {percent:.0f} per cent."
    return Fault(sentence, (percent, 100 * limits.clock_rate, "per cent"))


def _is_sound(memory: Memory, seen: Seen, limits: Limits) -> bool:
    """Tell whether nothing at all speaks against the clock."""
    if memory.rates:
        return False
    ahead = 0.0 if memory.agreed is None else memory.agreed - (microseconds(seen.received_at) * 1e-6 - seen.t_last)
    return ahead <= limits.clock_agrees


RULE = Rule(KIND, Memory(), step, of_mounting=False, open=Memory(told=True))
