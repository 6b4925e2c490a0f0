"""Descriptions with random faults through the readers: a bounded part of `fuzz/descriptions.py`, and that it finds what is wrong."""

from __future__ import annotations

from contextlib import ExitStack

import descriptions
import pytest
from description_sources import sources

SEED, FILES = 3, 12


@pytest.fixture(scope="module")
def bench() -> descriptions.Bench:
    with ExitStack() as stack:
        yield descriptions.Bench(stack)


def test_nearly_all_refusals_are_predicted(bench: descriptions.Bench) -> None:
    """Of a few files, none that a reader refuses is missed by more than one rule; `.ci/run` tries more."""
    figures = descriptions.examine(bench, sources(), SEED, range(FILES))
    assert figures.predictions == FILES * len(descriptions.READERS)
    assert sum(map(len, figures.wrong.values())) <= 1, figures.wrong


def test_a_wrong_rule_is_found_and_its_file_made_small(
    bench: descriptions.Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where no rule speaks, every refusal is missed, and the smallest file with it is a fraction of the first one."""
    monkeypatch.setattr(descriptions, "predicted", lambda _: {consumer: [] for consumer in descriptions.READERS})
    robots = sources()
    figures = descriptions.examine(bench, robots, SEED, range(FILES))
    assert {wrong.kind for wrong in figures.wrong} == {"missed"}
    wrong, (index, *_) = next((w, found) for w, found in figures.wrong.items() if w.consumer == "mujoco")
    assert any(f"missed mujoco, first {index}:" in line for line in descriptions.lines(figures))
    first = descriptions.case(SEED, index, robots)
    smallest = bench.shrunk(first, wrong)
    assert 2 * len(smallest.tree.written()) < len(first.tree.written())
