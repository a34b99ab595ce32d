"""What events are told by: thresholds and time constants, one table, with unit and meaning."""

from dataclasses import dataclass, fields
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from core.params import DEGREE, threshold


@dataclass(frozen=True)
class EventParameters:
    """What events are told by. Accelerations without gravity, the road's slope and the accelerometer's bias."""

    harsh_braking: float = threshold(3.5, "m/s2", "Harsh braking: the smoothed deceleration exceeds it.")
    harsh_acceleration: float = threshold(3.0, "m/s2", "Harsh acceleration: the smoothed acceleration exceeds it.")
    harsh_cornering: float = threshold(4.0, "m/s2", "Harsh cornering: the smoothed lateral acceleration exceeds it.")
    harsh_least: float = threshold(0.4, "s", "A harsh manoeuvre lasts at least so long.")
    harsh_end_share: float = threshold(0.75, "", "It ends below this share of its threshold.")
    harsh_smoothing: float = threshold(0.1, "s", "Time constant of each of the two low-passes before harsh driving.")
    harsh_settling: float = threshold(5.0, "s", "No harsh manoeuvre begins so soon after the first sample.")
    harsh_clip: float = 12.0
    """m/s2; more is no driving and is cut off before the low-passes"""
    moving_speed: float = threshold(1.5, "m/s", "Slower vehicles neither drive harshly nor meet potholes.")
    impact_rate: float = threshold(45.0, "Hz", "Impacts and potholes are told from this sampling rate on.")
    impact_peak: float = threshold(
        23.0, "m/s2", "Impact: the acceleration on the plan, over that before it, reaches it."
    )
    impact_level: float = threshold(
        12.0, "m/s2", "Impact: what tyres cannot do, both in all and over the acceleration before."
    )
    impact_velocity: float = threshold(0.55, "m/s", "Impact: change of the velocity while above that level.")
    impact_one_way: float = threshold(
        0.6, "", "Impact: change of the velocity over the integral of the acceleration's size; shaking has little."
    )
    impact_back: float = threshold(
        0.3, "", "Impact: largest acceleration back that tyres cannot do, over the peak; doors swing back."
    )
    impact_back_time: float = threshold(0.08, "s", "It is looked for so long after the pulse.")
    impact_sure: float = threshold(60.0, "m/s2", "It is not looked for after pulses larger than any door makes.")
    impact_shortest: float = threshold(
        0.012, "s", "Impact: that change over the peak; knocks at the device are shorter."
    )
    impact_up: float = threshold(1.2, "", "Impact: largest vertical acceleration over the peak on the plan.")
    impact_up_velocity: float = threshold(0.8, "", "Impact: change of the velocity, vertical over on the plan.")
    impact_wait: float = threshold(2.0, "s", "After the pulse the device must have stayed in its place for so long.")
    impact_refractory: float = threshold(1.0, "s", "The next impact is told this much later.")
    pulse_level: float = threshold(6.0, "m/s2", "A pulse begins above, over the acceleration just before it.")
    pulse_end_share: float = threshold(0.4, "", "A pulse ends below this share of its peak, or `impact_level`.")
    pulse_pause: float = threshold(0.025, "s", "A pulse has ended when it has been lower for so long.")
    pulse_longest: float = threshold(0.2, "s", "A pulse is not followed longer than this after its peak.")
    base_time: float = threshold(0.12, "s", "Time constant of the average a pulse stands out from.")
    base_clip: float = 15.0
    """m/s2; what stands out further counts as this much in the averages"""
    handled_tilt: float = threshold(15 * DEGREE, "rad", "The device is handled: it turns so far out of the level.")
    tilt_time: float = threshold(2.0, "s", "Time constant over which the turn is seen.")
    rest_time: float = threshold(0.5, "s", "Time constant of the two averages that follow.")
    handled_up: float = threshold(3.5, "m/s2", "The device is handled: the average vertical is so far from gravity.")
    handled_plan: float = threshold(12.0, "m/s2", "The device is handled: the average on the plan is so large.")
    handled_time: float = threshold(5.0, "s", "Nothing is told so long after the device was handled.")
    pothole: float = threshold(9.0, "m/s2", "Pothole: the vertical acceleration in the band exceeds it.")
    pothole_ratio: float = threshold(5.0, "", "Pothole: it exceeds the road's standard deviation so many times.")
    pothole_low: float = threshold(5.0, "Hz", "Band of the vertical acceleration, from.")
    pothole_high: float = threshold(40.0, "Hz", "Band of the vertical acceleration, to.")
    pothole_refractory: float = threshold(0.3, "s", "A jolt ends when it has been quiet for so long.")
    pothole_longest: float = threshold(2.0, "s", "A jolt is not followed longer.")
    road_time: float = threshold(10.0, "s", "Time constant over which the road's standard deviation is learnt.")
    offset_time: float = 8.0
    """s, time constant of gravity, slope and bias on the plan: what the acceleration of the fixes does not explain"""
    offset_time_without_fixes: float = 30.0
    """s, the same where no fixes tell the acceleration"""
    offset_clip: float = 2.0
    """m/s2; what departs further counts as this much"""
    max_fix_age: float = 2.6
    """s; an older fix tells nothing of the speed"""
    course_speed: float = 3.0
    """m/s; slower courses tell no lateral acceleration"""
    max_gap: float = 1.0
    """s; after a longer gap between samples all that was going on has ended"""
    pitch_per_acceleration: float = 0.5 * DEGREE
    """rad per m/s2, usual squat and dive, by which slow accelerations read too large"""
    roll_per_acceleration: float = 0.4 * DEGREE
    """rad per m/s2, usual lean in curves"""


DEFAULT = EventParameters()


@lru_cache(maxsize=32)
def as_record(params: EventParameters) -> NDArray[np.void]:
    """Give the parameters as a structured array of shape (1,) for the kernel."""
    names = [item.name for item in fields(params)]
    record = np.zeros(1, np.dtype([(name, "f8") for name in names]))
    for name in names:
        record[name] = getattr(params, name)
    return record
