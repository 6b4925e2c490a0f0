from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from hypothesis import given, strategies as st

from dh2urdf.table_text import TableText
from dh2urdf_studio.editing import edits
from dh2urdf_studio.editing.opening import gallery_table
from dh2urdf_studio.editing.session import Session

if TYPE_CHECKING:
    from dh2urdf.plugin_system import Catalog

EMPTY = TableText()
THREE = edits.with_cells(edits.resized(EMPTY, 3), {(0, "a"): "1", (1, "a"): "2", (2, "a"): "3"})
COLUMNS = ("joint", "a", "alpha", "d")


def column(table: TableText, field: str) -> list[str]:
    return [row.get(field, "") for row in table.rows]


def test_new_rows_have_a_name_and_a_type() -> None:
    """The number of axes gives so many revolute joints, called as the readers would call them."""
    assert edits.resized(EMPTY, 2).rows == (
        {"joint": "joint_1", "type": "revolute"},
        {"joint": "joint_2", "type": "revolute"},
    )


@given(st.integers(0, 20), st.integers(0, 20))
def test_any_number_of_axes(first: int, second: int) -> None:
    """The table has as many rows as were asked for, names that differ, and the old rows as far as they are kept."""
    table = edits.resized(edits.resized(EMPTY, first), second)
    names = column(table, "joint")
    assert len(set(names)) == len(names) == second
    assert names[:first] == [f"joint_{number}" for number in range(1, min(first, second) + 1)]


@pytest.mark.parametrize("word", ["fixed", "F"])
def test_fixed_rows_are_no_axes(word: str, catalog: Catalog) -> None:
    """A Panda has seven axes and a fixed row: to ask for eight adds a row, to ask for six takes the last two away."""
    session = Session(catalog, edits.with_cells(gallery_table("panda.yaml", catalog), {(7, "type"): word}))
    names = column(session.table, "joint")
    assert session.moving_rows == list(range(7))
    for axes, expected in ((8, [*names, "joint_9"]), (6, names[:6]), (0, [])):
        session.resize(axes)
        assert column(session.table, "joint") == expected
        session.undo()
    session.edit(0, "a", "wrong")
    assert session.moving_rows == list(range(7))


def test_there_is_a_bound() -> None:
    """Nobody gets a table that no browser can show."""
    assert len(edits.resized(EMPTY, 10**9).rows) == edits.MOST_ROWS
    keys = [str(number) for number in range(edits.MOST_ROWS)]
    assert edits.rearranged(keys, "add", "3", None) == [*range(edits.MOST_ROWS)]


def test_rows_are_inserted_removed_and_moved() -> None:
    """Rows change places with all that stands in them; names that the studio gave stay in order."""
    assert column(edits.arranged(THREE, [0, None, 1, 2]), "a") == ["1", "", "2", "3"]
    assert column(edits.arranged(THREE, [0, 2]), "a") == ["1", "3"]
    assert column(edits.arranged(THREE, [1, 2, 0]), "a") == ["2", "3", "1"]
    assert column(edits.arranged(THREE, [1, 2, 0]), "joint") == ["joint_1", "joint_2", "joint_3"]
    named = edits.with_cells(THREE, {(0, "joint"): "base_joint"})
    assert column(edits.arranged(named, [1, 2, 0]), "joint") == ["joint_2", "joint_3", "base_joint"]


@pytest.mark.parametrize(
    ("act", "key", "other", "rows"),
    [
        ("add", "a", "new", [0, None, 1, 2]),
        ("add", None, None, [0, 1, 2, None]),
        ("remove", "b", None, [0, 2]),
        ("remove", "c", None, [0, 1]),
        ("up", "b", None, [1, 0, 2]),
        ("up", "a", None, [0, 1, 2]),
        ("down", "b", None, [0, 2, 1]),
        ("down", "c", None, [0, 1, 2]),
        ("to", "a", "c", [1, 2, 0]),
        ("to", "c", "a", [0, 2, 1]),
        ("to", "c", None, [2, 0, 1]),
    ],
)
def test_what_is_done_to_a_row(act: str, key: str | None, other: str | None, rows: list[int | None]) -> None:
    """It is done where that row is by now."""
    assert edits.rearranged("abc", act, key, other) == rows


@pytest.mark.parametrize(("act", "key", "other"), [("remove", "d", None), ("add", "d", "new"), ("to", "a", "d")])
def test_nothing_is_done_to_a_row_that_is_gone(act: str, key: str, other: str | None) -> None:
    """Nor is a row put behind one that is gone."""
    with pytest.raises(LookupError):
        edits.rearranged("abc", act, key, other)


def test_a_cell_is_one_line_of_what_a_file_can_hold() -> None:
    """Line ends and characters that no text file has become spaces, long texts are cut."""
    table = edits.with_cells(THREE, {(0, "joint"): " a\nb\x00c\t"})
    assert table.rows[0]["joint"] == "a b c"
    assert len(edits.with_cells(THREE, {(0, "a"): "1" * 10_000}).rows[0]["a"]) == edits.LONGEST_TEXT
    assert "a" not in edits.with_cells(THREE, {(0, "a"): "  "}).rows[0]


@pytest.mark.parametrize(("row", "field"), [(3, "a"), (-1, "a"), (0, "beta")])
def test_there_are_no_other_cells(row: int, field: str) -> None:
    """A page that speaks of a cell which there is not is told so, and changes nothing."""
    with pytest.raises(LookupError):
        edits.with_cells(THREE, {(row, field): "1"})


def test_a_row_begins_with_its_geometry() -> None:
    """Names and types are filled in before a person begins, and do not count."""
    assert edits.begun(edits.resized(EMPTY, 4)) == 0
    assert edits.begun(edits.resized(THREE, 6)) == 3
