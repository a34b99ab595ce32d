"""Recorded drives of other people, not part of the project: ordinary driving, no collision; skipped where missing."""

from pathlib import Path

import numpy as np
import pytest

import core
from api import formats
from core.motion.events import DEFAULT, EventKind, advance, initial_state
from core.samples import SPEED

DATA = Path(__file__).parents[4] / "shared" / "data"
DRIVES = sorted(DATA.glob("*.csv.gz"))
MOST_HARSH = 2
"""harsh manoeuvres of a drive of some kilometres by ordinary drivers"""

pytestmark = [
    pytest.mark.real_data,
    pytest.mark.slow,
    pytest.mark.skipif(not DRIVES, reason="the recorded drives are not here (../shared/data)"),
]


@pytest.mark.parametrize("path", DRIVES, ids=lambda path: path.name.removesuffix(".csv.gz"))
def test_nothing_is_told_that_did_not_happen(path: Path) -> None:
    samples = formats.parse(path.read_bytes(), "text/csv", "gzip", formats.FILE_LIMITS).samples().samples
    state, _ = core.advance(core.DEFAULT, core.initial_state(core.DEFAULT), samples)
    estimate = core.status(core.DEFAULT, state).estimate
    assert estimate is not None
    _, events = advance(DEFAULT, initial_state(), estimate.quaternion, samples)
    kinds = [event.kind for event in events]
    assert EventKind.IMPACT not in kinds
    harsh = [event for event in events if event.kind != EventKind.POTHOLE]
    assert len(harsh) <= MOST_HARSH
    for event in harsh:
        assert event.peak < 6.0
        assert event.duration < 4.0
        assert np.isnan(event.speed) or event.speed < np.nanmax(samples.fix[:, SPEED]) + 0.1
