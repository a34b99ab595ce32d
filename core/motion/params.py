"""What is tuned in the reconstruction of the motion. SI units and radians; noises are 1 sigma."""

from dataclasses import dataclass, fields
from math import radians

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Parameters:
    """Parameters of `advance`."""

    rate: float = 50.0
    """Hz of the output; each row averages the samples of its interval, so that nothing is aliased; at most 100"""
    latency: float = 0.0
    """s from the moment a fix tells of to its arrival; at most 1"""
    max_gap: float = 1.0
    """s; after a longer gap between samples the filter starts anew, biases kept"""
    start_speed: float = 2.0
    """m/s; the first fix this fast shows where the vehicle points"""
    start_tilt: float = radians(3.0)
    """rad, of roll and pitch at the start"""
    start_heading: float = radians(5.0)
    """rad"""
    walking_pace: float = 1.5
    """m/s; sideslip is not told below"""

    force_noise: float = 0.06
    """m/s2 per sqrt(Hz) of the specific force: vibration, scale and mounting errors"""
    rate_noise: float = 1.0e-3
    """rad/s per sqrt(Hz) of the angular rate"""
    rate_noise_without_gyro: float = 0.1
    """rad/s per sqrt(Hz) when the rate is that of the course"""
    bias: float = 0.25
    """m/s2, of the accelerometer at the start, per axis"""
    bias_walk: float = 1.5e-3
    """m/s2 per sqrt(s)"""
    gyro_bias: float = radians(0.7)
    """rad/s"""
    gyro_bias_walk: float = 3.0e-5
    """rad/s per sqrt(s)"""
    arm: float = 0.8
    """m, place of a device nobody measured about the centre of gravity, ahead and to the left"""
    measured_arm: float = 0.02
    """m, error of a place that was measured"""

    velocity: float = 0.15
    """m/s per axis, of a fix's velocity where the receiver states no accuracy"""
    velocity_correlation: float = 1.0
    """s for which the error of the velocity stays the same"""
    velocity_learning: float = 5.0
    """s in which it shows that a receiver is worse than it states"""
    velocity_distrust: float = 100.0
    """variance at most learnt, relative to what is stated"""
    vertical_velocity: float = 0.3
    """m/s"""
    position: float = 2.0
    """m per horizontal axis: how far the receiver's positions are off, over a minute"""
    altitude: float = 5.0
    """m"""
    position_correlation: float = 20.0
    """s for which the error of a position stays the same"""
    gate: float = 30.0
    """squared Mahalanobis distance, of two axes, beyond which a fix is not believed"""
    patience: float = 3.0
    """s of fixes not believed in a row after which the filter starts anew"""

    constraint_interval: float = 0.1
    """s between two uses of what is known of vehicles: how they slide sideways, that they do not leave the road"""
    constraint_correlation: float = 0.6
    """s for which the errors of these stay the same"""
    outage_correlation: float = 5.0
    """s by which that grows while no fix comes: without fixes their errors add up"""
    slip: float = radians(0.25)
    """rad, least error of the slip angle that is expected of the rear axle"""
    slip_share: float = 0.15
    """error of it in shares of it: the cornering stiffness is not known better"""
    force_share: float = 0.05
    """error of the axle's force in shares of it; near the friction limit it means much"""
    heave: float = 0.1
    """m/s, motion of the body along its vertical"""
    heave_share: float = 0.02
    """the same in shares of the speed: pitching on the springs, bumps"""
    still_speed: float = 0.3
    """m/s; a fix below says that the vehicle stands"""
    still_rate: float = 0.03
    """rad/s; and the gyroscope must read less; at the same time the error of a still gyroscope's reading"""
    still_force: float = 0.25
    """m/s2; and the accelerometer must have changed less to be at rest"""
    still_velocity: float = 0.1
    """m/s, of a vehicle that stands"""

    rate_smoothing: float = 0.05
    """s, time constant of the filtered rate whose derivative is the angular acceleration"""
    bicycle_speed: float = 5.0
    """m/s; the dynamic single-track model is used above"""
    bicycle_velocity_noise: float = 0.25
    """m/s per sqrt(s): what the model leaves out, lateral velocity"""
    bicycle_rate_noise: float = 0.1
    """rad/s per sqrt(s): the same, yaw rate"""
    bicycle_rate: float = 0.01
    """rad/s, error of the yaw rate measured"""
    bicycle_force: float = 0.4
    """m/s2, error of the lateral specific force measured and modelled"""


DEFAULT = Parameters()


def as_record(params: Parameters) -> NDArray[np.void]:
    """Give the parameters as a structured array of shape (1,) for the kernel."""
    record = np.zeros(1, [(item.name, "f8") for item in fields(Parameters)])
    for item in fields(Parameters):
        record[item.name] = getattr(params, item.name)
    return record
