import json
import subprocess
import sys

import pytest
from typer.testing import CliRunner

from api.cli import app

COMMANDS = [
    *(
        "serve",
        "replay",
        "calibrate",
        "attitude",
        "characterise",
        "steering",
        "motion",
        "simulate",
        "upload",
        "demo",
        "keys",
        "db",
    ),
    "openapi",
]


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_explains_itself(command: str) -> None:
    done = CliRunner().invoke(app, [command, "--help"])
    assert done.exit_code == 0
    assert "Usage" in done.stdout


def test_help_is_quick_because_nothing_heavy_is_loaded() -> None:
    program = (
        f"import sys; sys.argv = ['livella', '--help']; import api.cli; print([m for m in {HEAVY} if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


HEAVY = ["numba", "scipy", "sqlalchemy", "fastapi", "pyarrow"]


def test_an_unknown_command() -> None:
    assert CliRunner().invoke(app, ["fly"]).exit_code == 2


def test_openapi_is_printed() -> None:
    done = CliRunner().invoke(app, ["openapi"])
    assert "/api/v1/devices/{device_id}/chunks" in json.loads(done.stdout)["paths"]
