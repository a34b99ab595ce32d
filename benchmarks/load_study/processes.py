"""What processes cost, from /proc."""

import os
from pathlib import Path
from typing import NamedTuple

PROC = Path("/proc")
TICK = 1.0 / os.sysconf("SC_CLK_TCK")
MIB = 1024.0


class Process(NamedTuple):
    """A process as it stands."""

    pid: int
    parent: int
    cpu: float
    """s of user and system time"""


def snapshot() -> dict[int, Process]:
    """Give every process."""
    found = (read(int(entry.name)) for entry in PROC.iterdir() if entry.name.isdigit())
    return {process.pid: process for process in found if process is not None}


def read(pid: int) -> Process | None:
    """Give a process, None when it has ended."""
    try:
        text = (PROC / str(pid) / "stat").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return None
    return parse(pid, text)


def parse(pid: int, stat: str) -> Process:
    """Read a line of /proc/PID/stat; the name in brackets may hold anything."""
    fields = stat.rpartition(")")[2].split()
    return Process(pid, int(fields[1]), (int(fields[11]) + int(fields[12])) * TICK)


def family(root: int) -> list[Process]:
    """Give a process and all that descend from it."""
    everyone = snapshot()
    chosen, wanted = [], [root]
    while wanted:
        pid = wanted.pop()
        if pid in everyone:
            chosen.append(everyone[pid])
            wanted += [process.pid for process in everyone.values() if process.parent == pid]
    return chosen


def cpu(root: int) -> float:
    """Give the s of CPU of a process and all that descend from it."""
    return sum(process.cpu for process in family(root))


def rss(root: int) -> list[float]:
    """Give the MiB of memory of the processes that descend from one, largest first."""
    return sorted((_rss(process.pid) for process in family(root) if process.pid != root), reverse=True)


def _rss(pid: int) -> float:
    try:
        lines = (PROC / str(pid) / "status").read_text(encoding="utf-8").splitlines()
    except OSError:
        return 0.0
    return next((int(line.split()[1]) / MIB for line in lines if line.startswith("VmRSS:")), 0.0)
