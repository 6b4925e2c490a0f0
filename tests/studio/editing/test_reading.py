from dataclasses import replace
from pathlib import Path

import pytest

from dh2urdf.plugin_system import Catalog
from dh2urdf.source import in_file_order
from dh2urdf.stages import WritesTables
from dh2urdf.table_text import TableText
from dh2urdf_studio.editing import edits
from dh2urdf_studio.editing.reading import make, read, read_whole

GOOD = TableText(
    name="x",
    convention="standard",
    rows=({"joint": "one", "a": "0.3", "alpha": "pi/2", "d": "0"}, {"joint": "two", "a": "1", "alpha": "0", "d": "0"}),
)


def changed(table: TableText = GOOD, **cells: str) -> TableText:
    """The table with other texts in cells of its second row."""
    return edits.with_cells(table, {(1, field): text for field, text in cells.items()})


@pytest.mark.parametrize(
    ("cells", "where"),
    [
        ({"alpha": "pi/x"}, (1, "alpha")),
        ({"a": "1.234,5"}, (1, "a")),
        ({"d": "90°"}, (1, "d")),
        ({"type": "spherical"}, (1, "type")),
        ({"joint": "one"}, (1, "joint")),
        ({"joint": "tool0"}, (1, "joint")),
        ({"theta": "q1"}, (1, "theta")),
        ({"lower": "1"}, (1, "upper")),
        ({"lower": "2", "upper": "1"}, (1, "lower")),
        ({"alpha": "90"}, (1, "alpha")),
        ({"a": ""}, (1, "a")),
        ({"mass": "-1"}, (1, "mass")),
    ],
)
def test_a_wrong_cell_is_found_with_the_readers_words(
    catalog: Catalog, tmp_path: Path, cells: dict[str, str], where: tuple[int, str]
) -> None:
    """The message of a cell is the one that the reader gives for the saved file, and it is said of that cell."""
    table = changed(**cells)
    found = read_whole(table, catalog)
    assert found.manipulator is None
    assert where in [(problem.row, problem.field) for problem in found.errors]
    reader = catalog.get("reader", "csv")
    writes = reader.can(WritesTables)
    path = tmp_path / "x.csv"
    path.write_bytes(writes.write([table]).content)
    (rejected,) = reader.read(path, reader.options())
    problems = in_file_order((*rejected.notices, *rejected.problems))
    said = [problem.message.replace(f"{path}:4", "row 1") for problem in problems]
    assert said == [item.problem.message for item in found.problems]
    for problem in found.errors:
        assert problem.text.startswith(problem.problem.message)


def test_what_is_wrong_with_the_whole_table_has_no_cell(catalog: Catalog) -> None:
    """A base that cannot be read is said of the base, a missing convention of no cell at all."""
    (found,) = read_whole(replace(GOOD, base="{xyz: [0, 0]}"), catalog).problems
    assert (found.row, found.field) == (None, "base")
    (found,) = read_whole(replace(GOOD, convention=""), catalog).problems
    assert (found.row, found.field) == (None, "convention")
    assert "convention" in found.text


def test_what_the_transform_refuses_has_its_cell(catalog: Catalog) -> None:
    """A refusal of the paper's variant names the row and the field that it has no place for."""
    table = changed(theta="0.1")
    arm = read_whole(table, catalog).manipulator
    assert arm is not None
    made = make(arm, "paper", table, catalog)
    assert made[0] is None
    assert [(found.row, found.field) for found in made[1]] == [(1, "theta")]


def test_rows_that_nobody_has_begun_are_waited_for(catalog: Catalog) -> None:
    """While rows at the end are empty, those before them are an arm; an empty row between others is wrong."""
    found = read(edits.resized(GOOD, 5), catalog)
    assert (found.waiting, found.errors, found.is_whole) == (3, (), False)
    assert found.manipulator is not None
    assert len(found.manipulator.rows) == 2
    assert read(edits.resized(TableText(), 3), catalog).waiting == 3
    between = read(edits.arranged(GOOD, [0, None, *range(1, len(GOOD.rows))]), catalog)
    assert {(problem.row, problem.field) for problem in between.errors} == {(1, "a"), (1, "alpha"), (1, "d")}
    blank = read(replace(GOOD, rows=({}, *GOOD.rows)), catalog).errors  # a reader of files passes over blank lines
    assert [(problem.row, problem.problem.code) for problem in blank] == [(0, "row-empty")]
