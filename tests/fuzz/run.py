"""Coverage-guided fuzzing with atheris: `python -m tests.fuzz.run TARGET SECONDS [DIRECTORY]`.

What is found is written to `DIRECTORY` (out/fuzz by default) as `TARGET-crash-...`; new inputs that reach new code are
merged into the corpus beside this file, smallest first.
"""

import os
import shutil
import subprocess
import sys
import warnings
from pathlib import Path

CORPUS = Path(__file__).parent / "corpus"
OUT = Path(__file__).parents[2] / "out" / "fuzz"
INSTRUMENTED = ["api.formats", "api.services.paging", "core.snapshot", "core.samples", "storage.events"]
COMPILED = ["core._kernel", "api.formats._kernel"]
"""numba takes the functions as they are written"""
UNCOMPILED = ("native_csv",)
"""targets whose compiled code runs as Python, so that its branches are seen"""
MAX_LENGTH = 4096
OPTIONS = ["-timeout=20", "-rss_limit_mb=2048", "-print_final_stats=1", "-verbosity=0"]


def fuzz(target: str, arguments: list[str]) -> None:
    """Hand this process over to libFuzzer, which ends it."""
    try:
        import atheris
    except ImportError:
        sys.exit("atheris is missing: pip install 'livella[fuzz]', on a Python it is built for")

    with atheris.instrument_imports(include=INSTRUMENTED, exclude=[] if target in UNCOMPILED else COMPILED):
        from tests.fuzz.targets import TARGETS

    warnings.simplefilter("error")  # as in the tests
    if target in UNCOMPILED:
        warnings.filterwarnings("ignore", "overflow encountered")  # integers of machine code wrap silently
    itself = f"{sys.executable} -m tests.fuzz.run --child {target}"  # a merge calls it anew, through a shell
    atheris.Setup([itself, *arguments], TARGETS[target])
    atheris.Fuzz()


def run(target: str, seconds: int, out: Path) -> int:
    """Fuzz for a while, then keep the smallest inputs that cover what was reached; give libFuzzer's exit status."""
    from tests.fuzz.seeds import SEEDS

    work, kept = out / target, CORPUS / target
    for directory in (work, kept):
        directory.mkdir(parents=True, exist_ok=True)
    for n, seed in enumerate(SEEDS[target]):
        (work / f"seed-{n}").write_bytes(seed)
    length = f"-max_len={max(MAX_LENGTH, *map(len, SEEDS[target]))}"
    prefix = f"-artifact_prefix={out}/{target}-"
    status = _child(target, f"-max_total_time={seconds}", length, prefix, *OPTIONS, str(work), str(kept))
    if status == 0:
        _minimise(target, length, prefix, work, kept)
    return status


def _minimise(target: str, length: str, prefix: str, work: Path, kept: Path) -> None:
    smallest = work.with_name(f"{target}-smallest")
    shutil.rmtree(smallest, ignore_errors=True)
    smallest.mkdir()
    if _child(target, "-merge=1", length, prefix, *OPTIONS, str(smallest), str(kept), str(work)) == 0:
        shutil.rmtree(kept)
        smallest.rename(kept)


def _child(target: str, *arguments: str) -> int:
    command = [sys.executable, "-m", "tests.fuzz.run", "--child", target, *arguments]
    environment = os.environ | ({"NUMBA_DISABLE_JIT": "1"} if target in UNCOMPILED else {})
    return subprocess.run(command, check=False, env=environment).returncode


def main() -> int:
    """Run one target, or all of them one after the other."""
    if sys.argv[1] == "--child":
        fuzz(sys.argv[2], sys.argv[3:])
    from tests.fuzz.seeds import SEEDS

    names = list(SEEDS) if sys.argv[1] == "all" else [sys.argv[1]]
    out = Path(sys.argv[3]) if len(sys.argv) > 3 else OUT
    failed = [name for name in names if run(name, int(sys.argv[2]), out)]
    if failed:
        print(f"Findings in {', '.join(failed)}: see {out}", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
