"""Two databases with the same fleet: in one a year has passed, in the other everything is new."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from pydantic import SecretStr

from api import schemas
from api.services import fleet, startup
from api.services.context import Context
from api.settings import Settings
from benchmarks.age_study.databases import Maker, settle_down
from benchmarks.age_study.past import NOW, YEAR, add_alerts, add_fleet, add_past, copy_past

SENDS, CHARTED = "sends-{:02}", "charted"


class Size(NamedTuple):
    """How much there is."""

    devices: int = 100_000
    senders: int = 20
    """of them, which go on sending"""
    alerts_each: int = 10
    """resolved in a year"""
    days: int = YEAR
    sessions_a_day: int = 5
    hours: float = 1.6
    """of a session"""


class Pair(NamedTuple):
    """What is compared."""

    old: Context
    fresh: Context
    size: Size

    @property
    def senders(self) -> list[str]:
        """The devices that send, in either database."""
        return [SENDS.format(n) for n in range(self.size.senders)]


@contextmanager
def pair(maker: Maker, directory: Path, size: Size) -> Iterator[Pair]:
    """Make both."""
    url = maker.empty()
    fresh = _context(url, directory)
    startup.prepare(fresh)
    for n in range(size.senders):
        name = SENDS.format(n)
        fleet.register(fresh, schemas.DeviceDraft(id=name, name=name))
    add_fleet(fresh.database, range(size.senders + 1, size.devices + 1))
    fresh.database.close()
    old = _context(maker.twin(url), directory)
    fresh = _context(url, directory)
    try:
        _grow_old(old, size)
        add_past(fresh, CHARTED, 1, size.sessions_a_day, size.hours)
        for context in (old, fresh):
            settle_down(context.database)
        yield Pair(old, fresh, size)
    finally:
        old.database.close()
        fresh.database.close()


def _context(url: str, directory: Path) -> Context:
    return Context.make(Settings(database_url=SecretStr(url), data_dir=directory), lambda: NOW)


def _grow_old(context: Context, size: Size) -> None:
    add_alerts(context.database, size.devices, size.alerts_each)
    model = add_past(context, CHARTED, size.days, size.sessions_a_day, size.hours)
    for name in (SENDS.format(n) for n in range(size.senders)):
        with context.database.read() as tx:
            to = fleet.number(tx, name)
        copy_past(context.database, model, to)
