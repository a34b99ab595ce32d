"""What every service needs, made once per process."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime

from api.services.uses import Uses
from api.settings import Settings
from core import PRESETS, Parameters
from storage.database import Database


def utc_now() -> datetime:
    """Tell the time."""
    return datetime.now(UTC)


def _nobody() -> None:
    """Wake nobody."""


@dataclass(frozen=True)
class Context:
    """The service's surroundings; tests put in their own clock."""

    settings: Settings
    database: Database
    params: Parameters
    clock: Callable[[], datetime] = utc_now
    wake: Callable[[], None] = _nobody
    """called after a commit that wrote events, from any thread"""
    uses: Uses = field(default_factory=Uses)

    @classmethod
    def make(cls, settings: Settings, clock: Callable[[], datetime] = utc_now) -> "Context":
        """Connect to the database the settings name."""
        if settings.database_url is None:
            settings.data_dir.mkdir(parents=True, exist_ok=True)
        params = replace(PRESETS[settings.preset], report_interval=settings.estimate_interval)
        return cls(settings, Database(settings.url), params, clock)
