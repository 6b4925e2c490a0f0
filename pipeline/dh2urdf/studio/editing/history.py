"""Undo and redo: every state of a table that its author made, one after the other."""

from __future__ import annotations

from dataclasses import replace

from dh2urdf.late_dataclasses import dataclass
from dh2urdf.table_text import TableText

LONGEST = 500
"""States that are kept."""


@dataclass(frozen=True, slots=True, kw_only=True)
class History:
    """The states of a table; none is ever changed.

    Attributes:
        states: from the oldest to the newest.
        position: which of them is on the screen.
    """

    states: tuple[TableText, ...] = (TableText(),)
    position: int = 0

    @property
    def table(self) -> TableText:
        """The table as it is."""
        return self.states[self.position]

    @property
    def can_undo(self) -> bool:
        """Whether there is an older state."""
        return self.position > 0

    @property
    def can_redo(self) -> bool:
        """Whether there is a state that was undone."""
        return self.position < len(self.states) - 1

    def then(self, table: TableText) -> History:
        """The history with a new state; what was undone before is forgotten, and so is what is very old."""
        if table == self.table:
            return self
        states = (*self.states[: self.position + 1], table)[-LONGEST:]
        return History(states=states, position=len(states) - 1)

    def undo(self) -> History:
        """One state back, where there is one."""
        return replace(self, position=max(0, self.position - 1))

    def redo(self) -> History:
        """One state forward, where there is one."""
        return replace(self, position=min(len(self.states) - 1, self.position + 1))
