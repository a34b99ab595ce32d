"""The thresholds of the rules, in one table: what raises an alert, and the milder value that ends it."""

from dataclasses import dataclass
from datetime import timedelta
from typing import Self

from api.settings import Settings
from core import threshold

MINUTE, HOUR = 60.0, 3600.0


@dataclass(frozen=True)
class Limits:
    """Thresholds; seconds are of the device's clock unless it says otherwise."""

    stalled_driving: float = 30 * MINUTE
    """s of driving without a confirmed mounting, and each time so many more"""

    failed_tests: int = 4
    """failed drive tests in a row, and each further one"""

    without_fix: float = 30 * MINUTE
    """s of data without a GPS fix"""
    fix_share: float = 0.5
    """share of a chunk's time with a fix from which on the chunk counts as one with a fix"""
    fix_sustained: float = threshold(MINUTE, "s", "Chunks with a fix, one after the other, that end `gps_lost`.")

    held_driving: float = threshold(
        30 * MINUTE, "s", "Driving that a confirmed mounting must hold to end `device_loose`."
    )
    sound_driving: float = threshold(
        5 * MINUTE, "s", "Driving without any fault of the sensor that ends `sensor_fault`."
    )

    silent: timedelta = timedelta(hours=72)
    """time of day since the last data"""

    clock_back: float = threshold(1.0, "s", "A clock that runs back by this much raises `clock_fault`.")
    clock_standing: float = 0.9
    """share of a chunk's samples with the time of the one before"""
    clock_ahead: float = threshold(
        MINUTE, "s", "A clock farther ahead of the time of day it agreed with raises `clock_fault`."
    )
    clock_agrees: float = 15.0
    """s, a clock less ahead is sound again"""
    clock_window: float = 10 * MINUTE
    """s, time of day over which a clock's rate is measured"""
    clock_rate: float = 0.02
    """a rate less than this off 1 agrees with the time of day"""
    clock_backlog_rate: float = 0.8
    """a clock faster by more than this is no clock: data that were kept are being sent"""
    clock_steady: float = 0.05
    """rates that differ by less are the same"""
    clock_windows: int = 3
    """windows in a row with the same rate"""
    clock_late: float = 10.0
    """s later than the best so far: data were kept, their rate says nothing"""
    clock_sound: float = threshold(HOUR, "s", "Data without anything wrong that end `clock_fault`.")
    clock_episode: float = MINUTE
    """s without anything wrong after which the next fault counts as another one"""

    harsh_events: int = threshold(3, "events", "So much harsh driving in `harsh_window` raises `harsh_driving`.")
    harsh_window: float = threshold(10 * MINUTE, "s", "Driving in which harsh driving is counted.")
    harsh_quiet: float = threshold(30 * MINUTE, "s", "Data without harsh driving that end `harsh_driving`.")

    @classmethod
    def of(cls, settings: Settings) -> Self:
        """Take those that can be set from the settings."""
        return cls(
            stalled_driving=settings.alert_stalled_minutes * MINUTE,
            failed_tests=settings.alert_failed_tests,
            without_fix=settings.alert_gps_lost_minutes * MINUTE,
            silent=timedelta(hours=settings.alert_silent_hours),
        )
