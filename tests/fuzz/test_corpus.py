"""What fuzzing found worth keeping is read on each run: nothing harms, and nothing takes long."""

import time
from pathlib import Path

import pytest

from tests.fuzz.seeds import SEEDS
from tests.fuzz.targets import TARGETS

CORPUS = Path(__file__).parent / "corpus"
LONGEST = 2.0
"""s for one input on a busy machine, when everything is compiled"""
MAX_CORPUS_BYTES = 1_000_000


def corpus(target: str) -> list[bytes]:
    return [file.read_bytes() for file in sorted((CORPUS / target).glob("*"))]


@pytest.mark.parametrize("target", TARGETS)
def test_no_input_harms(target: str) -> None:
    TARGETS[target](SEEDS[target][0])  # compiles what has to be compiled
    for data in SEEDS[target] + corpus(target):
        begun = time.process_time()
        TARGETS[target](data)
        assert time.process_time() - begun < LONGEST, data


def test_the_corpus_is_small_and_complete() -> None:
    assert SEEDS.keys() == TARGETS.keys()
    assert {file.name for file in CORPUS.iterdir()} <= TARGETS.keys()
    assert sum(file.stat().st_size for file in CORPUS.glob("*/*")) < MAX_CORPUS_BYTES
