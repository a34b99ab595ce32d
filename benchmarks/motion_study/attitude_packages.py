"""Published Python packages on the same logs, with the settings they come with: attitudes (N, 4) q_ns of a log.

All begin with the attitude of the first reading. `ahrs` and `imufusion` count directions north, west, up, `vqf` east,
north, up.
"""

from collections.abc import Callable, Mapping
from typing import Any

import imufusion
import numpy as np
from ahrs.filters import EKF, QUEST, Madgwick
from numpy.typing import NDArray
from vqf import VQF

from core import quaternion
from core.simulation_marg import DIP, MargLog
from core.simulation_motion import GRAVITY

Floats = NDArray[np.float64]

WEST_FROM_NORTH = quaternion.from_rotation_vector([0.0, 0.0, np.pi / 2])
"""Turns north, west, up into east, north, up."""
FIELD = np.array([np.cos(DIP), 0.0, -np.sin(DIP)])
"""Direction of the Earth's field: north, west, up."""


def _rate(log: MargLog) -> float:
    return float(1 / np.median(np.diff(log.samples.t)))


def _field(log: MargLog) -> Floats:
    assert log.samples.m_s is not None
    return log.samples.m_s


def _start(log: MargLog) -> Floats:
    """(4,) attitude of the first reading, north, west, up."""
    up = log.samples.f_s[0] / np.linalg.norm(log.samples.f_s[0])
    west = np.cross(up, _field(log)[0])
    west /= np.linalg.norm(west)
    return quaternion.from_matrix(np.stack([np.cross(west, up), west, up]))


def ahrs_madgwick(log: MargLog) -> Floats:
    made = Madgwick(gain=0.041, Dt=1 / _rate(log))
    q = np.empty((len(log.samples), 4))
    q[0] = _start(log)
    for k in range(1, len(q)):
        q[k] = made.updateMARG(q[k - 1], log.samples.w_s[k], log.samples.f_s[k], _field(log)[k])
    return quaternion.multiply(WEST_FROM_NORTH, q)


def ahrs_ekf(log: MargLog) -> Floats:
    made = EKF(log.samples.w_s, log.samples.f_s, _field(log), _rate(log), q0=_start(log), magnetic_ref=FIELD.tolist())
    return quaternion.multiply(WEST_FROM_NORTH, made.Q)


def ahrs_quest(log: MargLog) -> Floats:
    made = QUEST()
    made.m_q = FIELD
    q = [made.estimate(f, m) for f, m in zip(log.samples.f_s, _field(log), strict=True)]
    return quaternion.multiply(WEST_FROM_NORTH, np.array(q))


def imufusion_ahrs(log: MargLog) -> Floats:
    """Run Fusion with its own gain and estimate of the gyroscope's bias, and rejection of disturbed fields.

    Rejection of accelerations, which its example has too, made the tilt four times worse here and is left out.
    """
    rate = _rate(log)
    made, bias = imufusion.Ahrs(), imufusion.Bias()
    made.set_settings(
        imufusion.AhrsSettings(
            sample_rate=rate,
            convention=imufusion.CONVENTION_NWU,
            gain=0.5,
            gyroscope_range=2000.0,
            magnetic_rejection=10.0,
            rejection_timeout=5.0,
        )
    )
    bias.set_settings(imufusion.BiasSettings(sample_rate=rate))
    q = np.empty((len(log.samples), 4))
    rates, forces = np.degrees(log.samples.w_s), log.samples.f_s / GRAVITY
    for k, (w, f, m) in enumerate(zip(rates, forces, _field(log), strict=True)):
        made.update(bias.update(w), f, m)
        q[k] = made.get_quaternion()
    return quaternion.multiply(WEST_FROM_NORTH, q)


def vqf(log: MargLog, **settings: Any) -> Floats:
    made = VQF(1 / _rate(log), **settings)
    readings = (np.ascontiguousarray(x) for x in (log.samples.w_s, log.samples.f_s, _field(log)))
    q: Floats = made.updateBatch(*readings)["quat9D"]
    return q


PACKAGES: Mapping[str, Callable[[MargLog], Floats]] = {
    "ahrs Madgwick": ahrs_madgwick,
    "ahrs EKF": ahrs_ekf,
    "ahrs QUEST": ahrs_quest,
    "imufusion": imufusion_ahrs,
    "vqf": vqf,
}
