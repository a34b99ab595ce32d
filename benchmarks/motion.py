"""Attitude and motion on simulated logs, beside published packages: writes the measured parts of docs."""

import os
import sys
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from benchmarks.motion_study import attitude, impacts, sideslip, steering


def main() -> None:
    attitude.write()
    sideslip.write()
    steering.write()
    impacts.write()


if __name__ == "__main__":
    main()
