"""What the command line chooses."""

from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
PICTURES = DOCS / "pictures" / "accuracy"
CACHE = ROOT / "out" / "accuracy"
DATA = ROOT.parent / "shared" / "data"
FULL = 100
"""drives per cell of a full run"""


class Options(NamedTuple):
    """How much to run, and on what."""

    drives: int = FULL
    """per cell; the other sections grow and shrink with it"""
    data: Path = DATA
    """where the recorded drives are"""

    def scaled(self, full: int) -> int:
        """Give the number of runs where a full study has `full`."""
        return max(1, round(full * self.drives / FULL))
