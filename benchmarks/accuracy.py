"""Accuracy, honesty and alarms on many drives: writes docs/accuracy.md and docs/pictures/accuracy/."""

import argparse
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from benchmarks.accuracy_study.options import DATA, FULL, Options
from benchmarks.accuracy_study.page import SECTIONS, measure, write_page

QUICK = 6


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--drives", type=int, default=FULL, help="drives per cell; the other sections in proportion")
    parser.add_argument("--quick", action="store_true", help=f"the same as --drives {QUICK}")
    parser.add_argument("--section", action="append", choices=SECTIONS, help="measure only this; may be repeated")
    parser.add_argument("--page", action="store_true", help="measure nothing, write the page from what is there")
    parser.add_argument("--data", type=Path, default=DATA, help="folder of the recorded drives")
    chosen = parser.parse_args()
    if not chosen.page:
        options = Options(QUICK if chosen.quick else chosen.drives, chosen.data)
        measure(chosen.section or SECTIONS, options)
    write_page()


if __name__ == "__main__":
    main()
