"""Batches: whoever waits gets what is theirs, and nothing that was accepted is left undone."""

import asyncio
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import pytest

from api.batches import Another, Batches, Work


@contextmanager
def batches(work: Work[int, int], most: int = 3, threads: int = 1) -> Iterator[Batches[int, int]]:
    made = Batches(work, threads, most, 5, "test")
    try:
        yield made
    finally:
        made.close()


class Held:
    """Work that waits until it is let go, and notes the batches."""

    def __init__(self) -> None:
        self.seen: list[list[int]] = []
        self.begun = threading.Event()
        self.go = threading.Event()

    def __call__(self, items: Sequence[int], _: Another[int]) -> list[int | Exception]:
        self.seen.append(list(items))
        self.begun.set()
        assert self.go.wait(20)
        return [10 * item for item in items]


def test_what_comes_in_while_one_is_worked_on_makes_the_next() -> None:
    work = Held()

    async def run(made: Batches[int, int]) -> list[int]:
        first = asyncio.create_task(made.do(0))
        assert await asyncio.to_thread(work.begun.wait, 20)
        rest = [asyncio.create_task(made.do(item)) for item in range(1, 6)]
        await asyncio.sleep(0.05)
        work.go.set()
        return await asyncio.gather(first, *rest)

    with batches(work) as made:
        assert asyncio.run(run(made)) == [0, 10, 20, 30, 40, 50]
    assert work.seen == [[0], [1, 2, 3], [4, 5]]


class Greedy(Held):
    """Work that, when it is let go, adds to its batch what it can, and fails if it may."""

    fails = False

    def __call__(self, items: Sequence[int], another: Another[int]) -> list[int | Exception]:
        done = super().__call__(items, another)
        while (item := another()) is not None:
            self.seen[-1].append(item)
            done.append(10 * item)
        if self.fails:
            raise RuntimeError("broken")
        return done


async def _seven(made: Batches[int, int], work: Held) -> list[int | BaseException]:
    tasks = [asyncio.create_task(made.do(item)) for item in range(7)]
    assert await asyncio.to_thread(work.begun.wait, 20)
    await asyncio.sleep(0.05)
    closing = asyncio.create_task(asyncio.to_thread(made.close))
    await asyncio.sleep(0.05)
    work.go.set()
    await closing
    return await asyncio.gather(*tasks, return_exceptions=True)


def test_work_adds_to_its_batch_what_comes_in_as_far_as_there_is_place() -> None:
    work = Greedy()
    made = Batches(work, 1, 1, 5, "test")
    assert asyncio.run(_seven(made, work)) == [0, 10, 20, 30, 40, 50, 60]
    assert work.seen == [[0, 1, 2, 3, 4], [5, 6]]


def test_what_was_added_fails_with_its_batch() -> None:
    work = Greedy()
    work.fails = True
    assert [str(error) for error in asyncio.run(_seven(Batches(work, 1, 1, 5, "test"), work))] == ["broken"] * 7


def test_an_error_reaches_only_whoever_it_belongs_to() -> None:
    def work(items: Sequence[int], _: Another[int]) -> list[int | Exception]:
        return [ValueError(item) if item % 2 else item for item in items]

    async def run(made: Batches[int, int]) -> list[int | BaseException]:
        return await asyncio.gather(*(made.do(item) for item in range(6)), return_exceptions=True)

    with batches(work) as made:
        found = asyncio.run(run(made))
    assert found[::2] == [0, 2, 4]
    assert [str(error) for error in found[1::2]] == ["1", "3", "5"]


def test_work_that_fails_fails_for_its_batch_and_goes_on() -> None:
    def work(items: Sequence[int], _: Another[int]) -> list[int | Exception]:
        if 0 in items:
            raise RuntimeError("broken")
        return list(items)

    with batches(work, most=1) as made:
        with pytest.raises(RuntimeError, match="broken"):
            asyncio.run(made.do(0))
        assert asyncio.run(made.do(1)) == 1


def test_whoever_gives_up_stops_nothing() -> None:
    work = Held()

    async def run(made: Batches[int, int]) -> int:
        task = asyncio.create_task(made.do(1))
        assert await asyncio.to_thread(work.begun.wait, 20)
        task.cancel()
        with pytest.raises(asyncio.CancelledError):
            await task
        work.go.set()
        return await made.do(2)

    with batches(work) as made:
        assert asyncio.run(run(made)) == 20
    assert work.seen == [[1], [2]]


def test_closing_finishes_what_was_accepted() -> None:
    work = Held()

    async def run(made: Batches[int, int]) -> list[int]:
        tasks = [asyncio.create_task(made.do(item)) for item in range(5)]
        assert await asyncio.to_thread(work.begun.wait, 20)
        closing = asyncio.create_task(asyncio.to_thread(made.close))
        await asyncio.sleep(0.05)
        work.go.set()
        await closing
        return await asyncio.gather(*tasks)

    made = Batches(work, 2, 2, 2, "test")
    assert asyncio.run(run(made)) == [0, 10, 20, 30, 40]
