"""What a sensor reads that lies still: means, variances, drift, and its noises from the Allan deviation (003 ch. 5).

Overlapping Allan deviation and how noises are read from it: IEEE Std 952-1997, annex C.
"""

from math import log, pi, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]

FEWEST = 100
"""readings"""
LONGEST_CLUSTER = 0.1
"""of the readings: longer ones are too few to mean"""
PER_DECADE = 12
"""cluster lengths"""
GAP = 1.5
"""intervals between readings"""
SLOPE_TOLERANCE = 0.15
"""of the slopes -1/2 and +1/2 in the logarithms"""
FLICKER = sqrt(2 * log(2) / pi)
"""lowest Allan deviation of flicker noise of unit size"""


class CharacteriseError(ValueError):
    """Readings that cannot be characterised."""


class AllanDeviation(NamedTuple):
    """Overlapping Allan deviation of D axes at K cluster times."""

    tau: Floats
    """(K,) s"""
    deviation: Floats
    """(K, D) in the unit of the readings"""


class Characteristics(NamedTuple):
    """Of a sensor with D axes that lay still; u is the unit of its readings."""

    seconds: float
    """s without a gap that were looked at"""
    rate: float
    """Hz"""
    mean: Floats
    """(D,) u"""
    variance: Floats
    """(D,) u^2"""
    drift: Floats
    """(D,) u/s, slope of the straight line through the readings"""
    noise_density: Floats
    """(D,) u sqrt(s), white noise: Allan deviation at 1 s on the slope -1/2; nan = there is no such slope"""
    bias_instability: Floats
    """(D,) u, lowest Allan deviation over 0.664; nan = it falls to the end, the log is too short"""
    random_walk: Floats
    """(D,) u/sqrt(s), of the bias: from the slope +1/2; nan = there is no such slope"""
    allan: AllanDeviation


def characterise(t: ArrayLike, readings: ArrayLike) -> Characteristics:
    """Characterise a sensor from readings (N, D) at the times t (N,), s, while it lay still.

    The longest part without gaps and missing readings counts.

    Raises
    ------
    CharacteriseError
        it is too short
    """
    t_, values = np.asarray(t, np.float64), np.asarray(readings, np.float64)
    t_, values = _longest_part(t_, values)
    if t_.size < FEWEST or t_[-1] <= t_[0]:
        raise CharacteriseError(f"{t_.size} readings without a gap, at least {FEWEST} are needed")
    step = float((t_[-1] - t_[0]) / (t_.size - 1))
    allan = allan_deviation(values, step)
    centred = t_ - t_.mean()
    return Characteristics(
        seconds=float(t_[-1] - t_[0]),
        rate=1 / step,
        mean=values.mean(axis=0),
        variance=values.var(axis=0, ddof=1),
        drift=centred @ (values - values.mean(axis=0)) / (centred @ centred),
        noise_density=_level_on_slope(allan, -0.5, 1.0),
        bias_instability=_flat(allan),
        random_walk=_level_on_slope(allan, 0.5, 3.0),
        allan=allan,
    )


def allan_deviation(values: Floats, step: float) -> AllanDeviation:
    """Give the overlapping Allan deviation of readings (N, D) every `step` s."""
    n = values.shape[0]
    longest = max(int(n * LONGEST_CLUSTER), 1)
    count = int(PER_DECADE * np.log10(longest)) + 1
    lengths = np.unique(np.round(np.geomspace(1, longest, count)).astype(int))
    angle = np.concatenate([np.zeros((1, values.shape[1])), np.cumsum(values - values.mean(axis=0), axis=0)]) * step
    deviation = np.empty((lengths.size, values.shape[1]))
    for k, m in enumerate(lengths):
        change = angle[2 * m :] - 2 * angle[m:-m] + angle[: -2 * m]
        deviation[k] = np.sqrt(np.mean(change**2, axis=0) / 2) / (m * step)
    return AllanDeviation(lengths * step, deviation)


def _longest_part(t: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Cut at gaps and missing readings and give the longest part."""
    there = np.isfinite(values).all(axis=1)
    t, values, number = t[there], values[there], np.flatnonzero(there)
    if t.size < 2:
        return t, values
    interval = np.diff(t)
    broken = (interval > GAP * np.median(interval)) | (np.diff(number) > 1)
    bounds = np.concatenate([[0], np.flatnonzero(broken) + 1, [t.size]])
    longest = int(np.argmax(np.diff(bounds)))
    part = slice(int(bounds[longest]), int(bounds[longest + 1]))
    return t[part], values[part]


def _level_on_slope(allan: AllanDeviation, slope: float, at: float) -> Floats:
    """Where the deviation has this slope, the value at the time `at` of the line through it, per axis."""
    log_tau = np.log(allan.tau)
    level = np.full(allan.deviation.shape[1], np.nan)
    for axis, deviation in enumerate(allan.deviation.T):
        if not (deviation > 0).all() or log_tau.size < 3:
            continue
        on_slope = np.abs(np.gradient(np.log(deviation), log_tau) - slope) < SLOPE_TOLERANCE
        if on_slope.any():
            level[axis] = np.exp(np.median((np.log(deviation) - slope * (log_tau - np.log(at)))[on_slope]))
    return level


def _flat(allan: AllanDeviation) -> Floats:
    """Lowest deviation as flicker noise, per axis."""
    lowest = allan.deviation.argmin(axis=0)
    value = allan.deviation.min(axis=0) / FLICKER
    return np.where(lowest < allan.tau.size - 1, value, np.nan)
