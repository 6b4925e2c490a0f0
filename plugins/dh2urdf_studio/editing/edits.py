"""What a person does to a table: each a function from a table to a table; and the past of a table, to undo it."""

from __future__ import annotations

import json
import re
from dataclasses import asdict, dataclass, fields, replace
from typing import TYPE_CHECKING

from dh2urdf.manipulator import Convention
from dh2urdf.table_text import ANGLE_UNITS, FIELDS, LENGTH_UNITS, NAMES, TableText

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

MOST_ROWS = 1000  # rows that a table of the studio may have
LONGEST_TEXT = 1000  # characters of one cell; what is longer is cut, with a sign that no reader takes for a number
LONGEST_PAST = 500  # states of a table that are kept
NEW_JOINT = re.compile(r"joint_\d+")  # a name that the studio itself has given
TEXTS = tuple(field.name for field in fields(TableText) if field.name != "rows")  # the texts of a whole table
_WORDS = {"convention": ("", *Convention), "length_unit": LENGTH_UNITS, "angle_unit": ANGLE_UNITS}
"""The words that some of the texts must be: the page has no others to choose from."""
TYPED = frozenset(TEXTS) - _WORDS.keys()  # the texts of a whole table that a person types
_UNWRITABLE = re.compile(r"[^\x20-\x7e\xa0-\u2027\u202a-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]+")


def clean(text: str) -> str:
    """A text as a cell can hold it: one line, without characters that no text file has."""
    line = _UNWRITABLE.sub(" ", text).strip()
    return line if len(line) <= LONGEST_TEXT else f"{line[: LONGEST_TEXT - 1]}…"


def with_cells(table: TableText, texts: Mapping[tuple[int, str], str]) -> TableText:
    """The table with other texts in some cells; a `LookupError` where there is no such cell."""
    rows = [dict(row) for row in table.rows]
    for (number, field), text in texts.items():
        if not 0 <= number < len(rows) or field not in FIELDS:
            raise LookupError(f"no cell {field!r} in row {number + 1} of {len(rows)}")
        rows[number][field] = clean(text)
    return replace(table, rows=tuple(map(_tidy, rows)))


def with_texts(table: TableText, **texts: str) -> TableText:
    """The table with another name, base, tool, payload or defaults."""
    return replace(table, **{name: clean(text) for name, text in texts.items()})  # type: ignore[arg-type]  # all are texts


def resized(table: TableText, count: int) -> TableText:
    """The table with so many rows: empty ones more, or the last ones less."""
    count = min(max(count, 0), MOST_ROWS)
    rows = list(table.rows[:count])
    while len(rows) < count:
        rows.append(_new_row(rows))
    return replace(table, rows=tuple(rows))


def arranged(table: TableText, rows: Sequence[int | None]) -> TableText:
    """The table with some of its rows in some order, None for new ones; names that the studio gave stay in place."""
    found = [_new_row(table.rows) if row is None else table.rows[row] for row in rows]
    if all(NEW_JOINT.fullmatch(row.get("joint", "")) for row in found):
        found = [_tidy({**row, "joint": f"joint_{number}"}) for number, row in enumerate(found, start=1)]
    return replace(table, rows=tuple(found))


def rearranged(keys: Sequence[str], act: str, key: str | None, other: str | None) -> list[int | None]:
    """What a person did to a row, as `arranged` takes it; a `LookupError` where there is no such row.

    Args:
        keys: the keys of the rows of the table.
        act: ``add`` a row below one, ``remove`` a row, move it ``up`` or ``down`` by one, or ``to`` below another one.
        key: the key of the row; None to add a row at the end.
        other: for ``to``, the key of the row above it; None where it goes to the top.
    """
    rows: list[int | None] = [*range(len(keys))]
    if not {key, other if act == "to" else None} <= {None, *keys}:
        raise LookupError(f"no row {key!r}")
    at = len(keys) if key is None else keys.index(key)
    if act == "add":
        if len(keys) < MOST_ROWS:
            rows.insert(at + 1, None)
        return rows
    own = rows.pop(at)
    if act != "remove":
        to = {"up": max(at - 1, 0), "down": at + 1}.get(act, 0 if other is None else rows.index(keys.index(other)) + 1)
        rows.insert(to, own)
    return rows


def begun(table: TableText) -> int:
    """How many rows there are up to the last one in which anything but names and type stands."""
    return max((number for number, row in enumerate(table.rows, start=1) if not set(row) <= set(NAMES)), default=0)


