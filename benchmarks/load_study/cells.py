"""The cells of the study: what serves, on what database, what is sent, and how many devices are wanted."""

from typing import NamedTuple

from benchmarks.load_study import slow_disk
from benchmarks.load_study.drives import ARROW, CSV
from tests.postgres import find_program

SQLITE, POSTGRESQL = "SQLite", "PostgreSQL"
P99 = {CSV: 0.3, ARROW: 0.2}
"""s a device may wait for its answer in 99 of 100 cases"""
STEPS = 16
"""a count is found to within this part of the one tried first"""


class Cell(NamedTuple):
    """What is held against what."""

    database: str
    encoding: str
    devices: int
    """tried first"""
    fsync: float = 0.0
    """s by which every fsync is made slower"""
    naive: bool = False
    """the baseline serves"""
    beyond: bool = False
    """look for the largest count held also above the one tried first"""

    @property
    def limit(self) -> float:
        """The p99 within which a count is held, s."""
        return P99[self.encoding]

    @property
    def step(self) -> int:
        """Devices between counts that are worth telling apart."""
        return max(1, self.devices // STEPS)

    @property
    def words(self) -> str:
        """What it is, for people."""
        return f"{self.database}, {self.encoding}" + (f", fsync {1e3 * self.fsync:g} ms slower" if self.fsync else "")


NAIVE = "naive"
BESIDE = "sqlite-csv"
"""the cell that the baseline is compared with"""
CELLS = {
    BESIDE: Cell(SQLITE, CSV, 10_000, beyond=True),
    "sqlite-arrow": Cell(SQLITE, ARROW, 30_000),
    "postgres-csv": Cell(POSTGRESQL, CSV, 8_000),
    "postgres-arrow": Cell(POSTGRESQL, ARROW, 15_000),
    "sqlite-csv-fsync": Cell(SQLITE, CSV, 5_000, fsync=5e-3),
    NAIVE: Cell(SQLITE, CSV, 3_000, naive=True, beyond=True),
}


def why_not(cell: Cell) -> str | None:
    """Say why a cell cannot be measured here, None when it can."""
    if cell.fsync and slow_disk.compiler() is None:
        return "gcc is needed to make fsyncs slower"
    if cell.fsync and cell.database == POSTGRESQL:
        return "the server of PostgreSQL is started by other programs, its fsyncs cannot be made slower"
    if cell.database == POSTGRESQL and None in {find_program("initdb"), find_program("pg_ctl")}:
        return "PostgreSQL is not installed"
    return None
