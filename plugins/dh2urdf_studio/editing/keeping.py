"""A table as a browser keeps it while the studio is away, and as a link holds it, and back."""

from __future__ import annotations

import json
from contextlib import suppress
from dataclasses import asdict, fields, replace
from typing import TYPE_CHECKING

from dh2urdf.manipulator import Convention
from dh2urdf.table_text import ANGLE_UNITS, FIELDS, LENGTH_UNITS, TableText
from dh2urdf_studio.editing.edits import MOST_ROWS, clean, with_cell

if TYPE_CHECKING:
    from dh2urdf_studio.editing.session import Session

_TEXTS = tuple(field.name for field in fields(TableText) if field.name != "rows")
_WORDS = {"convention": ("", *Convention), "length_unit": LENGTH_UNITS, "angle_unit": ANGLE_UNITS}
"""The words that some of the texts must be: the page has no others to choose from."""


def kept_text(table: TableText) -> str:
    """The text that a browser keeps of a table."""
    return json.dumps(asdict(table), ensure_ascii=False)


def kept_table(text: str) -> TableText | None:
    """The table of a text that a browser has kept, or that was in a link; None where it is none, or has no rows."""
    try:
        told = json.loads(text)
    except (ValueError, RecursionError):
        return None
    if not isinstance(told, dict) or not isinstance(told.get("rows"), list):
        return None
    rows = [row for row in told["rows"] if isinstance(row, dict)][:MOST_ROWS]
    texts = {name: clean(told[name]) for name in _TEXTS if isinstance(told.get(name), str)}
    texts = {name: text for name, text in texts.items() if text in _WORDS.get(name, (text,))}
    cells = tuple(
        {key: clean(row[key]) for key in FIELDS if isinstance(row.get(key), str) and row[key]} for row in rows
    )
    return TableText(**texts, rows=cells) if cells else None


def finish_typing(session: Session, left: object, kept: TableText | None, *, is_new: bool) -> None:
    """A session takes the text that was being typed when its page lost the connection or was loaded anew.

    Args:
        session: the session.
        left: the key of a row, field and text of a cell, as the browser has kept them, or None, name and text of a text
            of the whole table; None where nothing was being typed.
        kept: the table with that text, as the browser has kept it.
        is_new: whether the session had no table when the page asked: it is offered the whole kept table instead.
    """
    if session.previews:  # nobody types on in a page that is gone
        session.look()
    table = session.table
    match left:
        case [str(key), str(field), str(text)] if key in session.history.keys:
            with suppress(LookupError):
                table = with_cell(table, session.history.keys.index(key), field, text)
        case [None, str(field), str(text)] if field in _TEXTS and field not in _WORDS:
            table = replace(table, **{field: clean(text)})  # type: ignore[arg-type]  # all others are texts
    if table != session.table and (not is_new or table == kept):
        session.put(table)
