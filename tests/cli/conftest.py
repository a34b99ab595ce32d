"""Simulated drives as files."""

import json
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from tests.cli import livella


class Log(NamedTuple):
    path: Path
    truth: dict[str, Any]


@pytest.fixture(scope="session")
def drive(tmp_path_factory: pytest.TempPathFactory) -> Log:
    """A drive in town, long enough to be confirmed."""
    path = tmp_path_factory.mktemp("drive") / "drive.csv.gz"
    done = livella.run("simulate", path, "--seconds", 330, "--seed", 3, "--mount", "100,-20,15")
    assert done == (0, "", "")
    return Log(path, json.loads(Path(f"{path}.truth.json").read_text()))
