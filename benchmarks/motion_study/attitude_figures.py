"""Pictures of the attitude filters."""

from math import radians, sqrt
from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.figure import Figure

from benchmarks.accuracy_study.figures import save
from benchmarks.motion_study.attitude_logs import SEEDS, angles
from benchmarks.motion_study.attitude_packages import vqf
from core import quaternion
from core.attitude import FILTERS
from core.simulation_marg import MargLog, MargScenario, simulate

COLOURS = {
    "gyro": "grey",
    "linear": "tab:purple",
    "ekf": "tab:blue",
    "madgwick": "tab:orange",
    "quest-ekf": "tab:green",
}


def at_rest() -> MargLog:
    """The log of 003 figure 12: at rest for 150 s with 0.07 deg/s of bias."""
    return simulate(MargScenario("rest", 150.0, SEEDS[0], gyro_bias=radians(0.07) / sqrt(3)))


def rest() -> Figure:
    """Angle off the truth over time at rest."""
    log = at_rest()
    figure, axis = plt.subplots(figsize=(9, 3))
    for name, used in FILTERS.items():
        off = np.degrees(quaternion.angle_between(used.run(log.samples)[1].q_ns, log.q_ns))
        axis.plot(log.samples.t, off, color=COLOURS[name], label=name)
    axis.set(xlabel="s", ylabel="off, deg")
    axis.legend()
    return figure


def walk() -> Figure:
    """Tilt and heading errors over time in a disturbed field."""
    log = simulate(MargScenario("walk", 100.0, SEEDS[0], disturbed=True))
    found = {name: used.run(log.samples)[1].q_ns for name, used in FILTERS.items() if used.follows_field}
    figure, axes = plt.subplots(2, 1, figsize=(9, 5), sharex=True)
    for name, q_ns in {**found, "vqf": vqf(log)}.items():
        for axis, angle in zip(axes, angles(q_ns, log), strict=True):
            axis.plot(log.samples.t, np.degrees(angle), color=COLOURS.get(name, "black"), label=name)
    for axis, label in zip(axes, ("tilt error, deg", "heading error, deg"), strict=True):
        low, high = axis.get_ylim()
        axis.fill_between(log.samples.t, low, high, where=log.disturbed, color="tab:red", alpha=0.1, lw=0)
        axis.set(ylabel=label, ylim=(low, high))
    axes[0].legend(ncols=4)
    axes[1].set_xlabel("s; red: the field is disturbed")
    return figure


def draw(folder: Path) -> None:
    """Write the pictures."""
    save(rest(), folder / "rest.png")
    save(walk(), folder / "walk.png")
