from __future__ import annotations

from dataclasses import replace

from hypothesis import given, strategies as st

from dh2urdf.studio.editing.history import LONGEST, History
from dh2urdf.table_text import TableText


@given(st.lists(st.sampled_from(["undo", "redo", "a", "b", "c"]), max_size=40))
def test_undo_and_redo_are_those_of_a_list(acts: list[str]) -> None:
    """Whatever is done in whatever order, the table is the one that a list with a cursor would have."""
    history = History()
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


def test_very_old_states_are_forgotten() -> None:
    """So many states are kept and no more; the newest ones."""
    history = History()
    for number in range(LONGEST + 10):
        history = history.then(TableText(name=str(number)))
    assert len(history.states) == LONGEST
    assert history.table.name == str(LONGEST + 9)
