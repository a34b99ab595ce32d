"""Is the course counted clockwise from north, as receivers do, or anticlockwise, as the thesis says? Ask the positions.

Over each leg of `LEG` metres the bearing of travel b is known from the positions. With the mean course c of the leg,
sin(c) sin(b) is near sin(b)^2 > 0 if the course is clockwise and near -sin(b)^2 < 0 if it is anticlockwise; a leg to
the north or the south says nothing. The legs are added up until they speak clearly.
"""

from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from api.formats.log import Context

Floats = NDArray[np.float64]

EARTH_RADIUS = 6_371_000.0
LEG = 20.0
"""m; far above the resolution of the positions"""
CLEAR = 5.0
"""sum of the legs' votes that decides: five legs to the east or west that agree, or more in other directions"""
MOVING = 2.0
"""m/s; below it course and bearing are noise"""


class Sense(StrEnum):
    """Sense in which the course is counted."""

    CLOCKWISE = "clockwise"
    ANTICLOCKWISE = "anticlockwise"
    AUTO = "auto"


def decide(latitude: Floats, longitude: Floats, speed: Floats, course: Floats, context: Context) -> Sense:
    """Decide from the fixes of a chunk (M,), degrees and m/s, and from what `context` holds of the chunks before.

    Once decided, the sense stays; until then it is taken as clockwise.
    """
    if "sense" not in context:
        votes = _Votes(context.get("votes", 0.0), context.get("leg", []))
        for fix in zip(latitude.tolist(), longitude.tolist(), speed.tolist(), course.tolist(), strict=True):
            votes.add(*fix)
            if abs(votes.sum) >= CLEAR:
                context["sense"] = str(Sense.CLOCKWISE if votes.sum > 0 else Sense.ANTICLOCKWISE)
                break
        context["votes"], context["leg"] = votes.sum, votes.leg
    return Sense(context.get("sense", Sense.CLOCKWISE))


class _Votes:
    """Sum of the votes, and the leg being driven: where it began, and the sum of the course's directions on it."""

    def __init__(self, total: float, leg: list[float]) -> None:
        self.sum = total
        self.leg = leg

    def add(self, latitude: float, longitude: float, speed: float, course: float) -> None:
        if not speed >= MOVING or np.isnan(course + latitude + longitude):
            self.leg = []
            return
        if not self.leg:
            self.leg = [latitude, longitude, 0.0, 0.0]
            return
        start_latitude, start_longitude, sine, cosine = self.leg
        sine, cosine = sine + np.sin(np.radians(course)), cosine + np.cos(np.radians(course))
        north = np.radians(latitude - start_latitude) * EARTH_RADIUS
        east = np.radians(longitude - start_longitude) * EARTH_RADIUS * np.cos(np.radians(latitude))
        self.leg = [start_latitude, start_longitude, float(sine), float(cosine)]
        distance, length = np.hypot(north, east), np.hypot(sine, cosine)
        if distance >= LEG:
            self.sum += float(sine / max(length, 1e-9) * east / distance)
            self.leg = []
