"""What is done to a table, its past, and what a browser keeps of it."""

from dataclasses import replace
from itertools import count

import pytest
from hypothesis import given, strategies as st

from dh2urdf.plugin_system import Catalog
from dh2urdf.table_text import TableText
from dh2urdf_studio.editing import edits
from dh2urdf_studio.editing.edits import History, arranged, kept_table, kept_text, rearranged, resized, with_cells
from dh2urdf_studio.editing.opening import gallery, gallery_table
from dh2urdf_studio.editing.session import Session

EMPTY = TableText()
THREE = edits.with_cells(edits.resized(EMPTY, 3), {(0, "a"): "1", (1, "a"): "2", (2, "a"): "3"})


def column(table: TableText, field: str) -> list[str]:
    return [row.get(field, "") for row in table.rows]


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
    """A page that names a cell which does not exist gets an error, and changes nothing."""
    with pytest.raises(LookupError):
        edits.with_cells(THREE, {(row, field): "1"})


def test_a_row_begins_with_its_geometry() -> None:
    """Names and types are filled in before a person begins, and do not count."""
    assert edits.begun(edits.resized(EMPTY, 4)) == 0
    assert edits.begun(edits.resized(THREE, 6)) == 3


# --- The past ---------------------------------------------------------------------------------------------------------


@given(st.lists(st.sampled_from(["undo", "redo", "a", "b", "c"]), max_size=40))
def test_undo_and_redo_are_those_of_a_list(acts: list[str]) -> None:
    """Whatever is done in whatever order, the table is the one that a list with a cursor would have."""
    history = History.of(TableText())
    states, cursor = [""], 0
    for act in acts:
        if act == "undo":
            history, cursor = history.undo(), max(0, cursor - 1)
        elif act == "redo":
            history, cursor = history.redo(), min(len(states) - 1, cursor + 1)
        else:
            history = history.then(replace(history.table, name=act))
            if act != states[cursor]:
                states, cursor = [*states[: cursor + 1], act], cursor + 1
        assert history.table.name == states[cursor]
        assert (history.can_undo, history.can_redo) == (cursor > 0, cursor < len(states) - 1)


@given(st.lists(st.tuples(st.sampled_from(["add", "remove", "up", "open", "undo", "redo"]), st.integers(0, 9))))
def test_a_row_keeps_its_key(acts: list[tuple[str, int]]) -> None:
    """Each row has a mass of its own. Through all that is done, undone and done again, a key is with the same mass."""
    history, masses, known = History.of(TableText()), count(), {}

    def weighed(table: TableText) -> TableText:
        new = [(row, "mass") for row, texts in enumerate(table.rows) if "mass" not in texts]
        return with_cells(table, {cell: str(next(masses)) for cell in new})

    for act, at in acts:
        keys = history.keys
        if act in ("undo", "redo"):
            history = history.undo() if act == "undo" else history.redo()
        elif act == "open":
            history = history.then(weighed(resized(TableText(), at)), ())
        elif keys or act == "add":
            rows = rearranged(keys, act, keys[at % len(keys)] if keys else None, None)
            table = weighed(arranged(history.table, rows))
            history = history.then(table, [None if row is None else keys[row] for row in rows])
        for key, texts in zip(history.keys, history.table.rows, strict=True):
            assert known.setdefault(key, texts["mass"]) == texts["mass"]
        assert len(set(history.keys)) == len(history.keys)


def test_very_old_states_are_forgotten() -> None:
    """So many states are kept and no more; the newest ones."""
    history = History.of(TableText())
    for number in range(edits.LONGEST_PAST + 10):
        history = history.then(TableText(name=str(number)))
    assert len(history.states) == edits.LONGEST_PAST
    assert history.table.name == str(edits.LONGEST_PAST + 9)


def test_an_opened_table_is_another_one() -> None:
    """Edits, rows and units leave it the same table; undo of what was opened brings back the number of the one before."""
    first = History.of(resized(TableText(convention="standard"), 2))
    edited = first.then(with_cells(first.table, {(0, "a"): "1"}))
    converted = edited.then(replace(edited.table, length_unit="mm"))
    opened = converted.then(resized(TableText(), 3), ())
    assert first.number == edited.number == converted.number == opened.undo().number != opened.number
    assert opened.undo().redo().number == opened.number


def test_a_convention_that_is_chosen_leaves_the_rows() -> None:
    """Numbers that had no convention have one now; below another unit they are others."""
    table = with_cells(resized(TableText(), 2), {(0, "a"): "1"})
    history = History.of(table)
    chosen = history.then(replace(table, convention="standard"))
    assert chosen.keys == history.keys
    assert not {*chosen.then(replace(chosen.table, convention="modified")).keys} & {*chosen.keys}


# --- What a browser keeps ---------------------------------------------------------------------------------------------


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


def finish(session: Session, left: object, kept: TableText | None = None) -> None:
    session.finish_typing(left, kept, is_new=not session.history.can_undo)


def test_a_cell_that_was_being_typed_is_finished(catalog: Catalog) -> None:
    """In the session that its page had; what is no cell, and a cell that is gone, changes nothing."""
    table = gallery_table("panda.yaml", catalog)
    session = Session(catalog, table)
    other = edits.with_cells(table, {(1, "d"): "7"})
    for kept in (None, table, edits.with_cells(other, {(0, "d"): "0.5"})):
        finish(session, [session.history.keys[0], "d", "0.5"], kept)
        assert session.table == table, "a new session is offered the whole table"
    session.edit(0, "d", "0.25")
    for cell in (None, [], "0d1", [0, "d", "1"], ["0", "d", 1], ["0", "?", "1"], ["99", "d", "1"], {"row": 0}):
        finish(session, cell)
    assert session.table.rows[0]["d"] == "0.25"
    finish(session, [session.history.keys[0], "d", "0.5"])
    assert session.table.rows[0]["d"] == "0.5"
    session.undo()
    assert session.table.rows[0]["d"] == "0.25"


def test_a_text_of_the_whole_table_is_finished(catalog: Catalog) -> None:
    """As a cell; what is no such text, or one that is chosen and not typed, changes nothing."""
    session = Session(catalog, gallery_table("ur5.csv", catalog))
    before = session.table
    named = replace(before, name="my arm")
    for left in ([None, "rows", "x"], [None, "convention", "mine"], [None, "name"], ["name", "my arm"]):
        finish(session, left, named)
        assert session.table == before
    finish(session, [None, "name", "my arm"], before)
    assert session.table == before, "a new session is offered the whole table"
    finish(session, [None, "name", "my arm"], named)
    finish(session, [None, "base", "{xyz: [0, 0, 1]}"])
    assert session.table == replace(named, base="{xyz: [0, 0, 1]}")
    session.undo()
    assert session.table == named


def test_no_arm_of_a_text_that_is_gone(catalog: Catalog) -> None:
    """The page was loaded anew in the middle of a cell: the arm is that of the table again."""
    session = Session(catalog, gallery_table("ur5.csv", catalog))
    before = session.arm
    assert session.preview(0, "d", "0.5")
    assert session.arm != before
    finish(session, None)
    assert session.arm == before
    assert not session.previews
