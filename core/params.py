"""What is tuned, per stage: unit, meaning and thesis symbol; the presets `default` and `thesis`.

Both presets run through the same code. An infinite time constant or noise switches the part it belongs to off, a zero
prior takes a state out of the filter: the `thesis` preset is the 9-state filter of table 5.1 in exactly this sense.
"""

import math
from dataclasses import dataclass, field, fields, replace
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

DEGREE = math.pi / 180
MILLI_G = 9.80665e-3

T = TypeVar("T")


class Threshold(NamedTuple):
    """One of the numbers decisions are made by that people may want to know."""

    name: str
    value: float
    unit: str
    meaning: str


def threshold(default: T, unit: str, meaning: str) -> T:
    """Declare a field that is a threshold; a mere number has the unit ''."""
    return field(default=default, metadata={"unit": unit, "meaning": meaning})


def thresholds(group: "DataclassInstance") -> list[Threshold]:
    """Give those among the fields of a dataclass."""
    return [Threshold(item.name, getattr(group, item.name), **item.metadata) for item in fields(group) if item.metadata]


@dataclass(frozen=True)
class EpochParameters:
    """Samples to epochs: one epoch spans the time between two fixes."""

    min_epoch: float = 0.45
    """s; faster fixes are merged until an epoch is this long"""
    max_epoch: float = 2.6
    """s; longer intervals between fixes are outages"""
    max_sample_gap: float = 1.0
    """s; a longer gap between IMU samples breaks the chain of epochs"""
    moving_speed: float = 1.0
    """m/s; below it the course is not trusted and the epoch says nothing about yaw"""
    max_speed: float = 90.0
    """m/s; faster fixes are rejected"""
    max_acceleration: float = 15.0
    """m/s2; a fix that needs more is a jump and is rejected"""
    max_yaw_rate: float = 1.5
    """rad/s; a course that turns faster is a jump"""
    reversing_speed: float = 4.0
    """m/s; nobody reverses faster"""
    detect_reversing: bool = True
    altitude_time_constant: float = 6.0
    """s; smoothing of the altitude that gives the climb rate; 0 = plain differences (5.1)"""
    latency_step: float = 0.25
    """s; grid of the GPS latency hypotheses"""
    latency_count: int = 9
    """number of latency hypotheses, 0, 1, 2... steps; 1 = no latency"""


@dataclass(frozen=True)
class CoarseParameters:
    """Coarse alignment: weighted Procrustes with accelerometer bias prior."""

    bias_sigma: float = 20 * MILLI_G
    """m/s2, prior of the accelerometer bias, per axis"""
    correlation_time: float = 4.0
    """s; the fit's residual (road slope, suspension, latency) stays correlated this long"""
    min_noise: float = 0.3
    """m/s2; the residual's standard deviation is taken to be at least this"""
    latency: float = 0.3
    """s, usual latency of a fix"""
    latency_sigma: float = 0.4
    """s, its spread over receivers; counts little once there is data"""
    gyro_noise_density: float = 1e-3
    """rad2/s; square of the residual angular rate times its correlation time; infinite = gyroscope not used"""
    interval: float = 1.0
    """s of motion between two solutions"""
    min_epoch: float = 0.95
    """s; epochs are merged until they are this long"""
    min_time: float = 10.0
    """s of motion before the first solution"""
    level_sigma: float = 0.6 * DEGREE
    """rad; ground that an installer calls level is so, in roll and in pitch"""
    report_sigma: float = 20 * DEGREE
    """rad; a solution is reported as an estimate when the largest sigma is below"""


