"""Pictures of a reconstructed motion: trajectory, accelerations, sideslip, friction circle."""

from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from numpy.typing import NDArray

from core.motion import Motion

Floats = NDArray[np.float64]

GRAVITY = 9.80665


def draw(motion: Motion, path: Path) -> None:
    """Write a picture in the format its name ends in.

    Raises
    ------
    ValueError
        a format that is not known
    OSError
        the file cannot be written
    """
    mpl.use("Agg")
    with mpl.rc_context(
        {"font.size": 8, "lines.linewidth": 0.8, "axes.grid": True, "grid.alpha": 0.3, "savefig.dpi": 110}
    ):
        figure, axes = plt.subplots(2, 2, figsize=(10, 8))
        _trajectory(axes[0, 0], motion)
        _friction_circle(axes[0, 1], motion.a_v)
        _accelerations(axes[1, 0], motion)
        _sideslip(axes[1, 1], motion)
        figure.tight_layout()
        figure.savefig(path, metadata={"Software": None} if path.suffix == ".png" else None)
        plt.close(figure)


def _trajectory(axis: Axes, motion: Motion) -> None:
    east, north = motion.position_n[:, 0], motion.position_n[:, 1]
    axis.plot(east, north, label="with fixes")
    bridged = np.where(motion.dead_reckoned, north, np.nan)
    if np.isfinite(bridged).any():
        axis.plot(east, bridged, color="tab:red", lw=1.6, label="dead reckoned")
        axis.legend()
    axis.set(title="trajectory", xlabel="east, m", ylabel="north, m", aspect="equal", adjustable="datalim")


def _friction_circle(axis: Axes, a_v: Floats) -> None:
    axis.plot(a_v[:, 1] / GRAVITY, a_v[:, 0] / GRAVITY, ".", ms=1.5, alpha=0.4)
    angle = np.linspace(0, 2 * np.pi, 100)
    for radius in (0.5, 1.0):
        axis.plot(radius * np.sin(angle), radius * np.cos(angle), color="grey", lw=0.6)
    axis.set(title="friction circle", xlabel="lateral, g (left positive)", ylabel="longitudinal, g", aspect="equal")
    axis.invert_xaxis()


def _accelerations(axis: Axes, motion: Motion) -> None:
    for column, name, colour in (
        (2, "vertical", "lightgrey"),
        (1, "lateral", "tab:orange"),
        (0, "longitudinal", "tab:blue"),
    ):
        axis.plot(motion.t, motion.a_v[:, column], label=name, color=colour, alpha=0.8)
    axis.set(title="acceleration", xlabel="s", ylabel="m/s²")
    axis.legend(loc="upper right")


def _sideslip(axis: Axes, motion: Motion) -> None:
    forward = motion.velocity_v[:, 0] > 0
    slip = np.where(forward, np.degrees(motion.sideslip), np.nan)
    sigma = np.degrees(motion.sideslip_sigma)
    axis.fill_between(motion.t, slip - sigma, slip + sigma, alpha=0.25, lw=0)
    axis.plot(motion.t, slip)
    most = 1.3 * max(1.0, float(np.nanmax(np.abs(slip), initial=0.0)))
    axis.set(title="sideslip and its 1 σ", xlabel="s", ylabel="degrees (left positive)", ylim=(-most, most))
