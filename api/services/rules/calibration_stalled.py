"""`calibration_stalled`: much driving, and still no confirmed mounting."""

from typing import NamedTuple

from api.services import presenting
from api.services.rules.limits import Limits
from api.services.rules.seen import Over, Rule, Seen, Verdict, finding
from core import Stage

KIND = "calibration_stalled"
REMEDY = "If that does not help, check that the device is firmly fastened and that its antenna sees the sky."


class Memory(NamedTuple):
    """What is remembered."""

    driving: float = 0.0
    """s without a confirmed mounting"""
    since: str | None = None
    told: int = 0
    """how often the threshold was reached"""


def step(memory: Memory, seen: Seen, limits: Limits) -> tuple[Memory, Verdict]:
    """Count the driving; raise at each multiple of the threshold; a confirmed mounting ends it."""
    if seen.stage is Stage.CONFIRMED:
        return Memory(), Over("The mounting was confirmed.") if memory.told else None
    driving = memory.driving + seen.driving
    since = memory.since or (seen.moment(seen.t_first) if seen.driving else None)
    reached = int(driving // limits.stalled_driving)
    if reached <= memory.told:
        return memory._replace(driving=driving, since=since), None
    measured = (driving, limits.stalled_driving, "s")
    hint = presenting.hint(seen.stage.word, seen.needs)
    message = f"Not confirmed after {driving / 60:.0f} minutes of driving. {hint} {REMEDY}"
    return Memory(driving, since, reached), finding(KIND, seen, message, measured, since, hint)


RULE = Rule(KIND, Memory(), step, of_mounting=True, open=Memory(told=1))
