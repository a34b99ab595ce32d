"""Picture of the events study."""

from collections.abc import Mapping

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.figure import Figure
from numpy.typing import NDArray

from benchmarks.accuracy_study.figures import save

__all__ = ["impacts", "save"]

Floats = NDArray[np.float64]


def impacts(cases: Mapping[str, tuple[Floats, Floats, Floats]]) -> Figure:
    """Direction errors in order, deg, and velocity change told over true, m/s, of (error, true, told) per case."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.4))
    for name, (error, true, told) in cases.items():
        left.plot(np.sort(error), (np.arange(error.size) + 1) / error.size, label=name)
        right.plot(true, told, ".", ms=2, label=name)
    left.axvline(10, color="black", lw=0.7)
    left.set(xlim=(0, 20), xlabel="error of the direction, deg", ylabel="share of the impacts")
    right.plot([0, 20], [0, 20], color="black", lw=0.7)
    right.set(xlabel="true change of the velocity, m/s", ylabel="told, m/s")
    left.legend(fontsize=7)
    return figure
