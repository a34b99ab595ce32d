"""Age: what a large fleet and a year of history cost. Writes the section on it of docs/performance.md."""

import argparse
import os
import signal
import sys
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from benchmarks.accuracy_study.options import DOCS
from benchmarks.age_study.databases import why_not
from benchmarks.age_study.page import Studies, assemble, told
from benchmarks.age_study.pair import Size
from benchmarks.age_study.study import Effort, Study, carry_out
from benchmarks.load_study.cells import POSTGRESQL, SQLITE
from benchmarks.sections import write_section

KINDS = (SQLITE, POSTGRESQL)
QUICK = (Size(2000, 4, days=30), Effort(5, 3))


def main() -> None:
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # so that PostgreSQL is ended too
    options = _options()
    size, effort = QUICK if options.quick else (Size(), Effort())
    studies: Studies = {kind: _study(kind, size, effort) for kind in options.database or KINDS}
    if options.quick or options.database:
        print("age: not written, this was no full run", flush=True)
        return
    write_section(DOCS / "performance.md", "age", assemble(studies))
    print(f"age: wrote {DOCS / 'performance.md'}", flush=True)


def _study(kind: str, size: Size, effort: Effort) -> Study | str:
    reason = why_not(kind)
    if reason is not None:
        print(f"{kind}: not measured, {reason}", flush=True)
        return reason
    study = carry_out(kind, size, effort)
    print(told(kind, study), flush=True)
    return study


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--database", action="append", choices=KINDS, help="only this one")
    parser.add_argument("--quick", action="store_true", help="a small fleet and a month")
    return parser.parse_args()


if __name__ == "__main__":
    main()
