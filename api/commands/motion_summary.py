"""What is worth saying of a whole drive, gathered piece by piece."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.motion import Motion

Floats = NDArray[np.float64]

SUSTAINED = 0.2
"""s over which an acceleration is averaged before it counts as an extreme"""


@dataclass
class Summary:
    """Grows with `add`."""

    rate: float
    """Hz of the rows"""
    known: float = 0.0
    """s for which the velocity is known"""
    distance: float = 0.0
    """m"""
    top_speed: float = 0.0
    """m/s"""
    highest: Floats = field(default_factory=lambda: np.full(3, -np.inf))
    """m/s2, forward, left, up"""
    lowest: Floats = field(default_factory=lambda: np.full(3, np.inf))
    slip_left: float = 0.0
    """rad, largest sideslip to the left, driving forward"""
    slip_right: float = 0.0
    slip_squares: float = 0.0
    slip_count: int = 0
    outages: int = 0
    outage_time: float = 0.0
    longest_outage: float = 0.0
    outage_sigma: float = 0.0
    """m, largest uncertainty of the position within an outage"""
    _outage: float = 0.0
    _tail: Floats = field(default_factory=lambda: np.empty((0, 3)))

    def add(self, motion: Motion) -> None:
        """Take the next rows."""
        if not motion.t.size:
            return
        speed = np.hypot(*motion.velocity_v.T)
        moving = speed[np.isfinite(speed)]
        self.known += moving.size / self.rate
        self.distance += float(moving.sum()) / self.rate
        self.top_speed = max(self.top_speed, float(moving.max(initial=0.0)))
        self._add_acceleration(motion.a_v[np.isfinite(speed)])
        slip = motion.sideslip[np.isfinite(motion.sideslip) & (motion.velocity_v[:, 0] > 0)]
        self.slip_left = max(self.slip_left, float(slip.max(initial=0.0)))
        self.slip_right = min(self.slip_right, float(slip.min(initial=0.0)))
        self.slip_squares += float((slip**2).sum())
        self.slip_count += slip.size
        self._add_outages(motion.dead_reckoned & np.isfinite(speed), motion.position_sigma)

    def _add_acceleration(self, a_v: Floats) -> None:
        window = max(1, round(SUSTAINED * self.rate))
        rows = np.concatenate([self._tail, a_v])
        self._tail = rows[max(0, len(rows) - window + 1) :]
        if len(rows) >= window:
            total = np.concatenate([np.zeros((1, 3)), np.cumsum(rows, axis=0)])
            mean = (total[window:] - total[:-window]) / window
            self.highest = np.maximum(self.highest, mean.max(axis=0))
            self.lowest = np.minimum(self.lowest, mean.min(axis=0))

    def _add_outages(self, bridged: NDArray[np.bool_], sigma: Floats) -> None:
        edges = np.diff(bridged.astype(np.int8), prepend=np.int8(self._outage > 0))
        self.outages += int((edges == 1).sum())
        self.outage_time += float(bridged.sum()) / self.rate
        for run in np.split(bridged, np.flatnonzero(edges)):
            self._outage = (self._outage if run.size else 0.0) + float(run.sum()) / self.rate
            self.longest_outage = max(self.longest_outage, self._outage)
            if run.size and not run[-1]:
                self._outage = 0.0
        inside = sigma[bridged & np.isfinite(sigma)]
        self.outage_sigma = max(self.outage_sigma, float(inside.max(initial=0.0)))

    def document(self) -> dict[str, Any]:
        """Give the summary for JSON; m, s, m/s, m/s2 and degrees."""
        some = bool(np.isfinite(self.highest).all())
        rms = float(np.degrees(np.sqrt(self.slip_squares / self.slip_count))) if self.slip_count else None
        return {
            "known_s": self.known,
            "distance_m": self.distance,
            "top_speed_mps": self.top_speed,
            "acceleration_mps2": {
                name: [float(self.lowest[axis]), float(self.highest[axis])] if some else None
                for axis, name in enumerate(("longitudinal", "lateral", "vertical"))
            },
            "sideslip_deg": {
                "range": [float(np.degrees(self.slip_right)), float(np.degrees(self.slip_left))],
                "rms": rms,
            }
            if self.slip_count
            else None,
            "outages": {
                "count": self.outages,
                "total_s": self.outage_time,
                "longest_s": self.longest_outage,
                "position_sigma_m": self.outage_sigma,
            },
        }
