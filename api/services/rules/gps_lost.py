"""`gps_lost`: data come, but no GPS fix for long."""

from typing import NamedTuple

from api.services.rules.limits import Limits
from api.services.rules.seen import Over, Rule, Seen, Verdict, finding

KIND = "gps_lost"
REMEDY = "Take the vehicle under open sky; if that does not help, check the antenna, its cable and its plug."


class Memory(NamedTuple):
    """What is remembered."""

    without: float = 0.0
    """s of data without a fix"""
    sustained: float = 0.0
    """s of data with fixes since"""
    since: str | None = None
    told: bool = False


def step(memory: Memory, seen: Seen, limits: Limits) -> tuple[Memory, Verdict]:
    """Count the data without a fix; only fixes that last end it, a single one changes nothing."""
    if seen.span == 0:
        return memory, None
    if seen.with_fix >= limits.fix_share * seen.span:
        return _fixed(memory, seen, limits)
    since = memory.since or seen.moment(seen.t_first)
    memory = Memory(memory.without + seen.span, 0.0, since, memory.told)
    if memory.told or memory.without < limits.without_fix:
        return memory, None
    message = f"Data have come for {memory.without / 60:.0f} minutes without a GPS fix. {REMEDY}"
    measured = (memory.without, limits.without_fix, "s")
    return memory._replace(told=True), finding(KIND, seen, message, measured, since)


def _fixed(memory: Memory, seen: Seen, limits: Limits) -> tuple[Memory, Verdict]:
    sustained = memory.sustained + seen.span
    if not (memory.told or memory.without) or sustained >= limits.fix_sustained:
        return Memory(), Over("GPS fixes come again.") if memory.told else None
    return memory._replace(sustained=sustained), None


RULE = Rule(KIND, Memory(), step, of_mounting=False, open=Memory(told=True))
