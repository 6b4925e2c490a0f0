import random
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, strategies as st
from other_fields import with_field

from dh2urdf.errors import CrashError
from dh2urdf.manipulator import Manipulator
from dh2urdf.plugin_system import load
from dh2urdf.run_file.config import load_config
from dh2urdf.run_file.plan import Plan, make_plan
from dh2urdf.source import Mark, Problem
from dh2urdf.stages import ReadsInColumns, Rejected
from dh2urdf.tasks.batch import Batch, Doomed, Expected, batches
from dh2urdf.testing.stage_contract import difference

HEADER = "# convention: standard\nrobot,a,alpha,d\n"


def table(names: Sequence[str]) -> str:
    """Arms of one joint, or of two where the name begins with `long`; one whose name begins with `bad` is none."""
    lines = []
    for number, name in enumerate(names):
        lines.append(f"{name},{'x' if name.startswith('bad') else number / 10},0,0\n")
        if name.startswith("long"):
            lines.append(f"{name},0.5,0,0\n")
    return HEADER + "".join(lines)


@pytest.fixture
def plan(tmp_path: Path) -> Callable[..., Plan]:
    """A run over tables with some more in the run file."""

    def make(more: str = "", **tables: str) -> Plan:
        for name, text in tables.items():
            (tmp_path / f"{name}.csv").write_text(text)
        names = ", ".join(f"{name}.csv" for name in tables)
        (tmp_path / "run.yaml").write_text(f"inputs: [{names}]\n{more}\n")
        return make_plan(load_config(tmp_path / "run.yaml"), load())

    return make


def taken(plan: Plan) -> list[Batch]:
    return list(batches(plan, Expected(plan)))


def whats(batch: Batch) -> dict[int, Any]:
    """What each place of a batch has: a manipulator or its like, or the name of a variant; each place once."""
    found: list[tuple[int, Any]] = list(batch.singles.items())
    for places, columns in batch.columns:
        found += [(place, columns.pick(member)) for member, place in enumerate(places)]
    for start, variants in batch.variants:
        found += enumerate(variants.names, start)
    assert sorted(place for place, _ in found) == list(range(len(batch)))
    return dict(sorted(found))


class TestCutting:
    def test_every_manipulator_is_in_one_batch(self, plan: Callable[..., Plan]) -> None:
        """In the order of the run, with its number, its stem, its source and its table; bad ones too."""
        names = [f"{kind}{number}" for number in range(30) for kind in ("arm", "long", "bad")]
        found = taken(plan(one=table(names), two=table(["arm0", "other"])))
        assert [batch.first for batch in found] == [sum(map(len, found[:i])) for i in range(len(found))]
        assert [name for batch in found for name in batch.names] == [*names, "arm0", "other"]
        assert [Path(source).name for batch in found for source in batch.sources] == ["one.csv"] * 90 + ["two.csv"] * 2
        for batch in found:
            for place, what in whats(batch).items():
                assert what.name == batch.names[place]
                assert isinstance(what, Rejected if what.name.startswith("bad") else Manipulator)
                assert len(getattr(what, "rows", [])) == {"a": 1, "o": 1, "l": 2, "b": 0}[what.name[0]]

    def test_a_stem_that_is_taken_is_told(self, plan: Callable[..., Plan]) -> None:
        """The second one gets another, and a notice at its place; one that cannot be read claims none."""
        (*_, last) = taken(plan("output: {layout: shards}", one=table(["bad", "arm"]), two=table(["arm", "BAD"])))
        assert last.names == ("bad", "arm", "arm", "BAD")
        assert last.stems == ("", "arm", "arm-2", "BAD")
        assert {place: len(notices) for place, notices in last.notices.items()} == {2: 1}
        (notice,) = last.notices[2]
        assert notice.code == "stem-changed"
        assert notice.mark == Mark(file=last.sources[2])
        assert Path(last.sources[2]).name == "two.csv"

    @pytest.mark.parametrize("layout", ["{layout: shards, size: 70}", "{layout: files}"])
    def test_columns_of_a_reader_are_as_its_records(self, plan: Callable[..., Plan], layout: str) -> None:
        """The same groups, places, marks, notices and stems, wherever a batch ends, a first notice included."""
        draw = random.Random(5)  # noqa: S311 - no secret
        kinds = [draw.choice(("arm", "arm", "long", "bad" if number > 300 else "arm")) for number in range(400)]
        names = [f"{kind}{number}" for number, kind in enumerate(kinds)]
        variations = "variations: [{of: long7x, count: 3, vary: [{field: d, joints: all, uniform: [0, 1]}]}]"
        made = plan(f"output: {layout}\n{variations}", one=table([*names, "long7x"]), two=table(["arm0", "y", "z"]))
        notice = Problem(message="seen twice", severity="notice")
        with_columns = replace(made, input_notices={made.inputs[1][0]: notice})
        records = [
            (path, replace(call, stage=with_field(call.stage, "read_columns", None))) for path, call in made.inputs
        ]
        assert all(call.stage.can(ReadsInColumns) for _, call in with_columns.inputs)
        for found, wanted in zip(taken(with_columns), taken(replace(with_columns, inputs=tuple(records))), strict=True):
            assert difference(whats(found), whats(wanted)) is None
            assert sorted(places for places, _ in found.columns) == sorted(places for places, _ in wanted.columns)
            for name in ("first", "names", "stems", "sources", "notices", "of_readers", "tracebacks"):
                assert getattr(found, name) == getattr(wanted, name), name

    def test_cells_and_variants_come_last(self, plan: Callable[..., Plan]) -> None:
        """Variants as ranges of numbers, each variation by itself, cut where a batch is."""
        more = (
            "output: {layout: shards, size: 4}\n"
            "cells: {name: pair, arms: [{name: l, of: arm}, {name: r, of: arm, xyz: [1, 0, 0]}]}\n"
            "variations:\n"
            "  - {of: arm, count: 3, vary: [{joints: 1, field: a, offset: [1, 2]}]}\n"
            "  - {name: other, of: arm, count: 3, vary: [{joints: 1, field: d, offset: [0, 1]}]}\n"
        )
        first, second = taken(plan(more, one=table(["arm"])))
        assert first.names == ("arm", "pair", "arm_1", "arm_2")
        assert second.names == ("arm_3", "other_1", "other_2", "other_3")
        assert [(start, variants.numbers) for start, variants in first.variants] == [(2, range(1, 3))]
        assert [(start, variants.numbers) for start, variants in second.variants] == [
            (0, range(3, 4)),
            (1, range(1, 4)),
        ]
        assert list(whats(second).values()) == list(second.names)
        assert Path(first.sources[2]).name == "run.yaml"


