"""YAML tables as their authors type them: written text by text, and read without giving the texts a meaning."""

from __future__ import annotations

import re
from contextlib import suppress
from typing import TYPE_CHECKING

from dh2urdf.documents import load_yaml, read_bytes
from dh2urdf.errors import TableError
from dh2urdf.row_fields import COM, INERTIA
from dh2urdf.table_text import MESHES, TableText, WrittenTable
from dh2urdf.table_text.texts import yaml_word
from dh2urdf_plugins.readers.header.words import read_header
from dh2urdf_plugins.readers.tables.cell_groups import PARTS, GroupError, split_cell
from dh2urdf_plugins.readers.words.table_words import statements_of, units_text

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from dh2urdf.documents import Node
    from dh2urdf_plugins.readers.words.fields import Field

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
    robots = root.value.get("robots") if isinstance(root.value, dict) else None
    nodes = robots.value if robots is not None and isinstance(robots.value, list) else [root]
    for number, node in enumerate(nodes, start=1):
        name = path.stem if node is root else f"{path.stem}_{number}"
        if isinstance(node.value, dict) and (table := _table(node.value, name)):
            yield table


def _table(entries: Mapping[str, Node], default_name: str) -> TableText | None:
    said = statements_of(entries, default_name=default_name)
    joints = entries.get("joints")
    if said is None or joints is None or not isinstance(joints.value, list):
        return None
    rows = [dict(_texts(joint)) for joint in joints.value]
    return TableText(**said, rows=tuple({field: text for field, text in row.items() if text} for row in rows))


def _texts(joint: Node) -> Iterator[tuple[str, str]]:
    """The texts of a joint by field; what has no field is left out: a later comparison finds it."""
    for key, node in joint.value.items() if isinstance(joint.value, dict) else ():
        field = read_header(key).field
        if field and field.parts:
            yield from _parts(field, node)
        elif field and node.text is not None:
            yield field.name, node.text if node.value is not None else ""


def _parts(field: Field, node: Node) -> Iterator[tuple[str, str]]:
    """The texts of several fields at once, which are a mapping, a list, or a text as in a cell of CSV."""
    if isinstance(node.value, dict):
        names = _GROUPS.get(field.name, field.parts)
        named = ((PARTS.get(key, key), inner) for key, inner in node.value.items())
        yield from ((name, inner.text or "") for name, inner in named if name in names)
    elif isinstance(node.value, list):
        if len(node.value) == len(field.parts):
            yield from zip(field.parts, (inner.text or "" for inner in node.value), strict=True)
    elif not isinstance(parts := split_cell(field, node.text or ""), GroupError):
        yield from parts.items()
