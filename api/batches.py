"""Work that is done in batches: what comes in while one batch is worked on makes the next, or is added to it.

Threads that work on a request each take the interpreter from one another all the time, and under load that costs more
than it gains. A few threads that take what has gathered go through it undisturbed, and share what a batch needs once.
"""

import asyncio
import threading
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import partial
from queue import Empty, SimpleQueue
from typing import Generic, NamedTuple, TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")


class _Waiting(NamedTuple, Generic[Item, Result]):
    item: Item
    done: "asyncio.Future[Result]"
    loop: asyncio.AbstractEventLoop


Another = Callable[[], Item | None]
"""Adds one more item that has come in to the batch, and gives it; None when there is none, or no place."""
Work = Callable[[Sequence[Item], Another[Item]], Sequence[Result | Exception]]
"""Gives for each item, in the order in which they came to it, its result, or the exception that whoever waits for it
shall see."""


class Batches(Generic[Item, Result]):
    """Threads that work through a queue."""

    def __init__(self, work: Work[Item, Result], threads: int, most: int, grown: int, name: str) -> None:
        """Start the threads.

        Parameters
        ----------
        work
            what is done with a batch
        threads
            that work at the same time
        most
            items in a batch at first
        grown
            items in a batch with those that are added to it
        name
            of the threads
        """
        self._work = work
        self._most = most
        self._grown = grown
        self._queue: SimpleQueue[_Waiting[Item, Result] | None] = SimpleQueue()
        self._threads = [threading.Thread(target=self._run, name=f"{name}-{i}", daemon=True) for i in range(threads)]
        for thread in self._threads:
            thread.start()

    async def do(self, item: Item) -> Result:
        """Wait until an item is worked on and give its result; whoever gives up waiting does not stop the work."""
        loop = asyncio.get_running_loop()
        done: asyncio.Future[Result] = loop.create_future()
        self._queue.put(_Waiting(item, done, loop))
        return await done

    def close(self) -> None:
        """Finish what is queued, and end the threads."""
        for _ in self._threads:
            self._queue.put(None)
        for thread in self._threads:
            thread.join()

    def _run(self) -> None:
        while (first := self._queue.get()) is not None:
            batch = [first]
            while self._grow(batch, self._most):
                continue
            self._finish(batch)

    def _grow(self, batch: list[_Waiting[Item, Result]], most: int) -> bool:
        """Take one more that has gathered, tell whether there was one."""
        if len(batch) >= most:
            return False
        with suppress(Empty):
            waiting = self._queue.get_nowait()
            if waiting is not None:
                batch.append(waiting)
                return True
            self._queue.put(None)  # the end, seen again when this batch is done
        return False

    def _another(self, batch: list[_Waiting[Item, Result]]) -> Item | None:
        return batch[-1].item if self._grow(batch, self._grown) else None

    def _finish(self, batch: list[_Waiting[Item, Result]]) -> None:
        try:
            results = self._work([waiting.item for waiting in batch], partial(self._another, batch))
        except Exception as error:
            results = [error] * len(batch)
        for loop in {waiting.loop for waiting in batch}:  # it is one, and woken once for all
            told = [pair for pair in zip(batch, results, strict=True) if pair[0].loop is loop]
            with suppress(RuntimeError):  # the loop has ended, and nobody waits in it
                loop.call_soon_threadsafe(_tell, told)


def _tell(batch: Sequence[tuple[_Waiting[Item, Result], Result | Exception]]) -> None:
    for waiting, result in batch:
        if waiting.done.done():
            continue  # whoever waited has given up
        if isinstance(result, Exception):
            waiting.done.set_exception(result)
        else:
            waiting.done.set_result(result)