def _new_row(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    taken = {row.get("joint") for row in rows}
    number = len(rows) + 1
    while f"joint_{number}" in taken:
        number += 1
    return {"joint": f"joint_{number}", "type": "revolute"}


def _tidy(row: Mapping[str, str]) -> dict[str, str]:
    return {field: row[field] for field in FIELDS if row.get(field)}


# --- A table as a text ------------------------------------------------------------------------------------------------


def kept_text(table: TableText) -> str:
    """A table as a browser keeps it while the studio is away, and as a link holds it."""
    return json.dumps(asdict(table), ensure_ascii=False)


def kept_table(text: str) -> TableText | None:
    """The table of such a text; None where it is none, or has no rows."""
    try:
        told = json.loads(text)
    except (ValueError, RecursionError):
        return None
    if not isinstance(told, dict) or not isinstance(told.get("rows"), list):
        return None
    rows = [row for row in told["rows"] if isinstance(row, dict)][:MOST_ROWS]
    texts = {name: clean(told[name]) for name in TEXTS if isinstance(told.get(name), str)}
    texts = {name: text for name, text in texts.items() if text in _WORDS.get(name, (text,))}
    cells = tuple(
        {key: clean(row[key]) for key in FIELDS if isinstance(row.get(key), str) and row[key]} for row in rows
    )
    return TableText(**texts, rows=cells) if cells else None


# --- The past of a table ----------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class State:
    """A state of a table."""

    table: TableText
    keys: tuple[str, ...] = ()  # of its rows: a row keeps its key wherever it goes, and no other gets it
    number: int = 0  # of the table: one that was opened is another one
    arm_edits: tuple[str, ...] = ()  # what is changed in the arm of the table, as `dh2urdf convert --edit` takes it


@dataclass(frozen=True, slots=True, kw_only=True)
class History:
    """The states of a table; none is ever changed."""

    states: tuple[State, ...]  # from the oldest to the newest
    position: int = 0  # of the one that is on the screen
    made: int = 0  # how many keys have been made

    @staticmethod
    def of(table: TableText, arm_edits: Sequence[str] = ()) -> History:
        """A history that begins with a table, and with edits of its arm."""
        keys = tuple(map(str, range(len(table.rows))))
        return History(states=(State(table=table, keys=keys, arm_edits=tuple(arm_edits)),), made=len(keys))

    @property
    def table(self) -> TableText:
        """The table as it is."""
        return self.states[self.position].table

    @property
    def keys(self) -> tuple[str, ...]:
        """The keys of the rows of the table as it is."""
        return self.states[self.position].keys

    @property
    def number(self) -> int:
        """The number of the table, which all states have that are its own."""
        return self.states[self.position].number

    @property
    def arm_edits(self) -> tuple[str, ...]:
        """The edits of the arm as they are, in their order."""
        return self.states[self.position].arm_edits

    @property
    def earlier(self) -> list[TableText]:
        """The table as it is, and what it was before, the newest first."""
        return [state.table for state in self.states[self.position :: -1]]

    @property
    def can_undo(self) -> bool:
        """Whether there is an older state."""
        return self.position > 0

    @property
    def can_redo(self) -> bool:
        """Whether there is a state that was undone."""
        return self.position < len(self.states) - 1

    def then(
        self, table: TableText, keys: Sequence[str | None] | None = None, arm_edits: Sequence[str] | None = None
    ) -> History:
        """The history with a new state; what was undone before is forgotten, and so is what is very old.

        The edits of the arm stay as they are where none are given.

        The keys are those of its first rows, None for new rows; further rows are new. Without them, each row is the one
        that had its number, unless its numbers are in other units or of another convention, where it had one: what was
        typed below the old header is not for the new one. No keys at all are those of another table.
        """
        changes = self.arm_edits if arm_edits is None else (*arm_edits,)
        if (table, changes) == (self.table, self.arm_edits) and (keys is None or (*keys,) == self.keys):
            return self
        number = max(state.number for state in self.states) + 1 if keys == () else self.number
        if keys is None:
            is_read_anew = begun(table) and self.table.convention and meaning(table) != meaning(self.table)
            keys = () if is_read_anew else self.keys
        count, made, own = len(table.rows), self.made, list[str]()
        for key in [*keys, *[None] * count][:count]:
            own.append(str(made) if key is None else key)
            made += key is None
        state = State(table=table, keys=tuple(own), number=number, arm_edits=changes)
        states = (*self.states[: self.position + 1], state)[-LONGEST_PAST:]
        return History(states=states, position=len(states) - 1, made=made)

    def undo(self) -> History:
        """One state back, where there is one."""
        return replace(self, position=max(0, self.position - 1))

    def redo(self) -> History:
        """One state forward, where there is one."""
        return replace(self, position=min(len(self.states) - 1, self.position + 1))


def meaning(table: TableText) -> tuple[str, str, str]:
    """What decides on the meaning of numbers: the convention and the units."""
    return table.convention, table.length_unit, table.angle_unit
