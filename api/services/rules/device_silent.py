"""`device_silent`: raised by `watching.find_silent`; over when the device sends."""

from datetime import datetime, timedelta
from typing import NamedTuple

from api.services import findings
from api.services.rules.limits import HOUR, MINUTE, Limits
from api.services.rules.seen import Over, Rule, Seen, Verdict
from storage.alerts import Finding

KIND = "device_silent"
REMEDY = (
    "If the vehicle is in use, check that the device has power, that its network works, and that its key is valid. "
    "If the vehicle is laid up, resolve this alert: it comes back only after the device has sent again."
)


class Memory(NamedTuple):
    """What is remembered."""

    told: bool = False


def step(memory: Memory, seen: Seen, limits: Limits) -> tuple[Memory, Verdict]:
    """Any data end it: the threshold is so long that nothing flutters."""
    del seen, limits
    return Memory(), Over("The device sends again.") if memory.told else None


def finding(last_data_at: datetime, now: datetime, silent: timedelta) -> Finding:
    """Give the alert of a device that has fallen silent."""
    seconds = (now - last_data_at).total_seconds()
    known = {
        "at": findings.text(now),
        "since": findings.text(last_data_at),
        "seen": round(seconds / HOUR, 3),
        "threshold": silent.total_seconds() / HOUR,
        "unit": "h",
    }
    return Finding(KIND, "warning", f"The device has sent nothing for {_long(seconds)}. {REMEDY}", findings.data(known))


def _long(seconds: float) -> str:
    """Say a duration in the largest unit of which there are two."""
    for unit, name in ((24 * HOUR, "days"), (HOUR, "hours"), (MINUTE, "minutes")):
        if seconds >= 2 * unit:
            return f"{seconds / unit:.0f} {name}"
    return f"{seconds:.0f} seconds"


RULE = Rule(KIND, Memory(), step, of_mounting=False, open=Memory(told=True))
