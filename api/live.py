"""The live stream inside one process: one task reads the events of the database, every listener follows its memory.

A commit in this process wakes the task at once; commits of other processes are found by looking about once a second.
While nobody listens nothing is read.
"""

import asyncio
import logging
from bisect import bisect_right
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from anyio import to_thread

from storage import events
from storage.database import Database
from storage.events import Event, Position

log = logging.getLogger(__name__)

POLL_INTERVAL = 1.0
"""s between two looks for events of other processes"""
PAUSE = 0.05
"""s between two looks at least: under load many commits are read at once"""
IDLE_INTERVAL = 15.0
"""s after which a listener without events gets an empty batch, to see to other things"""
MEMORY = 10_000
"""events remembered; a listener further behind reads from the database"""


class Hub:
    """Follows the events of the database for the listeners of this process."""

    def __init__(self, database: Database) -> None:
        self.database = database
        self._recent: list[Event] = []
        self._floor = Position(0, 0)
        """everything after this is in `_recent`, as far as it has been read"""
        self._news = asyncio.Event()
        self._wake = asyncio.Event()
        self._listeners = 0
        self._closed = False
        self._loop: asyncio.AbstractEventLoop | None = None

    @property
    def _position(self) -> Position:
        return self._recent[-1].position if self._recent else self._floor

    async def run(self) -> None:
        """Read events until `close`."""
        self._loop = asyncio.get_running_loop()
        while not self._closed:
            if self._listeners:
                await self._look()
            await asyncio.sleep(PAUSE)
            await _wait(self._wake, POLL_INTERVAL)
            self._wake.clear()

    async def _look(self) -> None:
        try:
            self._remember(await to_thread.run_sync(self._read, self._position))
        except Exception:
            log.exception("the live stream cannot read events")

    @asynccontextmanager
    async def listening(self) -> AsyncIterator[Position]:
        """Listen inside the block; gives where the stream is now, to `follow` it from there."""
        now = await to_thread.run_sync(self._latest)
        if self._listeners == 0:  # what came meanwhile was not read
            self._recent, self._floor = [], now
        self._listeners += 1
        self._wake.set()
        try:
            yield now
        finally:
            self._listeners -= 1

    async def follow(self, position: Position) -> AsyncIterator[list[Event]]:
        """Give the events after a position in batches as they come, an empty one now and then; ends with `close`.

        Only while `listening`.
        """
        while not self._closed:
            news = self._news
            batch = await self._after(position)
            if batch:
                position = batch[-1].position
            elif position < self._floor:
                position = self._floor
            else:
                await _wait(news, IDLE_INTERVAL)
            yield batch

    def wake(self) -> None:
        """Look for events now, if anybody listens; from any thread."""
        if self._listeners:
            self._call(self._wake.set)

    def close(self) -> None:
        """End every stream; from any thread or a signal handler."""
        self._closed = True
        self._call(self._announce)
        self._call(self._wake.set)

    def _call(self, action: object) -> None:
        if self._loop is not None and not self._loop.is_closed():
            self._loop.call_soon_threadsafe(action)  # type: ignore[arg-type]

    def _announce(self) -> None:
        """Wake every listener; the next news have an event of their own."""
        self._news.set()
        self._news = asyncio.Event()

    def _remember(self, found: list[Event]) -> None:
        if not found:
            return
        self._recent += found
        surplus = len(self._recent) - MEMORY
        if surplus > 0:
            self._floor = self._recent[surplus - 1].position
            del self._recent[:surplus]
        self._announce()
        self._wake.set()  # there may be more

    async def _after(self, position: Position) -> list[Event]:
        if position < self._floor:
            return await to_thread.run_sync(self._read, position)
        return self._recent[bisect_right(self._recent, position, key=lambda event: event.position) :]

    def _latest(self) -> Position:
        with self.database.read() as tx:
            return events.latest(tx)

    def _read(self, position: Position) -> list[Event]:
        with self.database.read() as tx:
            return events.after(tx, position)


async def _wait(event: asyncio.Event, seconds: float) -> None:
    try:
        await asyncio.wait_for(event.wait(), seconds)
    except TimeoutError:
        return
