"""A table as a browser keeps it while the studio is away, and as a link holds it, and back."""

from __future__ import annotations

import json
from dataclasses import asdict, fields

from dh2urdf.manipulator import Convention
from dh2urdf.studio.editing.conversions import ANGLE_UNITS, LENGTH_UNITS
from dh2urdf.studio.editing.edits import MOST_ROWS, clean
from dh2urdf.table_text import FIELDS, TableText

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