@dataclass(frozen=True)
class FilterParameters:
    """Multiplicative extended Kalman filter. Defaults here are those of the preset `default`."""

    start_from_coarse: bool = True
    """start when the coarse alignment is good; False: start at once with q_vs = 1 (thesis 5.2)"""
    start_sigma: float = 20 * DEGREE
    """rad; start when the largest sigma of the coarse alignment is below"""
    refine_sigma: float = 6 * DEGREE
    """rad; started farther off, the filter starts once more when its largest sigma is below"""
    recover_sigma: float = 4 * DEGREE
    """rad; a second opinion with a smaller sigma is good enough to start again from"""
    recover_latency: float = 0.35
    """s; a filter whose latency differs by more starts again"""
    recover_cost: float = 40.0
    """if, to the second opinion, its own latency is more likely by this much (-2 log likelihood)"""
    start_inflation: float = 1.3
    """factor of the coarse alignment's sigmas at the start: the filter sees the same road again"""
    acceleration_noise: float = 1.0
    """m2/s5, sigma_a^2, power density of the jerk"""
    constant_over_epoch: bool = True
    """acceleration and yaw rate are means of an epoch and change between epochs; False: Wiener process (4.67)"""
    mean_share: float = 0.5
    """share of an epoch between the middle, which its mean signals stand for, and its end; 0 in the thesis"""
    exact_kinematics: bool = True
    """turns about the vertical and the road's curvature in the specific force; False: (4.55) as printed"""
    level_errors: bool = False
    """errors of the vehicle's attitude are defined in the level frame (4.24); False: in the vehicle's axes, where a
    turn of the vehicle does not mix what was learnt about roll and pitch with what was not"""
    yaw_rate_noise: float = 0.02
    """rad2/s3, random walk of the yaw rate"""
    yaw_rate_noise_per_speed: float = 0.0
    """rad2/m2 per 0.25 s, sigma_wz^2 with the gate v_x of (4.63)"""
    attitude_noise_per_yaw_rate: float = 0.0
    """s2 per 0.25 s, sigma_aV^2 with the gate w_z of (4.63)"""
    mounting_noise_per_yaw_rate: float = 0.0
    """s2 per 0.25 s, sigma_aA^2 with the gate w_z of (4.63)"""
    heading_noise: float = 5e-5
    """rad2/s, random walk of the heading (side slip)"""
    mounting_noise: float = 1e-9
    """rad2/s, random walk of the mounting"""
    doubt_noise: float = (0.3 * DEGREE) ** 2
    """rad2/s, the same while the receiver errs much more than usual, so that what it did then wears off"""
    bank_sigma: float = 1.5 * DEGREE
    """rad, stationary standard deviation of the road's bank; roads are level on average"""
    bank_length: float = 50.0
    """m, the bank returns to level over this distance; infinite = it does not"""
    grade_sigma: float = 2.5 * DEGREE
    """rad, stationary standard deviation of the road's grade"""
    grade_length: float = 100.0
    """m, the grade returns to level over this distance; infinite = it does not"""
    road_memory: float = 2000.0
    """m over which the variances of bank and grade are learnt; infinite = they are as given"""
    min_road_sigma: float = 0.7 * DEGREE
    """rad, bank and grade are never taken to vary less"""
    max_road_sigma: float = 5.0 * DEGREE
    """rad, nor more"""
    bias_sigma: float = 20 * MILLI_G
    """m/s2, prior of the accelerometer bias, per axis; 0 = no such state"""
    bias_noise: float = 1e-7
    """m2/s5, random walk of the accelerometer bias"""
    gyro_bias_sigma: float = 1.0 * DEGREE
    """rad/s, prior of the gyroscope bias, per axis"""
    gyro_bias_noise: float = 1e-10
    """rad2/s3, random walk of the gyroscope bias"""
    lever_arm: float = 1.0
    """m, usual place of a device ahead of the vehicle's turning point, the middle of the rear axle"""
    lever_arm_sigma: float = 0.7
    """m, prior of the lever arm, ahead and to the left"""
    antenna_sigma: float = 0.3
    """m, prior of the antenna's place ahead of the device"""
    latency_sigma: float = 0.1
    """s, uncertainty of the latency the filter starts with"""
    latency_noise: float = 1e-7
    """s2/s, random walk of the latency"""
    pitch_per_acceleration: float = 0.5 * DEGREE
    """rad per m/s2, usual squat and dive of the suspension"""
    roll_per_acceleration: float = 0.4 * DEGREE
    """rad per m/s2, usual lean of the suspension in curves"""
    suspension_sigma: float = 0.2 * DEGREE
    """rad per m/s2, prior of both about the usual"""
    accelerometer_noise: float = 0.115
    """m/s2, sigma_accl of an epoch's mean specific force"""
    speed_noise: float = 0.16
    """m/s, sigma_GPS,speed per horizontal axis where the receiver does not state it"""
    least_acceleration: float = 0.3
    """m/s2; less horizontal specific force is not asked for yaw: a slow error of the receiver looks the same"""
    climb_noise: float = math.inf
    """m/s, sigma of the climb rate from differenced altitudes; infinite = not used, the altitude itself is"""
    vertical_speed_noise: float = 0.3
    """m/s, sigma of the vertical speed of receivers that give it"""
    altitude_noise: float = 0.5
    """m, sigma of the altitude from one epoch to the next; infinite = not used"""
    altitude_drift: float = 0.02
    """m2/s, random walk of the altitude's error"""
    course_rate_noise: float = math.inf
    """rad/s, sigma_GPS,w of the differenced course; infinite = not used, the velocity vector already tells"""
    gyro_noise: float = 0.004
    """rad/s, epoch mean of the angular rate not explained; infinite = gyroscope not used"""
    bounce_sigma: float = 0.5 * DEGREE
    """rad, roll and pitch of the body on its springs, from one epoch to the next"""
    standstill_yaw_rate_noise: float = 0.05
    """rad/s, a standing vehicle does not turn; infinite = not used"""
    low_speed_course: bool = False
    """use the course below `moving_speed` too"""
    noise_memory: float = 50.0
    """measurements over which the noise of velocity and altitude is learnt; infinite = it is as given"""
    burst_memory: float = 8.0
    """measurements over which a burst of bad velocities shows"""
    start_noise_factor: float = 4.0
    """variance relative to the usual to begin with, so that a poor receiver does no harm before it is known"""
    max_noise_factor: float = 12.0
    """it is never taken to be more than so many times the usual"""
    gate: float = 4.0
    """sigmas; noise of a measurement with a larger innovation is raised until it is this large"""


