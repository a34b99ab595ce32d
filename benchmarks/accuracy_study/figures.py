"""Pictures of the accuracy study."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib import pyplot as plt
from matplotlib.figure import Figure
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Mark = tuple[float, tuple[float, float]]
"""s, (median, 95th percentile) wanted, deg"""

COLOURS = {"default": "tab:orange", "thesis": "tab:blue", "procrustes": "tab:green"}

mpl.use("Agg")
mpl.rcParams.update({"font.size": 8, "lines.linewidth": 1.0, "axes.grid": True, "grid.alpha": 0.3, "savefig.dpi": 90})


def save(figure: Figure, path: Path) -> None:
    """Write a picture without a date in it, so that the same data give the same file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.tight_layout()
    figure.savefig(path, metadata={"Software": None})
    plt.close(figure)


def over_time(times: Floats, panels: Mapping[str, Mapping[str, Floats]], marks: Mapping[str, Sequence[Mark]]) -> Figure:
    """Error over time: median of (drives, times), and the band from the 5th to the 95th percentile."""
    figure, axes = plt.subplots(4, 2, figsize=(9, 10), sharex=True, sharey=True)
    for axis, (name, estimators) in zip(axes.flat, panels.items(), strict=False):
        for estimator, angle in estimators.items():
            known = np.where(np.isnan(angle), 180.0, angle)
            low, middle, high = np.quantile(known, (0.05, 0.5, 0.95), axis=0)
            axis.semilogy(times, middle, color=COLOURS[estimator], label=estimator)
            axis.fill_between(times, low, high, color=COLOURS[estimator], alpha=0.15, lw=0)
        for t, wanted in marks[name]:
            axis.plot([t, t], wanted, "k_", ms=9)
        axis.set(title=name, ylim=(0.1, 200))
    axes[-1, 0].set_xlabel("s")
    axes[-1, -1].axis("off")
    axes[-1, -1].legend(*axes[0, 0].get_legend_handles_labels(), loc="center", title="black: targets")
    for axis in axes[:, 0]:
        axis.set_ylabel("total error, deg")
    return figure


def honesty(times: Floats, nees: Mapping[str, Floats], wanted: tuple[float, float]) -> Figure:
    """Mean normalised error over time."""
    figure, axis = plt.subplots(figsize=(9, 3.2))
    for name, values in nees.items():
        axis.semilogy(times, values, label=name)
    axis.axhspan(*wanted, color="grey", alpha=0.2, lw=0)
    axis.axhline(3, color="black", lw=0.7)
    axis.set(xlabel="s", ylabel="mean NEES")
    axis.legend(ncols=2, fontsize=7)
    return figure
