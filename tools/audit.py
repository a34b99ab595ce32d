"""Looks up whether the pinned packages have known vulnerabilities: Python's with pip-audit, the page's with npm audit.

Ends with 1 if there are any. Where nobody answers, it says on stderr what was not looked up, and that is no failure: a
build must not depend on another's service.
"""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any, NamedTuple

ROOT = Path(__file__).parent.parent
PYTHON = [
    "pip-audit",
    "-r",
    "requirements.lock",
    "--no-deps",
    "--disable-pip",
    "-f",
    "json",
    "--progress-spinner",
    "off",
]
PAGE = ["npm", "audit", "--json"]
SECONDS = 120


class Audit(NamedTuple):
    """What was found out."""

    vulnerable: list[str]
    unknown: str | None
    """what could not be looked up, and why"""


def read_python(text: str, complaint: str) -> Audit:
    """Read the report of pip-audit."""
    try:
        packages: list[dict[str, Any]] = json.loads(text)["dependencies"]
    except (ValueError, KeyError, TypeError):
        return Audit([], _last_line(complaint))
    found = [
        f"{package['name']} {package['version']}: {vulnerability['id']}"
        for package in packages
        for vulnerability in package.get("vulns", [])
    ]
    skipped = [package for package in packages if "skip_reason" in package]
    if not skipped:
        return Audit(found, None)
    return Audit(found, f"{len(skipped)} of {len(packages)} packages, the first because: {skipped[0]['skip_reason']}")


def read_page(text: str, complaint: str) -> Audit:
    """Read the report of npm audit."""
    try:
        report: dict[str, Any] = json.loads(text)
        found = [f"{name}: {what['severity']}" for name, what in report["vulnerabilities"].items()]
    except ValueError:
        return Audit([], _last_line(complaint))
    except (KeyError, TypeError, AttributeError):
        return Audit([], str(report.get("message") or _last_line(complaint)))
    return Audit(found, None)


def _last_line(text: str) -> str:
    return (text.strip() or "no answer").splitlines()[-1]


def ask(command: list[str], directory: Path) -> tuple[str, str]:
    """Run a command that reports on stdout; give that and what it complained of."""
    try:
        done = subprocess.run(  # noqa: S603 - commands of this file
            command, cwd=directory, capture_output=True, text=True, timeout=SECONDS, check=False
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        return "", str(error)
    return done.stdout, done.stderr


def main() -> int:
    """Audit both; give the exit status."""
    audits = {
        "Python packages": read_python(*ask(PYTHON, ROOT)),
        "the page's packages": read_page(*ask(PAGE, ROOT / "web")),
    }
    for name, audit in audits.items():
        if audit.unknown is not None:
            print(f"NOT AUDITED, {name}: {audit.unknown}", file=sys.stderr)
        for line in audit.vulnerable:
            print(f"VULNERABLE, {name}: {line}", file=sys.stderr)
    return 1 if any(audit.vulnerable for audit in audits.values()) else 0


if __name__ == "__main__":
    sys.exit(main())
