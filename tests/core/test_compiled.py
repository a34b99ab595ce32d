"""What the compiled estimator must not do: make arrays as it goes, whose holders are counted one by one."""

from importlib import import_module
from typing import Any

import pytest
from numba.core.runtime.nrt import rtsys

from core import DEFAULT, advance, initial_state
from tests.core.drives import drive

PER_EPOCH = 2
"""arrays made, at most: those of the coarse alignment's solutions and of the drive test; it was 38 once"""


@pytest.mark.compiled
@pytest.mark.parametrize("name", ["city", "city without gyro"])
def test_an_epoch_makes_hardly_any_arrays(name: str) -> None:
    samples = drive(name).samples
    counted: Any = rtsys
    memory = import_module("numba.core.runtime._nrt_python")
    memory.memsys_enable_stats()
    try:
        before = counted.get_allocation_stats().alloc
        advance(DEFAULT, initial_state(DEFAULT), samples)
        made = counted.get_allocation_stats().alloc - before
    finally:
        memory.memsys_disable_stats()
    assert 0 < made <= PER_EPOCH * samples.fix_row.size
