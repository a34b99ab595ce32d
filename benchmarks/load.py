"""Load: how many devices the service holds. Writes the section on it of docs/performance.md."""

import argparse
import os
import signal
import sys
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from benchmarks.accuracy_study.options import DOCS
from benchmarks.load_study import drives, stages
from benchmarks.load_study.cells import CELLS, P99_LIMIT, Result, Say, driven, encoded, search, why_not
from benchmarks.load_study.pacing import Plan
from benchmarks.load_study.page import assemble, draw
from benchmarks.sections import write_section


def main() -> None:
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # so that the service is ended too
    options = _options()
    plan = Plan(0, options.warm_up, 20.0 if options.quick else options.measure)
    limit, runs, skipped = options.p99 / 1e3, dict[str, list[Result]](), dict[str, str]()
    for name in options.cell or CELLS:
        reason = why_not(CELLS[name])
        if reason:
            skipped[name] = reason
            print(f"{name}: skipped, {reason}", flush=True)
            continue
        cell = CELLS[name]._replace(wanted=options.devices or CELLS[name].wanted)
        runs[name] = search(cell, plan, limit, 1 if options.quick else options.runs, Say(name, limit))
    by_stage = {encoding: stages.profile(driven(), encoded(encoding)) for encoding in drives.ENCODINGS}
    for encoding, times in by_stage.items():
        print(encoding, {stage: round(ms, 2) for stage, ms in times.items()}, flush=True)
    if options.quick or options.cell or options.devices:
        print("load: not written, this was no full run", flush=True)
        return
    draw(runs, limit, DOCS / "pictures" / "load.png")
    write_section(DOCS / "performance.md", "load", assemble(runs, skipped, by_stage, plan, limit))
    print(f"load: wrote {DOCS / 'performance.md'}", flush=True)


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cell", action="append", choices=list(CELLS), help="only this one; may be repeated")
    parser.add_argument("--quick", action="store_true", help="one run of each cell, measured for 20 s")
    parser.add_argument("--devices", type=int, help="another count than the one wanted")
    parser.add_argument("--runs", type=int, default=5, help="of each cell, at most")
    parser.add_argument("--warm-up", type=float, default=20.0, help="s")
    parser.add_argument("--measure", type=float, default=60.0, help="s")
    parser.add_argument("--p99", type=float, default=1e3 * P99_LIMIT, help="ms that 99 %% of the answers may take")
    return parser.parse_args()


if __name__ == "__main__":
    main()
