"""Descriptions with random faults through the readers: a bounded part of `fuzz/descriptions.py`."""

from __future__ import annotations

from contextlib import ExitStack

import descriptions
import pytest
from consumers import require
from description_sources import sources

SEED, FILES = 3, 12


@pytest.fixture(scope="module")
def bench() -> descriptions.Bench:
    require(*descriptions.READERS)
    with ExitStack() as stack:
        yield descriptions.Bench(stack)


@pytest.mark.long
def test_nearly_all_refusals_are_predicted(bench: descriptions.Bench) -> None:
    """Of a few files, none that a reader refuses is missed by more than one rule; `.ci/run` tries more."""
    figures = descriptions.examine(bench, sources(), SEED, range(FILES))
    assert figures.predictions == FILES * len(descriptions.READERS)
    assert sum(map(len, figures.wrong.values())) <= 1, figures.wrong
