"""The thesis' figures, drawn from runs on simulated drives."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from benchmarks.reproduction.runs import STATES, Trace
from core import quaternion
from core.samples import COURSE, LATITUDE, LONGITUDE
from core.simulation import Drive

Floats = NDArray[np.float64]
COLOURS = {"thesis": "tab:blue", "default": "tab:orange"}
EARTH_RADIUS = 6.371e6

mpl.use("Agg")
mpl.rcParams.update({"font.size": 8, "lines.linewidth": 0.9, "axes.grid": True, "grid.alpha": 0.3, "savefig.dpi": 90})


def save(figure: Figure, path: Path) -> None:
    """Write a picture without a date in it, so that the same data give the same file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.tight_layout()
    figure.savefig(path, metadata={"Software": None})
    plt.close(figure)


def observability(cases: Mapping[str, tuple[Drive, Mapping[str, Trace]]]) -> Figure:
    """Figures 5.3, 5.5 and 5.6: normalised eigenvalue, course and forward acceleration; and the stated sigma."""
    figure, axes = plt.subplots(4, len(cases), figsize=(9, 6.5), sharex="col", squeeze=False)
    for column, (name, (drive, traces)) in zip(axes.T, cases.items(), strict=True):
        column[0].plot(traces["thesis"].t, traces["thesis"].eigenvalue, color=COLOURS["thesis"])
        column[0].axhline(STATES, color="tab:red", ls="--")
        column[0].set(title=name, ylim=(0, STATES + 0.5))
        for preset, trace in traces.items():
            column[1].semilogy(trace.t, trace.sigma, color=COLOURS[preset], label=preset)
        column[1].set(ylim=(0.1, 200))
        column[2].plot(drive.truth.t, np.degrees(drive.samples.fix[:, COURSE]), ".", ms=1.5)
        column[3].plot(*_forward(drive))
        column[3].set(xlabel="s")
    axes[1, 0].legend(loc="lower right")
    labels = ("eigenvalue (5.3)", "sigma of mounting, deg", "course, deg", "forward, m/s²")
    for axis, label in zip(axes[:, 0], labels, strict=True):
        axis.set_ylabel(label)
    return figure


def _forward(drive: Drive) -> tuple[Floats, Floats]:
    """Forward specific force averaged over a quarter of a second."""
    f_x = drive.samples.f_s @ quaternion.matrix(drive.truth.q_vs)[0]
    size = f_x.size // 50 * 50
    return drive.samples.t[:size:50], f_x[:size].reshape(-1, 50).mean(axis=1)


def components(cases: Mapping[str, tuple[Drive, Mapping[str, Trace]]]) -> Figure:
    """Figures 5.8 to 5.10 and 5.12: components of the estimate towards q (red) or -q (green)."""
    figure, axes = plt.subplots(4, len(cases), figsize=(9, 5.5), sharex="col", sharey=True, squeeze=False)
    for column, (name, (drive, traces)) in zip(axes.T, cases.items(), strict=True):
        column[0].set_title(name)
        for i, axis in enumerate(column):
            for preset, trace in traces.items():
                axis.plot(trace.t, continuous(trace.q_vs)[:, i], color=COLOURS[preset], label=preset)
            axis.axhline(drive.truth.q_vs[i], color="tab:red", ls=":")
            axis.axhline(-drive.truth.q_vs[i], color="tab:green", ls=":")
        column[-1].set(xlabel="s", ylim=(-1.1, 1.1))
    for axis, label in zip(axes[:, 0], "wxyz", strict=True):
        axis.set_ylabel(f"$q_{label}$")
    axes[0, 0].legend(loc="best")
    return figure


def continuous(q: Floats) -> Floats:
    """Quaternions in time without jumps of sign."""
    dots = np.sum(q[1:] * q[:-1], axis=1)
    signs = np.concatenate([[1.0], np.cumprod(np.where(dots < 0, -1.0, 1.0))])
    aligned: Floats = q * signs[:, None]
    return aligned


def routes(drives: Mapping[str, Drive]) -> Figure:
    """Figures 5.4, 5.7 and 5.11: the routes, from green to red."""
    figure, axes = plt.subplots(1, len(drives), figsize=(9, 3), squeeze=False)
    for axis, (name, drive) in zip(axes[0], drives.items(), strict=True):
        fix = drive.samples.fix
        east = (fix[:, LONGITUDE] - fix[0, LONGITUDE]) * np.cos(fix[0, LATITUDE]) * EARTH_RADIUS
        north = (fix[:, LATITUDE] - fix[0, LATITUDE]) * EARTH_RADIUS
        axis.plot(east, north)
        axis.plot(east[0], north[0], "o", color="tab:green")
        axis.plot(east[-1], north[-1], "o", color="tab:red")
        axis.set(title=name, xlabel="east, m")
        axis.set_aspect("equal", "datalim")
    axes[0, 0].set_ylabel("north, m")
    return figure


def yaw_rate(drive: Drive, threshold: float) -> Figure:
    """Figure 5.17: yaw rate from the course (5.2)."""
    figure, axis = plt.subplots(figsize=(9, 2.2))
    course = np.unwrap(drive.samples.fix[:, COURSE])
    axis.plot(drive.truth.t[1:], -np.diff(course) / np.diff(drive.truth.t))
    for level in (-threshold, threshold):
        axis.axhline(level, color="tab:red", ls="--")
    axis.set(xlabel="s", ylabel="yaw rate, rad/s", ylim=(-1.2, 1.2))
    return figure


def moving_average(trace: Trace, seconds: float) -> Figure:
    """Figure 5.16: the first component and its moving average."""
    figure, axis = plt.subplots(figsize=(9, 2.2))
    shown = trace.t < seconds
    q_vs = continuous(trace.q_vs)
    average = trace.average * np.sign(np.sum(trace.average * q_vs, axis=1))[:, None]
    axis.plot(trace.t[shown], q_vs[shown, 0], label="estimate")
    axis.plot(trace.t[shown], average[shown, 0], label="moving average, n = 100")
    axis.set(xlabel="s", ylabel="$q_w$")
    axis.legend()
    return figure


def histograms(errors: Mapping[str, Floats], names: Sequence[str]) -> Figure:
    """Figures 5.13 to 5.15: errors of the three angles."""
    figure, axes = plt.subplots(len(errors), 3, figsize=(9, 4), sharex="col", squeeze=False)
    for row, (preset, values) in zip(axes, errors.items(), strict=True):
        for axis, name, column in zip(row, names, values.T, strict=True):
            axis.hist(np.clip(column, -30, 30), bins=np.arange(-30.0, 31.0, 2.0), color=COLOURS[preset])
            axis.set_title(f"{name}, {preset}")
        row[0].set_ylabel("estimates")
    for axis in axes[-1]:
        axis.set_xlabel("error, deg (larger ones in the outer bars)")
    return figure


def drive_tests(tests: Mapping[str, tuple[Floats, Floats, Floats]]) -> Figure:
    """Figure 5.18: integrated speed and GPS speed."""
    figure, axes = plt.subplots(1, len(tests), figsize=(9, 2.6), sharey=True, squeeze=False)
    for axis, (name, (t, integrated, gps)) in zip(axes[0], tests.items(), strict=True):
        _speeds(axis, t, integrated, gps)
        axis.set(title=name, xlabel="s")
    axes[0, 0].set_ylabel("m/s")
    axes[0, 0].legend()
    return figure


def _speeds(axis: Axes, t: Floats, integrated: Floats, gps: Floats) -> None:
    axis.plot(t, gps, label="GPS")
    axis.plot(t, integrated, label="integrated")