@pytest.fixture(scope="module")
def batch(tmp_path_factory: pytest.TempPathFactory) -> Batch:
    """A batch of everything: alike ones, bad ones, two of one name, variants of two variations."""
    folder = tmp_path_factory.mktemp("parts")
    (folder / "one.csv").write_text(table(["a", "long1", "bad", "b", "long2", "A", "c"]))
    (folder / "run.yaml").write_text(
        "inputs: one.csv\noutput: {layout: shards}\nvariations:\n"
        "  - {of: b, count: 5, vary: [{joints: 1, field: a, offset: [1, 2]}]}\n"
        "  - {name: v, of: b, count: 4, vary: [{joints: 1, field: d, offset: [0, 1]}]}\n"
    )
    (whole,) = taken(make_plan(load_config(folder / "run.yaml"), load()))
    assert len(whole) == 16
    assert len(whole.notices) == 1
    return replace(
        whole, first=100, rows={place: (b"%d" % place,) for place in range(0, 16, 3)}, tracebacks={2: "Traceback"}
    )


class TestParts:
    @given(st.integers(-1, 20))
    def test_its_beginning_is_what_is_made_one_by_one(self, batch: Batch, count: int) -> None:
        """Tables and variants by their names, what is bad in its place."""
        begun = batch.begin(count)
        assert [what.name for what in begun] == list(batch.names[: max(0, count)])
        made = {place: what for place, what in batch.singles.items() if place < count}
        for start, variants in batch.variants:
            made.update(enumerate(variants.part(0, max(0, count - start)).tables(), start))
        assert {place: begun[place] for place in made} == made

    def test_the_doomed_stand_in_their_places(self, batch: Batch) -> None:
        """Whatever was there; all others stay, and none is taken from an earlier run."""
        doomed = {3: Doomed("b", CrashError("it crashed"), None), 9: Doomed("b_3", CrashError("it crashed"), None)}
        rest = batch.without(doomed)
        assert {place: rest.singles[place] for place in doomed} == doomed
        assert rest.singles.keys() == batch.singles.keys() | doomed.keys()
        assert (rest.names, rest.columns, rest.variants, rest.rows) == (batch.names, batch.columns, batch.variants, {})


class TestExpected:
    def test_it_goes_by_the_lines_of_a_file(self, plan: Callable[..., Plan]) -> None:
        """Of a table with a thousand robots, a tenth of the lines are a tenth of the robots; the end is exact."""
        one = plan(one=table([f"arm{number}" for number in range(3000)]))
        expected = Expected(one)
        seen = [(batch.first + len(batch), expected.total) for batch in batches(one, expected)]
        guesses = [total for made, total in seen[:-1] if made > 100]
        assert all(total is not None and 2900 < total < 3100 for total in guesses)
        assert len(guesses) > 5
        assert expected.total == 3000
