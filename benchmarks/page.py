"""The page: how soon it comes and how smoothly it moves. Writes the section on it of docs/performance.md."""

import argparse
import shutil
import sys
import tempfile
from pathlib import Path

from playwright.sync_api import sync_playwright

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from benchmarks.accuracy_study.options import DOCS
from benchmarks.page_study.page import assemble, targets
from benchmarks.page_study.study import carry_out
from benchmarks.sections import write_section
from tests.e2e.visitor import SWITCHES


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="everything once")
    quick = parser.parse_args().quick
    with tempfile.TemporaryDirectory(prefix="livella-page-") as directory, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=SWITCHES)
        study = carry_out(browser, Path(directory), 1 if quick else 5)
        browser.close()
    for one in study.visits:
        print(f"{one.view.name}: {one.script:.0f} kB, usable after {one.usable:.2f} s, slowest {one.slowest:.2f} s")
    for target in targets(study):
        print(f"{target.what}: {target.measured}, wanted {target.wanted}")
    if quick:
        print("page: not written, this was no full run")
        return
    write_section(DOCS / "performance.md", "page", assemble(study))
    print(f"page: wrote {DOCS / 'performance.md'}")


if __name__ == "__main__":
    main()
