"""An impact in words."""

import math
from datetime import UTC, datetime

import pytest

from api.services.happenings import impact_message
from core.motion.events import EventKind, MotionEvent

AT = datetime(2024, 5, 6, 7, 8, 9, tzinfo=UTC)


def impact(**known: object) -> MotionEvent:
    usual = MotionEvent(EventKind.IMPACT, 9.0, 8.95, 0.09, 117.7, math.radians(38), (-5.55, -4.17), 12.0)
    return usual._replace(**known)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("event", "said"),
    [
        (
            impact(),
            "Impact from the front left (38 degrees), 12 g for 90 ms, speed changed by 25 km/h, at 07:08 UTC.",
        ),
        (
            impact(direction=math.radians(-172.4), peak=30.0, duration=0.152, velocity_change=(2.0, 0.1)),
            "Impact from the rear (172 degrees), 3.1 g for 152 ms, speed changed by 7 km/h, at 07:08 UTC.",
        ),
        (
            impact(direction=math.nan),
            "Impact, 12 g for 90 ms, speed changed by 25 km/h, at 07:08 UTC.",
        ),
    ],
)
def test_an_impact_is_told_in_words(event: MotionEvent, said: str) -> None:
    assert impact_message(event, AT) == said
