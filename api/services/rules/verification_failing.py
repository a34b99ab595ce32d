"""`verification_failing`: one drive test after the other fails."""

from typing import NamedTuple

from api.services.rules.limits import Limits
from api.services.rules.seen import Over, Rule, Seen, Verdict, finding
from core import Event, EventKind

KIND = "verification_failing"
REMEDY = (
    "Check that the device is firmly fastened and does not swing, and that its antenna sees the sky; "
    "then drive on, or refit the device and restart the calibration."
)
PASSED = (EventKind.VERIFICATION_PASSED, EventKind.CONFIRMED)


class Memory(NamedTuple):
    """What is remembered."""

    failed: int = 0
    """tests in a row"""
    since: str | None = None
    told: bool = False


def step(memory: Memory, seen: Seen, limits: Limits) -> tuple[Memory, Verdict]:
    """Count failed tests; raise at the threshold and at each further one; a passed test ends it."""
    failures: list[Event] = []
    told, passed = memory.told, False
    for event in seen.events:
        if event.kind in PASSED:
            memory, failures, passed = Memory(), [], True
        elif event.kind is EventKind.VERIFICATION_FAILED:
            failures.append(event)
            memory = memory._replace(failed=memory.failed + 1, since=memory.since or seen.moment(event.t))
    if failures and memory.failed >= limits.failed_tests:
        return memory._replace(told=True), _finding(memory, seen, limits, failures[-1].reason)
    return memory, Over("A drive test was passed.") if told and passed else None


def _finding(memory: Memory, seen: Seen, limits: Limits, reason: str | None) -> Verdict:
    why = f" The last one because {reason}." if reason else ""
    message = f"{memory.failed} drive tests in a row have failed.{why} {REMEDY}"
    measured = (float(memory.failed), float(limits.failed_tests), "tests")
    return finding(KIND, seen, message, measured, memory.since, reason)


RULE = Rule(KIND, Memory(), step, of_mounting=True, open=Memory(told=True))
