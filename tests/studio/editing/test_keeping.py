"""What a browser keeps of a table is that table."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from dh2urdf.table_text import TableText
from dh2urdf_studio.editing import edits
from dh2urdf_studio.editing.edits import kept_table, kept_text
from dh2urdf_studio.editing.opening import gallery, gallery_table
from dh2urdf_studio.editing.session import Session

if TYPE_CHECKING:
    from dh2urdf.plugin_system import Catalog


@pytest.mark.parametrize("name", gallery())
def test_a_table_comes_back(name: str, catalog: Catalog) -> None:
    table = gallery_table(name, catalog)
    assert kept_table(kept_text(table)) == table


@pytest.mark.parametrize(
    "text", ["", "no", "[]", "{}", '{"rows": 3}', '{"rows": []}', kept_text(TableText(name="x")), "[" * 90_000]
)
def test_what_is_no_table(text: str) -> None:
    """A text that somebody else has put there, or a table without rows, is nothing to offer."""
    assert kept_table(text) is None


def test_foreign_fields_and_types_are_left_out() -> None:
    table = kept_table('{"name": 3, "evil": "x", "rows": [{"a": "1\\u0000", "b?": "2", "d": 4}, "no"]}')
    assert table == TableText(rows=({"a": "1"},))


def test_a_cell_that_was_being_typed_is_finished(catalog: Catalog) -> None:
    """In the session that its page had; what is no cell, and a cell that is gone, changes nothing."""
    table = gallery_table("panda.yaml", catalog)
    session = Session(catalog, table)
    other = edits.with_cells(table, {(1, "d"): "7"})
    for kept in (None, table, edits.with_cells(other, {(0, "d"): "0.5"})):
        session.finish_typing([session.history.keys[0], "d", "0.5"], kept, is_new=not session.history.can_undo)
        assert session.table == table, "a new session is offered the whole table"
    session.edit(0, "d", "0.25")
    for cell in (None, [], "0d1", [0, "d", "1"], ["0", "d", 1], ["0", "?", "1"], ["99", "d", "1"], {"row": 0}):
        session.finish_typing(cell, None, is_new=not session.history.can_undo)
    assert session.table.rows[0]["d"] == "0.25"
    session.finish_typing([session.history.keys[0], "d", "0.5"], None, is_new=not session.history.can_undo)
    assert session.table.rows[0]["d"] == "0.5"
    session.undo()
    assert session.table.rows[0]["d"] == "0.25"


def test_a_text_of_the_whole_table_is_finished(catalog: Catalog) -> None:
    """As a cell; what is no such text, or one that is chosen and not typed, changes nothing."""
    session = Session(catalog, gallery_table("ur5.csv", catalog))
    before = session.table
    named = replace(before, name="my arm")
    for left in ([None, "rows", "x"], [None, "convention", "mine"], [None, "name"], ["name", "my arm"]):
        session.finish_typing(left, named, is_new=not session.history.can_undo)
        assert session.table == before
    session.finish_typing([None, "name", "my arm"], before, is_new=not session.history.can_undo)
    assert session.table == before, "a new session is offered the whole table"
    session.finish_typing([None, "name", "my arm"], named, is_new=not session.history.can_undo)
    session.finish_typing([None, "base", "{xyz: [0, 0, 1]}"], None, is_new=not session.history.can_undo)
    assert session.table == replace(named, base="{xyz: [0, 0, 1]}")
    session.undo()
    assert session.table == named


def test_no_arm_of_a_text_that_is_gone(catalog: Catalog) -> None:
    """The page was loaded anew in the middle of a cell: the arm is that of the table again."""
    session = Session(catalog, gallery_table("ur5.csv", catalog))
    before = session.arm
    assert session.preview(0, "d", "0.5")
    assert session.arm != before
    session.finish_typing(None, None, is_new=not session.history.can_undo)
    assert session.arm == before
    assert not session.previews
