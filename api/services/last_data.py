"""What a chunk was like, for whoever looks at the device: how often it measures, whether its receiver has a fix."""

import math
from typing import Any

import core
from api.formats.log import Reading


def describe(session: str, reading: Reading, outcome: core.Outcome) -> dict[str, Any]:
    """Sum up a chunk with at least one sample."""
    samples = reading.samples
    span = float(samples.t[-1] - samples.t[0])
    sample_rate, fix_rate = rates(outcome.samples, outcome.fixes, span)
    return {
        "session": session,
        "sample_rate_hz": sample_rate,
        "fix_rate_hz": fix_rate,
        "has_fix": bool(samples.fix_valid.size and samples.fix_valid[-1]),
        "speed_mps": round(outcome.speed, 2) if math.isfinite(outcome.speed) else None,
        "gyroscope": samples.has_rates,
        "span_s": round(span, 3),
        "rejected": rejected(reading, outcome),
    }


def rates(samples: int, fixes: int, span: float | None) -> tuple[float | None, float | None]:
    """Give samples and fixes a second; a sample stands for the time to the next, so that n of them span n - 1 steps."""
    if samples < 2 or span is None or span <= 0.0:
        return None, None
    rate = (samples - 1) / span
    return round(rate, 3), round(rate * fixes / samples, 3)


def rejected(reading: Reading, outcome: core.Outcome) -> dict[str, int]:
    """Count what was not used of a chunk, by reason: by its reader and by the estimator."""
    return {
        reason: reading.rejected.get(reason, 0) + outcome.rejected.get(reason, 0)
        for reason in reading.rejected | outcome.rejected
    }
