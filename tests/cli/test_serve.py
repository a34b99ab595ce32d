"""A server process as `livella serve` makes it."""

import platform
import subprocess
import sys
from pathlib import Path

import pytest

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


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="only glibc is told to keep memory")
def test_memory_that_was_given_back_is_kept() -> None:
    program = """
import resource, numpy
from api.commands import serve
serve.keep_memory()
def faults():
    before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
    for _ in range(20):
        [numpy.ones(250_000) for _ in range(8)]
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before
faults()
print(faults())
"""
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, env=livella.environment(), check=True
    )
    assert int(done.stdout) < 8000  # one for each page would be 78,000
