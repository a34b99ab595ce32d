"""The experiments of the thesis on simulated drives: writes docs/thesis.md and docs/pictures/thesis/."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from benchmarks.reproduction.page import write_page

if __name__ == "__main__":
    write_page()
