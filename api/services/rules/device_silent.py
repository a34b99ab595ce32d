"""`device_silent`: raised by `watching.find_silent`; over when the device sends."""

from datetime import datetime, timedelta
from typing import NamedTuple

from api.services import findings
from api.services.rules.limits import HOUR, Limits
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
    hours = (now - last_data_at).total_seconds() / HOUR
    known = {
        "at": findings.text(now),
        "since": findings.text(last_data_at),
        "seen": round(hours, 3),
        "threshold": silent.total_seconds() / HOUR,
        "unit": "h",
    }
    return Finding(KIND, "warning", f"The device has sent nothing for {_long(hours)}. {REMEDY}", findings.data(known))


def _long(hours: float) -> str:
    return f"{hours / 24:.0f} days" if hours >= 48 else f"{hours:.0f} hours"


RULE = Rule(KIND, Memory(), step, of_mounting=False, open=Memory(told=True))
