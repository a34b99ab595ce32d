"""Speed of the estimator beside plain numpy and filterpy: writes docs/performance.md."""

import argparse
import os
import sys
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from benchmarks.kernel_speed.page import write_page

REPEATS = 300
FEWEST = 30


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=REPEATS, help=f"of every measurement, at least {FEWEST}")
    write_page(max(parser.parse_args().repeats, FEWEST))


if __name__ == "__main__":
    main()
