"""The audit fails on a known vulnerability and only on that. Reports are those the programs print."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.server import ROOT

SOUND = {"dependencies": [{"name": "numpy", "version": "2.4.0", "vulns": []}], "fixes": []}
VULNERABLE = {
    "dependencies": [
        {"name": "jinja2", "version": "2.4.1", "vulns": [{"id": "PYSEC-2014-8", "fix_versions": ["2.7.2"]}]},
        {"name": "livella", "skip_reason": "Dependency not found on PyPI"},
    ]
}
SKIPPED = {"dependencies": [{"name": "numpy", "skip_reason": "Dependency not found on PyPI"}]}
PAGE_SOUND = {"auditReportVersion": 2, "vulnerabilities": {}}
PAGE_VULNERABLE = {"auditReportVersion": 2, "vulnerabilities": {"lodash": {"severity": "high", "range": "<4.17.21"}}}
PAGE_UNREACHABLE = {"message": "request to https://registry failed", "error": {"summary": "", "detail": ""}}


def audit(directory: Path, python: object, page: object) -> tuple[int, str]:
    """Run the tool with programs that print these reports."""
    for name, report in (("pip-audit", python), ("npm", page)):
        (directory / f"{name}.json").write_text(report if isinstance(report, str) else json.dumps(report))
        program = directory / name
        program.write_text(f"#!/bin/sh\ncat {directory / name}.json\necho 'no route to host' >&2\nexit 1\n")
        program.chmod(0o755)
    done = subprocess.run(
        [sys.executable, ROOT / "tools/audit.py"],
        env=os.environ | {"PATH": f"{directory}:{os.environ['PATH']}"},
        capture_output=True,
        text=True,
        check=False,
    )
    return done.returncode, done.stderr


def test_nothing_known_is_silence(tmp_path: Path) -> None:
    assert audit(tmp_path, SOUND, PAGE_SOUND) == (0, "")


def test_a_known_vulnerability_fails(tmp_path: Path) -> None:
    status, said = audit(tmp_path, VULNERABLE, PAGE_SOUND)
    assert status == 1
    assert "jinja2 2.4.1: PYSEC-2014-8" in said
    assert "NOT AUDITED, Python packages: 1 of 2" in said
    status, said = audit(tmp_path, SOUND, PAGE_VULNERABLE)
    assert status == 1
    assert "lodash: high" in said


@pytest.mark.parametrize(
    ("python", "page", "words"),
    [
        (SKIPPED, PAGE_SOUND, "Python packages: 1 of 1"),
        ("", PAGE_SOUND, "Python packages: no route to host"),
        (SOUND, PAGE_UNREACHABLE, "the page's packages: request to"),
        (SOUND, "rubbish", "the page's packages: no route to host"),
    ],
)
def test_nobody_there_is_said_and_no_failure(tmp_path: Path, python: object, page: object, words: str) -> None:
    status, said = audit(tmp_path, python, page)
    assert status == 0
    assert f"NOT AUDITED, {words}" in said
