"""Undo and redo: every state of a table that its author made, one after the other, and the keys of its rows."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from dh2urdf.table_text import TableText
from dh2urdf_studio.editing.edits import begun

if TYPE_CHECKING:
    from collections.abc import Sequence

LONGEST = 500
"""States that are kept."""


@dataclass(frozen=True, slots=True, kw_only=True)
class History:
    """The states of a table; none is ever changed.

    Attributes:
        states: from the oldest to the newest.
        position: which of them is on the screen.
        row_keys: the keys of the rows of each state. A row keeps its key wherever it goes, and no other gets it.
        made: how many keys have been made.
        tables: the number of the table that each is a state of: one that was opened is another one.
    """

    states: tuple[TableText, ...] = (TableText(),)
    position: int = 0
    row_keys: tuple[tuple[str, ...], ...] = ((),)
    made: int = 0
    tables: tuple[int, ...] = (0,)

    @staticmethod
    def of(table: TableText) -> History:
        """A history that begins with a table."""
        keys = tuple(map(str, range(len(table.rows))))
        return History(states=(table,), row_keys=(keys,), made=len(keys))

    @property
    def table(self) -> TableText:
        """The table as it is."""
        return self.states[self.position]

    @property
    def keys(self) -> tuple[str, ...]:
        """The keys of the rows of the table as it is."""
        return self.row_keys[self.position]

    @property
    def number(self) -> int:
        """The number of the table, which all states have that are its own."""
        return self.tables[self.position]

    @property
    def can_undo(self) -> bool:
        """Whether there is an older state."""
        return self.position > 0

    @property
    def can_redo(self) -> bool:
        """Whether there is a state that was undone."""
        return self.position < len(self.states) - 1

    def then(self, table: TableText, keys: Sequence[str | None] | None = None) -> History:
        """The history with a new state; what was undone before is forgotten, and so is what is very old.

        Args:
            table: the new state.
            keys: the keys of its first rows, None for new rows; further rows are new. Without them, each row is the one
                that had its number, unless its numbers are in other units or of another convention, where it had one:
                what was typed below the old header is not for the new one. No keys at all are those of another table.
        """
        if table == self.table and (keys is None or (*keys,) == self.keys):
            return self
        number = max(self.tables) + 1 if keys == () else self.number
        count = len(table.rows)
        if keys is None:
            is_read_anew = begun(table) and self.table.convention and _header(table) != _header(self.table)
            keys = () if is_read_anew else self.keys
        given = [*keys, *[None] * count][:count]
        made = self.made + given.count(None)
        numbers = iter(range(self.made, made))
        every = tuple(str(next(numbers)) if key is None else key for key in given)
        states = (*self.states[: self.position + 1], table)[-LONGEST:]
        row_keys = (*self.row_keys[: self.position + 1], every)[-LONGEST:]
        tables = (*self.tables[: self.position + 1], number)[-LONGEST:]
        return History(states=states, position=len(states) - 1, row_keys=row_keys, made=made, tables=tables)

    def undo(self) -> History:
        """One state back, where there is one."""
        return replace(self, position=max(0, self.position - 1))

    def redo(self) -> History:
        """One state forward, where there is one."""
        return replace(self, position=min(len(self.states) - 1, self.position + 1))


def _header(table: TableText) -> tuple[str, str, str]:
    """What decides on the meaning of numbers."""
    return table.convention, table.length_unit, table.angle_unit
