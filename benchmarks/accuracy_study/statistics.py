"""Statistics of many drives, targets, and how both are written."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]

REGION = 14.156
"""99.73 % of a chi-square with three degrees of freedom lies below: the three-sigma region of a rotation"""


class Target(NamedTuple):
    """What was wanted and what came out."""

    what: str
    wanted: str
    measured: str
    met: bool | None
    """None = nothing was measured"""


def quantile(values: Sequence[float | None] | Floats, share: float) -> float:
    """Give the value that this share of drives does not exceed.

    Parameters
    ----------
    values
        (N,) one per drive; nan or None = nothing came out of it, which counts as infinitely bad
    share
        0..1

    Returns
    -------
    float
        one of the values, rounding up in rank; nan when there are none
    """
    numbers = np.asarray(values, np.float64).ravel()
    if not numbers.size:
        return math.nan
    return float(np.quantile(np.where(np.isnan(numbers), np.inf, numbers), share, method="higher"))


def share_of(hits: ArrayLike) -> float:
    """Give the share of True, nan of nothing."""
    flags = np.asarray(hits, np.bool_)
    return float(flags.mean()) if flags.size else math.nan


def at_most(what: str, measured: Sequence[float], limits: Sequence[float], unit: str = "") -> Target:
    """Make a target of figures none of which may exceed its limit."""
    met = all(value <= limit for value, limit in zip(measured, limits, strict=True))
    return Target(what, f"≤ {_joined(limits, unit)}", _joined(measured, unit), None if _nothing(measured) else met)


def at_least(what: str, measured: float, limit: float) -> Target:
    """Make a target of a share that may not be below its limit."""
    wanted = f"≥ {percent(limit)}"
    return Target(what, wanted, percent(measured), None if math.isnan(measured) else measured >= limit)


def within(what: str, measured: Sequence[float], low: float, high: float) -> Target:
    """Make a target of figures that all lie in a range."""
    met = all(low <= value <= high for value in measured)
    return Target(what, f"{low:g} to {high:g}", _joined(measured, ""), None if _nothing(measured) else met)


def none_of(what: str, count: int, total: int, of: str) -> Target:
    """Make a target of something that must never happen."""
    return Target(what, "0", f"{count} in {total} {of}", None if not total else count == 0)


def number(value: float) -> str:
    """Write a figure: three digits, or what it is when it is none."""
    if math.isnan(value):
        return "–"
    if math.isinf(value):
        return "none"
    return f"{value:.0f}" if abs(value) >= 100 else f"{value:.1f}" if abs(value) >= 10 else f"{value:.2f}"


def percent(share: float) -> str:
    """Write a share; 100 % means all."""
    if math.isnan(share):
        return "–"
    return "100 %" if share == 1 else f"{min(100 * share, 99.9):.1f} %"


def spread(values: Sequence[float | None] | Floats, high: float = 0.95) -> str:
    """Write median and upper quantile."""
    return f"{number(quantile(values, 0.5))} / {number(quantile(values, high))}"


def table(columns: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Markdown table, figures to the right of their names."""
    lines = [columns, ["---", *["--:"] * (len(columns) - 1)], *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def target_table(targets: Sequence[Target]) -> str:
    """Markdown table of targets, measured figures, and whether they were met."""
    words = {True: "met", False: "**not met**", None: "not measured"}
    rows = [[target.what, target.wanted, target.measured, words[target.met]] for target in targets]
    return table(["", "target", "measured", ""], rows)


def _joined(values: Sequence[float], unit: str) -> str:
    return " / ".join(number(value) for value in values) + (unit if all(map(math.isfinite, values)) else "")


def _nothing(values: Sequence[float]) -> bool:
    return any(math.isnan(value) for value in values)