@dataclass(frozen=True)
class SettlingParameters:
    """Moving average, STABLE and RELIABLE (thesis 5.3)."""

    average_window: float = threshold(
        25.0, "s", "Length of the moving average; infinite: `average_epochs` whatever they last."
    )
    stable_rate: float = threshold(1.6e-3, "rad/s", "STABLE when its moving average turns slower.")
    reliable_yaw_rate: float = 0.0
    """rad/s; RELIABLE when exceeded (thesis); 0 = RELIABLE is a statement about information, below"""
    start_yaw_sigma: float = threshold(
        3.0 * DEGREE, "rad", "RELIABLE, and so ready for the drive test, with a sigma about the vertical below."
    )
    start_tilt_sigma: float = threshold(
        1.6 * DEGREE, "rad", "RELIABLE, and so ready for the drive test, with sigmas about the other axes below."
    )
    yaw_sigma: float = threshold(1.3 * DEGREE, "rad", "Confirmed with a sigma about the vertical below.")
    tilt_sigma: float = threshold(1.2 * DEGREE, "rad", "Confirmed with sigmas about the other axes below.")
    excitation: float = threshold(
        15.0, "m2/s3", "Time integral of squared horizontal acceleration needed before a drive test."
    )
    doubt: float = 6.0
    """variance of the velocity over the last seconds, relative to the longer run, above which nothing is concluded"""
    second_opinion_sigmas: float = 3.0
    """filter and coarse alignment agree within so many sigmas"""
    second_opinion_angle: float = 4.0 * DEGREE
    """rad; and within this angle"""
    systematic_sigma: float = 0.1 * DEGREE
    """rad, per axis, added in square to every stated sigma: what the model leaves out (lever arm, suspension)"""


@dataclass(frozen=True)
class VerificationParameters:
    """The drive test (thesis 5.4)."""

    duration: float = threshold(40.0, "s", "Driving that the drive test takes, t_test.")
    limit: float = threshold(2.5, "m/s", "Largest speed error that passes the drive test.")
    longest: float = threshold(
        120.0, "s", "A test goes on so long while the estimate is not yet good enough to be confirmed."
    )
    drift: float = threshold(
        2.5 * DEGREE, "rad", "The estimate must not move farther from the candidate during the test."
    )
    by_energy: bool = True
    """compare the work of the forward specific force with kinetic and potential energy; False: (5.6) as printed"""


@dataclass(frozen=True)
class ChangeParameters:
    """Orientation change (thesis 5.5): a second filter, the challenger, that knows nothing of the mounting."""

    window: float = threshold(240.0, "s", "Motion after which the challenger begins anew; infinite: no detection.")
    interval: float = 5.0
    """s of motion between two looks"""
    sigma: float = 25 * DEGREE
    """rad, what the challenger begins with, per axis"""
    suspicion: float = 14.0
    """squared Mahalanobis distance (3 degrees of freedom) that makes it begin anew, on new data alone"""
    decision: float = threshold(
        32.0, "", "Squared Mahalanobis distance (3 degrees of freedom) of the challenger that decides."
    )
    looks: int = threshold(4, "", "Looks in a row that must show a change.")
    innocent: float = 6.0
    """a distance below speaks for the confirmed mounting"""
    sure_sigma: float = 3.0 * DEGREE
    """rad; the challenger decides and acquits when its largest sigma is below"""
    excitation: float = 20.0
    """m2/s3, squared acceleration the challenger must have seen to decide"""
    quiet: float = 60.0
    """s of motion without acceleration after which a suspicious challenger begins anew: this may be a ferry"""
    min_angle: float = threshold(4.0 * DEGREE, "rad", "Smaller changes of the orientation are not reported.")
    reference_angle: float = 2.0 * DEGREE
    """rad; the filter is the reference, being better than the confirmed mounting, while it is no farther from that"""


