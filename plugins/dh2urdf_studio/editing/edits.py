"""What a person does to a table: each a function from a table to a table."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING

from dh2urdf.table_text import FIELDS, NAMES, TableText

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

MOST_ROWS = 1000
"""Rows that a table of the studio may have."""
LONGEST_TEXT = 1000
"""Characters of one cell; what is longer is cut, with a sign that no reader takes for a number."""
NEW_JOINT = re.compile(r"joint_\d+")
"""A name that the studio itself has given."""
"""Fields that do not begin a row: names and types are filled in before a person begins."""

_UNWRITABLE = re.compile(r"[^\t\x20-\x7e\xa0-\u2027\u202a-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]+|\t")


def clean(text: str) -> str:
    """A text as a cell can hold it: one line, without characters that no text file has."""
    line = _UNWRITABLE.sub(" ", text).strip()
    return line if len(line) <= LONGEST_TEXT else f"{line[: LONGEST_TEXT - 1]}…"


def with_cell(table: TableText, row: int, field: str, text: str) -> TableText:
    """The table with another text in a cell.

    Raises:
        LookupError: there is no such cell.
    """
    return with_cells(table, {(row, field): text})


def with_cells(table: TableText, texts: Mapping[tuple[int, str], str]) -> TableText:
    """The table with other texts in some cells.

    Raises:
        LookupError: there is no such cell.
    """
    rows = [dict(row) for row in table.rows]
    for (number, field), text in texts.items():
        if not 0 <= number < len(rows) or field not in FIELDS:
            raise LookupError(f"no cell {field!r} in row {number + 1} of {len(rows)}")
        rows[number][field] = clean(text)
    return replace(table, rows=tuple(map(_tidy, rows)))


def resized(table: TableText, count: int) -> TableText:
    """The table with so many rows: empty ones more, or the last ones less."""
    count = min(max(count, 0), MOST_ROWS)
    rows = list(table.rows[:count])
    while len(rows) < count:
        rows.append(_new_row(rows))
    return replace(table, rows=tuple(rows))


def arranged(table: TableText, rows: Sequence[int | None]) -> TableText:
    """The table with some of its rows in some order; names that the studio gave stay with their places.

    Args:
        table: the table.
        rows: the number of each row as it is in the table, None for an empty new one.
    """
    return replace(table, rows=_numbered([_new_row(table.rows) if row is None else table.rows[row] for row in rows]))


def rearranged(keys: Sequence[str], act: str, key: str | None, other: str | None) -> list[int | None]:
    """What a person did to a row, as `arranged` takes it.

    Args:
        keys: the keys of the rows of the table.
        act: ``add`` a row below one, ``remove`` a row, move it ``up`` or ``down`` by one, or ``to`` below another one.
        key: the key of the row; None to add a row at the end.
        other: for ``to``, the key of the row above it; None where it goes to the top.

    Raises:
        LookupError: there is no such row.
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


def _numbered(rows: Sequence[Mapping[str, str]]) -> tuple[Mapping[str, str], ...]:
    """Rows whose names, where the studio gave all of them, are those of their places."""
    if not all(NEW_JOINT.fullmatch(row.get("joint", "")) for row in rows):
        return tuple(rows)
    return tuple(_tidy({**row, "joint": f"joint_{number}"}) for number, row in enumerate(rows, start=1))


def _tidy(row: Mapping[str, str]) -> dict[str, str]:
    return {field: row[field] for field in FIELDS if row.get(field)}
