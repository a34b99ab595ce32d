import json

import numpy as np
import pytest
from numpy.typing import NDArray

from core import quaternion
from core.samples import ALTITUDE, COURSE, LATITUDE, LONGITUDE, SPEED, SPEED_ACCURACY, VERTICAL_SPEED
from core.simulation import REMOUNT_SECONDS, Drive, Scenario, simulate
from core.simulation_motion import GRAVITY
from core.simulation_routes import ROUTES
from core.simulation_sensors import EARTH_RADIUS, SENSORS

Floats = NDArray[np.float64]

SMOOTH = {"ideal": True, "vibration": 0.0, "gyro": True, "latency": 0.0}
HERE = {"lever_arm": (0, 0, 0)}
ALL_ROUTES = sorted(ROUTES)
MOVING_ROUTES = [route for route in ALL_ROUTES if route != "parked"]


def exact(route: str = "city", seconds: float = 120.0, **more: object) -> Drive:
    return simulate(Scenario(**({"route": route, "seconds": seconds} | SMOOTH | HERE | more)))  # type: ignore[arg-type]


def in_vehicle(drive: Drive, x_s: Floats) -> Floats:
    return quaternion.rotate(drive.truth.q_vs, x_s)


def strapdown(drive: Drive, first: int) -> tuple[Floats, Floats]:
    """Attitude and velocity at every sample from sample `first` on, integrated by the trapezoidal rule."""
    t, f_v, w_v = drive.samples.t, in_vehicle(drive, drive.samples.f_s), in_vehicle(drive, drive.samples.w_s)
    dt = np.diff(t)[:, None]
    turns = quaternion.from_rotation_vector(0.5 * (w_v[1:] + w_v[:-1]) * dt)
    start = np.searchsorted(drive.truth.t, t[first])
    q_nv = np.empty((t.size - first, 4))
    q_nv[0] = drive.truth.q_nv[start]
    for k, turn in enumerate(turns[first:]):
        q_nv[k + 1] = quaternion.multiply(q_nv[k], turn)
    a_n = quaternion.rotate(q_nv, f_v[first:]) - [0, 0, GRAVITY]
    steps = 0.5 * (a_n[1:] + a_n[:-1]) * dt[first:]
    return q_nv, drive.truth.v_n[start] + np.vstack([np.zeros(3), np.cumsum(steps, axis=0)])


@pytest.mark.parametrize("route", ALL_ROUTES)
def test_strapdown_integration_gives_the_motion_back(route: str) -> None:
    # The fixes arrive half a millisecond before a sample; start at rest, where that makes no difference.
    drive = exact(route, seconds=120.0, imu_rate=400.0)
    first = int(drive.samples.fix_row[1])
    q_nv, v_n = strapdown(drive, first)
    rows = drive.samples.fix_row[1:] - first
    later = simulate_truth_at(drive, drive.samples.t[rows + first])
    assert np.max(quaternion.angle_between(q_nv[rows], later[0])) < np.radians(0.005)
    assert np.max(np.abs(v_n[rows] - later[1])) < 0.02


def simulate_truth_at(drive: Drive, t: Floats) -> tuple[Floats, Floats]:
    """Attitude and velocity half a millisecond on, from the truth's own rates."""
    truth = drive.truth
    w_v = in_vehicle(drive, drive.samples.w_s)[drive.samples.fix_row[1:]]
    f_v = in_vehicle(drive, drive.samples.f_s)[drive.samples.fix_row[1:]]
    late = (t - truth.t[1:])[:, None]
    q_nv = quaternion.multiply(truth.q_nv[1:], quaternion.from_rotation_vector(w_v * late))
    return q_nv, truth.v_n[1:] + (quaternion.rotate(q_nv, f_v) - [0, 0, GRAVITY]) * late
