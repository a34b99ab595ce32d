"""A lock between processes, held in turns. SQLite's own waiting is by chance: under load some wait for seconds.

The lock is two files beside the database. Whoever finds it taken, and has nothing else to do, takes the place at the
head of the line (`-next`), there waits for the lock (`-turn`), and then leaves the place to another. A process that has
just let go cannot take the lock again before the one that stands there. The system frees both when a process dies.
"""

import os
import sys
import time
from collections.abc import Callable
from contextlib import suppress

with suppress(ImportError):  # no such locks on Windows: SQLite's own have to do
    import fcntl

PAUSE = 0.0002
"""s between two tries: flock(2) waits for ever or not at all, and who waits here has a time limit"""


class FileLock:
    """The lock of a database file; None makes one that nobody else can want."""

    def __init__(self, path: str | None) -> None:
        self._path = path if "fcntl" in sys.modules else None
        self._files: tuple[int, int] | None = None

    def acquire(self, seconds: float, meanwhile: Callable[[], bool] = lambda: False) -> bool:
        """Wait for the lock, at most so long; tell whether it is ours.

        While another has it, `meanwhile` is called: some other work, False when there is none. Only then is a place in
        the line taken, for there nobody gets past it.
        """
        if self._path is None:
            return True
        if self._files is None:
            self._files = (_open(f"{self._path}-next"), _open(f"{self._path}-turn"))
        deadline = time.monotonic() + seconds
        while not _wait(*self._files, until=0.0):
            if not meanwhile():
                return _wait(*self._files, until=deadline)
        return True

    def release(self) -> None:
        """Let the next one have it."""
        if self._files is not None:
            fcntl.flock(self._files[1], fcntl.LOCK_UN)

    def close(self) -> None:
        """Close the files."""
        for file in self._files or ():
            os.close(file)
        self._files = None


def _open(path: str) -> int:
    return os.open(path, os.O_RDWR | os.O_CREAT | getattr(os, "O_CLOEXEC", 0), 0o644)


def _wait(head: int, lock: int, until: float) -> bool:
    if not _try(head, until):
        return False
    try:
        return _try(lock, until)
    finally:
        fcntl.flock(head, fcntl.LOCK_UN)


def _try(file: int, until: float) -> bool:
    while True:
        with suppress(BlockingIOError):
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            return True
        if time.monotonic() > until:
            return False
        time.sleep(PAUSE)
