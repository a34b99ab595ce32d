"""A library put in front of the C library that counts fsyncs and makes them as slow as those of a real disk."""

import shutil
import struct
import subprocess
from functools import cache
from pathlib import Path
from typing import NamedTuple

SOURCE = Path(__file__).with_name("fsync.c")


class Disk(NamedTuple):
    """How the service's processes see the disk."""

    environment: dict[str, str]
    """to start them with"""
    counter: Path | None
    """None: fsyncs are not counted"""

    def fsyncs(self) -> float:
        """Tell how many there were, nan when nobody counts."""
        return float("nan") if self.counter is None else float(struct.unpack("<q", self.counter.read_bytes())[0])


@cache
def compiler() -> str | None:
    """Find a C compiler."""
    return shutil.which("gcc")


def prepare(directory: Path, delay: float = 0.0) -> Disk:
    """Make the library, for fsyncs that last `delay` s longer; without a compiler nothing is counted."""
    gcc = compiler()
    if gcc is None:
        return Disk({}, None)
    library, counter = directory / "fsync.so", directory / "fsyncs"
    command = [gcc, "-O2", "-shared", "-fPIC", "-o", str(library), str(SOURCE), "-ldl"]
    subprocess.run(command, check=True)  # noqa: S603 - our own source
    counter.write_bytes(struct.pack("<q", 0))
    shown = {"LD_PRELOAD": str(library), "LIVELLA_FSYNC_COUNT": str(counter), "LIVELLA_FSYNC_MS": f"{1e3 * delay:g}"}
    return Disk(shown, counter)
