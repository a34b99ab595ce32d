"""Many runs on all cores, in processes that are started afresh."""

import multiprocessing
import os
import sys
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from typing import TypeVar

import core
from core.simulation import Scenario, simulate

Item = TypeVar("Item")
Result = TypeVar("Result")

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")


def warm_up() -> None:
    """Compile the estimator once, so that every process finds it in the cache."""
    samples = simulate(Scenario(seconds=2.0)).samples
    core.advance(core.DEFAULT, core.initial_state(core.DEFAULT), samples)


def run(label: str, function: Callable[[Item], Result], items: Sequence[Item]) -> list[Result]:
    """Apply a function of a module to items, in order, telling on stderr how far it is."""
    begin, results = time.monotonic(), list[Result]()
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(os.cpu_count(), mp_context=context) as pool:
        for result in pool.map(function, items, chunksize=max(1, min(8, len(items) // 40))):
            results.append(result)
            if len(results) % max(1, len(items) // 20) == 0:
                seconds = time.monotonic() - begin
                print(f"{label}: {len(results)} of {len(items)}, {seconds:.0f} s", file=sys.stderr, flush=True)
    return results
