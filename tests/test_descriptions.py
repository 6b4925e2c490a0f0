"""Descriptions with random faults through the readers: a bounded part of `fuzz/descriptions.py`, and that it finds what is wrong."""

from contextlib import ExitStack

import descriptions
import pytest
from consumers import require
from description_sources import sources
from description_tree import read
from faulty_files import SOUND

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


@pytest.mark.long
def test_a_wrong_rule_is_found_and_its_file_made_small(
    bench: descriptions.Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where no rule speaks, every refusal is missed, and the smallest file with it is a fraction of the first one."""
    nothing = {consumer: descriptions.Prediction([], []) for consumer in descriptions.READERS}
    monkeypatch.setattr(descriptions, "predicted", lambda _: nothing)
    monkeypatch.setattr(descriptions, "difference", lambda *_: "")
    robots = sources()
    figures = descriptions.examine(bench, robots, SEED, range(FILES))
    assert {wrong.kind for wrong in figures.wrong} == {"missed"}
    wrong, (index, *_) = next((w, found) for w, found in figures.wrong.items() if w.consumer == "mujoco")
    assert any(f"missed mujoco, first {index}:" in line for line in descriptions.lines(figures))
    first = descriptions.case(SEED, index, robots)
    smallest = bench.shrunk(first, wrong)
    assert 2 * len(smallest.tree.written()) < len(first.tree.written())


def test_a_change_that_no_rule_predicts_is_found(bench: descriptions.Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    """MuJoCo takes the magnitude of a negative effort; the sound file is loaded as it is."""
    nothing = {consumer: descriptions.Prediction([], []) for consumer in descriptions.READERS}
    robot = read(SOUND)
    same = list(bench.tried(descriptions.Case(robot, "plain", ())))
    assert [tried.wrong for tried in same] == [None] * len(descriptions.READERS)
    assert all(tried.compared for tried in same)
    monkeypatch.setattr(descriptions, "predicted", lambda _: nothing)
    spoilt = read(SOUND.replace('effort="20"', 'effort="-20"'))
    found = {tried.consumer: tried.wrong for tried in bench.tried(descriptions.Case(spoilt, "plain", ()), ["mujoco"])}
    assert found == {
        "mujoco": descriptions.Wrong("mujoco", "altered", (), "effort of a revolute joint is ~, not ~"),
    }
