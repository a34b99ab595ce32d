"""The rules of the alerts: each a pure step over the chunks of a device, in the order in which they take effect.

A rule remembers a NamedTuple of JSON values, stored with the installation. What it remembers depends on the chunks and
on nothing else, so that the same chunks in the same order give the same memory and the same alerts.
"""

from collections.abc import Sequence
from typing import Any

from api.services.rules import (
    calibration_stalled,
    clock_fault,
    device_loose,
    device_silent,
    gps_lost,
    harsh_driving,
    sensor_fault,
    verification_failing,
)
from api.services.rules.limits import Limits
from api.services.rules.seen import Rule, Seen, Verdict, see
from storage.alerts import Finding

__all__ = ["OF_MOUNTING", "RULES", "Finding", "Limits", "Seen", "Verdict", "Watch", "forget", "opened", "see", "step"]

RULES: tuple[Rule, ...] = (
    calibration_stalled.RULE,
    verification_failing.RULE,
    gps_lost.RULE,
    device_loose.RULE,
    sensor_fault.RULE,
    device_silent.RULE,
    clock_fault.RULE,
    harsh_driving.RULE,
)
OF_MOUNTING = ("orientation_changed", *(rule.kind for rule in RULES if rule.of_mounting))
"""Kinds of alerts that a deliberate refit ends."""

Watch = dict[str, dict[str, Any]]
"""What the rules remember, by kind; a rule that has nothing to remember is not in it."""


def step(watch: Watch, seen: Seen, limits: Limits) -> tuple[Watch, list[tuple[str, Verdict]]]:
    """Let every rule see a chunk; give what they remember then, and what they say."""
    after: Watch = {}
    said: list[tuple[str, Verdict]] = []
    for rule in RULES:
        memory, verdict = rule.step(_recall(rule, watch.get(rule.kind)), seen, limits)
        if memory != rule.begin:
            after[rule.kind] = memory._asdict()
        if verdict is not None:
            said.append((rule.kind, verdict))
    return after, said


def opened(watch: Watch, kinds: Sequence[str]) -> Watch:
    """Let the rules know that alerts of these kinds are open."""
    return watch | {rule.kind: rule.open._asdict() for rule in RULES if rule.kind in kinds}


def forget(watch: Watch | None, kinds: Sequence[str]) -> Watch:
    """Let the rules of these kinds begin anew."""
    return {kind: memory for kind, memory in (watch or {}).items() if kind not in kinds}


def _recall(rule: Rule, stored: dict[str, Any] | None) -> Any:
    """Give a rule's memory; fields of another version are left out."""
    if not stored:
        return rule.begin
    return rule.begin._replace(**{name: stored[name] for name in rule.begin._fields if name in stored})
