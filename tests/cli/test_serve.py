"""A server process as `livella serve` makes it."""

import subprocess
import sys
from pathlib import Path

from tests.cli import livella

PROGRAM = """
import gc, time
from fastapi.testclient import TestClient
from api.commands import serve
with TestClient(serve.app()) as client:
    before = gc.get_freeze_count()
    while client.get("/readyz").status_code != 200:
        time.sleep(0.1)
    print(before, gc.get_freeze_count())
"""


def test_the_garbage_collector_passes_over_what_lasts(tmp_path: Path) -> None:
    environment = livella.environment(LIVELLA_DATA_DIR=str(tmp_path))
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM], capture_output=True, text=True, env=environment, timeout=300, check=True
    )
    _, frozen = map(int, done.stdout.split())
    assert frozen > 50_000
