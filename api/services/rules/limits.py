"""The thresholds of the rules, in one table: what raises an alert, and the milder value that ends it."""

from datetime import timedelta
from typing import NamedTuple, Self

from api.settings import Settings

MINUTE, HOUR = 60.0, 3600.0


class Limits(NamedTuple):
    """Thresholds; seconds are of the device's clock unless it says otherwise."""

    stalled_driving: float = 30 * MINUTE
    """s of driving without a confirmed mounting, and each time so many more"""

    failed_tests: int = 4
    """failed drive tests in a row, and each further one"""

    without_fix: float = 30 * MINUTE
    """s of data without a GPS fix"""
    fix_share: float = 0.5
    """share of a chunk's time with a fix from which on the chunk counts as one with a fix"""
    fix_sustained: float = MINUTE
    """s of chunks with a fix, one after the other, that end it"""

    held_driving: float = 30 * MINUTE
    """s of driving that a confirmed mounting must hold until the device is no longer taken to be loose"""
    sound_driving: float = 5 * MINUTE
    """s of driving without any fault of the sensor that end a fault"""

    silent: timedelta = timedelta(hours=72)
    """time of day since the last data"""

    clock_back: float = 1.0
    """s by which a clock runs back"""
    clock_standing: float = 0.9
    """share of a chunk's samples with the time of the one before"""
    clock_ahead: float = MINUTE
    """s that a clock which agreed with the time of day has got ahead of it"""
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
    clock_sound: float = HOUR
    """s without anything wrong that end a fault of the clock"""
    clock_episode: float = MINUTE
    """s without anything wrong after which the next fault counts as another one"""

    @classmethod
    def of(cls, settings: Settings) -> Self:
        """Take those that can be set from the settings."""
        return cls(
            stalled_driving=settings.alert_stalled_minutes * MINUTE,
            failed_tests=settings.alert_failed_tests,
            without_fix=settings.alert_gps_lost_minutes * MINUTE,
            silent=timedelta(hours=settings.alert_silent_hours),
        )
