"""Load: how many devices the service holds. Writes the section on it of docs/performance.md."""

import argparse
import os
import signal
import sys
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from benchmarks.accuracy_study.options import DOCS
from benchmarks.load_study import stages
from benchmarks.load_study.cells import CELLS
from benchmarks.load_study.drives import ENCODINGS
from benchmarks.load_study.measuring import driven, encoded
from benchmarks.load_study.pacing import Plan
from benchmarks.load_study.page import assemble, draw, ratios, with_http
from benchmarks.load_study.study import carry_out
from benchmarks.sections import write_section

FULL = Plan(0, warm_up=15.0, measure=60.0)
"""for the counts wanted: every device posts"""
SHORT = Plan(0, warm_up=10.0, measure=30.0)
QUICK = Plan(0, warm_up=3.0, measure=12.0)


def main() -> None:
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # so that the service is ended too
    options = _options()
    cells = {
        name: CELLS[name]._replace(devices=options.devices or CELLS[name].devices) for name in options.cell or CELLS
    }
    plans = (QUICK, QUICK) if options.quick else (FULL, SHORT)
    study = carry_out(cells, *plans, seconds=0.0 if options.quick else 60.0 * options.minutes)
    by_stage = {encoding: stages.profile(driven(), encoded(encoding)) for encoding in ENCODINGS}
    for encoding, times in with_http(by_stage, study).items():
        print(encoding, {stage: round(ms, 2) for stage, ms in times.items()}, flush=True)
    for what, own, naive, ratio in ratios(study):
        print(f"{what}: Livella {own}, naive {naive}, {ratio}", flush=True)
    if options.quick or options.cell or options.devices:
        print("load: not written, this was no full run", flush=True)
        return
    draw(study.runs, DOCS / "pictures" / "load.png")
    write_section(DOCS / "performance.md", "load", assemble(study, by_stage, FULL.measure))
    print(f"load: wrote {DOCS / 'performance.md'}", flush=True)


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cell", action="append", choices=list(CELLS), help="only this one; may be repeated")
    parser.add_argument("--quick", action="store_true", help="one short run of each cell")
    parser.add_argument("--devices", type=int, help="another count than the one wanted")
    parser.add_argument("--minutes", type=float, default=19.0, help="after which no other count is tried")
    return parser.parse_args()


if __name__ == "__main__":
    main()
