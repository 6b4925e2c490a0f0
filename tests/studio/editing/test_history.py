from __future__ import annotations

from dataclasses import replace
from itertools import count

from hypothesis import given, strategies as st

from dh2urdf.table_text import TableText
from dh2urdf_studio.editing.edits import LONGEST_PAST as LONGEST, History, arranged, rearranged, resized, with_cells


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
    for number in range(LONGEST + 10):
        history = history.then(TableText(name=str(number)))
    assert len(history.states) == LONGEST
    assert history.table.name == str(LONGEST + 9)


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
