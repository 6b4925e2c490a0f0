"""A table as a browser keeps it while the studio is away, and back."""

from __future__ import annotations

import json
from dataclasses import asdict, fields

from dh2urdf.studio.editing.edits import MOST_ROWS, clean
from dh2urdf.table_text import FIELDS, TableText

_TEXTS = tuple(field.name for field in fields(TableText) if field.name != "rows")


def kept_text(table: TableText) -> str:
    """The text that a browser keeps of a table."""
    return json.dumps(asdict(table), ensure_ascii=False)


def kept_table(text: str) -> TableText | None:
    """The table of a text that a browser has kept; None where it is none, or has no rows."""
    try:
        told = json.loads(text)
    except ValueError:
        return None
    if not isinstance(told, dict) or not isinstance(told.get("rows"), list):
        return None
    rows = [row for row in told["rows"] if isinstance(row, dict)][:MOST_ROWS]
    texts = {name: clean(told[name]) for name in _TEXTS if isinstance(told.get(name), str)}
    cells = tuple(
        {key: clean(row[key]) for key in FIELDS if isinstance(row.get(key), str) and row[key]} for row in rows
    )
    return TableText(**texts, rows=cells) if cells else None
