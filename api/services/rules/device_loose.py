"""`device_loose`: raised by the estimator; over when a confirmed mounting has held for a while."""

from typing import NamedTuple

from api.services.rules.limits import Limits
from api.services.rules.seen import Over, Rule, Seen, Verdict
from core import Fault, Stage

KIND = "device_loose"


class Memory(NamedTuple):
    """What is remembered."""

    told: bool = False
    held: float = 0.0
    """s of driving for which a confirmed mounting has held"""


def step(memory: Memory, seen: Seen, limits: Limits) -> tuple[Memory, Verdict]:
    """Count how long a confirmed mounting holds: confirmed once is not enough, a loose device often is."""
    if any(event.fault is Fault.DEVICE_LOOSE for event in seen.events):
        return Memory(told=True), None
    if not memory.told:
        return memory, None
    held = memory.held + seen.driving if seen.stage is Stage.CONFIRMED else 0.0
    if held < limits.held_driving:
        return memory._replace(held=held), None
    return Memory(), Over(f"A confirmed mounting has held for {held / 60:.0f} minutes of driving.")


RULE = Rule(KIND, Memory(), step, of_mounting=True, open=Memory(told=True))