@dataclass(frozen=True)
class FaultParameters:
    """Faults of the sensor, and a device that is loose."""

    mirror: float = 25.0
    """log likelihood ratio at which mirrored axes are reported"""
    right_handed: float = -4.0
    """log likelihood ratio below which the axes are taken to be right-handed; before, nothing is confirmed"""
    mirror_doubt: float = 6.0
    """log likelihood ratio at which that is taken back"""
    stuck_time: float = threshold(
        20.0, "s", "Motion in which an axis repeats one value while another moves, until it is reported."
    )
    stuck_doubt: float = 2.0
    """s of it after which epochs are not used"""
    saturation_memory: float = 60.0
    """s over which readings at the end of the range are counted"""
    saturation_time: float = 6.0
    """s of them that are reported"""
    loose: float = threshold(2.5, "", "Changes of the mounting within `loose_memory` that make a device loose.")
    loose_memory: float = threshold(7200.0, "s", "Time in which a change of the mounting fades.")
    moved_on_weight: float = 0.5
    """changes that a drive test counts as whose candidate the estimate left"""


@dataclass(frozen=True)
class Parameters:
    """All that is tuned."""

    epoch: EpochParameters = field(default_factory=EpochParameters)
    coarse: CoarseParameters = field(default_factory=CoarseParameters)
    filter: FilterParameters = field(default_factory=FilterParameters)
    settling: SettlingParameters = field(default_factory=SettlingParameters)
    verification: VerificationParameters = field(default_factory=VerificationParameters)
    change: ChangeParameters = field(default_factory=ChangeParameters)
    fault: FaultParameters = field(default_factory=FaultParameters)
    report_interval: float = 1.0
    """s of log time between two reported estimates"""


DEFAULT = Parameters()

THESIS = Parameters(
    epoch=EpochParameters(min_epoch=0.19, detect_reversing=False, altitude_time_constant=0.0, latency_count=1),
    filter=FilterParameters(
        start_from_coarse=False,
        acceleration_noise=10.0,
        constant_over_epoch=False,
        mean_share=0.0,
        exact_kinematics=False,
        level_errors=True,
        yaw_rate_noise=0.0,
        yaw_rate_noise_per_speed=5e-3,
        attitude_noise_per_yaw_rate=1e-4,
        mounting_noise_per_yaw_rate=0.1,
        heading_noise=0.0,
        mounting_noise=0.0,
        bank_sigma=0.0,
        bank_length=math.inf,
        grade_sigma=0.0,
        grade_length=math.inf,
        road_memory=math.inf,
        bias_sigma=0.0,
        bias_noise=0.0,
        gyro_bias_sigma=0.0,
        gyro_bias_noise=0.0,
        lever_arm=0.0,
        lever_arm_sigma=0.0,
        antenna_sigma=0.0,
        latency_sigma=0.0,
        latency_noise=0.0,
        pitch_per_acceleration=0.0,
        roll_per_acceleration=0.0,
        suspension_sigma=0.0,
        accelerometer_noise=math.sqrt(15.0),
        speed_noise=math.sqrt(0.3),
        least_acceleration=0.0,
        climb_noise=math.sqrt(0.3),
        vertical_speed_noise=math.sqrt(0.3),
        altitude_noise=math.inf,
        altitude_drift=0.0,
        course_rate_noise=math.sqrt(2.0),
        gyro_noise=math.inf,
        bounce_sigma=0.0,
        standstill_yaw_rate_noise=math.inf,
        low_speed_course=True,
        noise_memory=math.inf,
        start_noise_factor=1.0,
        gate=math.inf,
    ),
    settling=SettlingParameters(average_window=math.inf, reliable_yaw_rate=0.15, systematic_sigma=0.0),
    verification=VerificationParameters(by_energy=False),
    change=ChangeParameters(window=math.inf),
)
"""Table 5.1 (variances at T = 0.25 s), n = 100, 40 s and 2.5 m/s, RELIABLE by yaw rate (thesis 5.2-5.4)."""


def calibrated(params: Parameters) -> Parameters:
    """Give the parameters for a device whose accelerometer was calibrated: the bias is known much better."""
    if params.filter.bias_sigma == 0:  # no such state
        return params
    sigma = 5 * MILLI_G
    return replace(
        params,
        coarse=replace(params.coarse, bias_sigma=sigma),
        filter=replace(params.filter, bias_sigma=sigma),
    )


PRESETS = {"default": DEFAULT, "thesis": THESIS}

_STAGES = ("epoch", "coarse", "filter", "settling", "verification", "change", "fault")


@lru_cache(maxsize=32)
def as_record(params: Parameters) -> NDArray[np.void]:
    """Give the parameters as a structured array of shape (1,) for the kernel, names `stage_parameter`.

    The same array for the same parameters: numba looks a type up anew for every new dtype, which takes long.
    """
    values: dict[str, float | bool | int] = {"report_interval": params.report_interval}
    for stage in _STAGES:
        group = getattr(params, stage)
        values |= {f"{stage}_{item.name}": getattr(group, item.name) for item in fields(group)}
    kinds = {bool: "?", int: "i8", float: "f8"}
    record = np.zeros(1, np.dtype([(name, kinds[type(value)]) for name, value in values.items()]))
    for name, value in values.items():
        record[name] = value
    return record
