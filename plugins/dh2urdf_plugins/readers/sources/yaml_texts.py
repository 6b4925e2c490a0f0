"""YAML tables as their authors type them: written text by text, and read without giving the texts a meaning."""

from __future__ import annotations

import re
from contextlib import suppress
from typing import TYPE_CHECKING

from dh2urdf.documents import Item, load_yaml, read_bytes
from dh2urdf.errors import TableError
from dh2urdf.row_fields import COM, INERTIA
from dh2urdf.table_text import MESHES, CellRow, TableText, WrittenTable
from dh2urdf.table_text.texts import yaml_word
from dh2urdf_plugins.readers.header.header_rows import text_in
from dh2urdf_plugins.readers.header.words import read_header
from dh2urdf_plugins.readers.options import TableOptions
from dh2urdf_plugins.readers.sources.documents import Document
from dh2urdf_plugins.readers.words.table_words import statements_of, units_text

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

_GROUPS = {"limits": ("lower", "upper", "velocity", "effort"), "inertia": INERTIA}
_GROUPED = {field: group for group, fields in _GROUPS.items() for field in fields} | dict.fromkeys(COM, "com")
_LONGEST = 4 * 2**20
_FLOW = r"[a-z]+|\{(?:[a-z]+: (?:\[[-\w., /*+]*\]|[-\w.]+)(?:, |(?=\})))+\}"
"""A mapping of numbers and lists of them, as most are."""


def write(tables: Sequence[TableText]) -> WrittenTable:
    """A YAML file with a line for each joint; several tables are a list of robots."""
    if len(tables) == 1:
        lines = _lines(tables[0])
    else:
        items = [_lines(table) for table in tables]
        lines = ["robots:", *(f"{'    ' if at else '  - '}{line}" for item in items for at, line in enumerate(item))]
    return WrittenTable(content="\n".join([*lines, ""]).encode())


def _lines(table: TableText) -> list[str]:
    """A table as the lines of a mapping."""
    lines = [f"name: {yaml_word(table.name)}"] if table.name.strip() else []
    lines += [f"convention: {yaml_word(table.convention)}"] if table.convention else []
    lines.append(f"units: {units_text(table)}")
    lines += [
        f"{key}: {_mapping(text)}"
        for key in ("base", "tool", "payload", "defaults", "visuals", "collisions")
        if (text := getattr(table, key)).strip()
    ]
    lines.append("joints:" if table.rows else "joints: []")
    return [*lines, *(f"  - {{{', '.join(_entries(row))}}}" for row in table.rows)]


def _mapping(text: str) -> str:
    """A text that is YAML, in braces where it is a mapping without them; in quotes where it would break the file."""
    if re.fullmatch(_FLOW, text):
        return text
    for written in (text, f"{{{text}}}"):
        with suppress(TableError):
            load_yaml(f"key: {written}".encode(), "", TableError)
            return written
    return yaml_word(text)


def _entries(row: Mapping[str, str]) -> Iterator[str]:
    """The entries of a joint: names first, then fields, then groups of fields."""
    for field, text in row.items():
        if field not in _GROUPED:
            yield f"{'name' if field == 'joint' else field}: {text if field in MESHES else yaml_word(text)}"
    for group, fields in _GROUPS.items():
        if inner := [f"{field}: {yaml_word(row[field])}" for field in fields if field in row]:
            yield f"{group}: {{{', '.join(inner)}}}"
    if any(field in row for field in COM):
        yield f"com: [{', '.join(yaml_word(row.get(field, '')) for field in COM)}]"


def texts(path: Path) -> Iterator[TableText]:
    """The tables of a YAML file.

    Raises:
        TableError: the file is no YAML document, or too large to be typed by a person.
    """
    root = load_yaml(read_bytes(path, TableError, limit=_LONGEST), str(path), TableError)
    robots = root.entries("robots") or [root]
    for number, node in enumerate(robots, start=1):
        document = Document(Item(node))
        said = statements_of(document.said, default_name=path.stem if node is root else f"{path.stem}_{number}")
        if said is None or document.joints is None or not isinstance(document.joints.value, list):
            continue
        header, *rows = document.rows(TableOptions()) if document.joints.value else [CellRow([], node.mark)]
        fields = [read_header(key).field for key in map(text_in, header.cells)]
        named = [zip(fields, map(text_in, row.cells), strict=True) for row in rows]
        # What has no field is left out: a later comparison finds it.
        yield TableText(
            **said, rows=tuple({field.name: text for field, text in row if field and text} for row in named)
        )
