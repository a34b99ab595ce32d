"""`sensor_fault`: raised by the estimator; over when the readings have been right for a while."""

from typing import NamedTuple

from api.services.rules.limits import Limits
from api.services.rules.seen import Over, Rule, Seen, Verdict
from core import EventKind, Fault

KIND = "sensor_fault"


class Memory(NamedTuple):
    """What is remembered."""

    told: bool = False
    sound: float = 0.0
    """s of driving without a fault"""


def step(memory: Memory, seen: Seen, limits: Limits) -> tuple[Memory, Verdict]:
    """Count the driving without a fault: the faults show in motion only."""
    found = any(event.kind is EventKind.FAULT and event.fault is not Fault.DEVICE_LOOSE for event in seen.events)
    if found or (memory.told and set(seen.faults) - {Fault.DEVICE_LOOSE}):
        return Memory(told=True), None
    if not memory.told:
        return memory, None
    sound = memory.sound + seen.driving
    if sound < limits.sound_driving:
        return memory._replace(sound=sound), None
    return Memory(), Over(f"The sensor's readings have been right for {sound / 60:.0f} minutes of driving.")


RULE = Rule(KIND, Memory(), step, of_mounting=True, open=Memory(told=True))
