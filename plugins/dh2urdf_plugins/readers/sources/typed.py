"""Tables as their authors type them: written text by text as CSV and YAML, and read without giving texts a meaning."""

from __future__ import annotations

import csv
import io
import json
import re
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING

from dh2urdf.columns import COM, INERTIA, ROW_FIELDS
from dh2urdf.documents import Item, load_yaml, read_bytes
from dh2urdf.errors import InputError, TableError
from dh2urdf.quantities import Dimension
from dh2urdf.source import Mark, Messages, Problem
from dh2urdf.table_text import ANGLE_UNITS, FIELDS, LENGTH_UNITS, MESHES, CellRow, Place, TableText, WrittenTable
from dh2urdf.table_text.texts import yaml_word
from dh2urdf_plugins.readers.comments.top import read_top
from dh2urdf_plugins.readers.header.header_rows import text_in
from dh2urdf_plugins.readers.header.words import read_header
from dh2urdf_plugins.readers.options import TableOptions
from dh2urdf_plugins.readers.rows.groups import split_cell
from dh2urdf_plugins.readers.sources.delimited import COMPUTED
from dh2urdf_plugins.readers.sources.documents import Document, flow_text
from dh2urdf_plugins.readers.words.cells import SPACES, text_of
from dh2urdf_plugins.readers.words.comment_lines import SIGNS
from dh2urdf_plugins.readers.words.fields import GROUPS, convention_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from dh2urdf.documents import Node
    from dh2urdf_plugins.readers.header.columns import RowSource

_LENGTHS = (*LENGTH_UNITS, "µm")
_CHOSEN = ("length", "angle")
"""Keys of `units` that a `TableText` has a choice of."""
_WITHOUT_CHOICE = {"inertia": "kg·m²", "effort": "[Nm, N]", "damping": "[N·m·s/rad, N·s/m]"}
_MEASURED = {
    word: tuple(name for name, field in ROW_FIELDS.items() if field.dimension is dimension)
    for word, dimension in (
        ("inertia", Dimension.INERTIA),
        ("effort", Dimension.TORQUE),
        ("damping", Dimension.DAMPING),
    )
}
"""What a `TableText` has in SI units, whatever its lengths are in: units by key, and fields that have them."""
_QUOTED = frozenset(',;\t"#')
"""Characters that mean something to a reader of CSV where they stand bare."""
_COMMON = ("convention", "length_unit", "angle_unit", "base", "tool", "payload", "defaults")
"""What comments declare about all rows."""
_INNER = {"limits": ("lower", "upper", "velocity", "effort"), "inertia": INERTIA}
_GROUPED = {field: group for group, fields in _INNER.items() for field in fields} | dict.fromkeys(COM, "com")
_LONGEST = 4 * 2**20
_FLOW = r"[a-z]+|\{(?:[a-z]+: (?:\[[-\w., /*+]*\]|[-\w.]+)(?:, |(?=\})))+\}"
"""A mapping of numbers and lists of them, as most are."""

say = Messages(__file__)


# --- CSV -------------------------------------------------------------------------------------------------------------


def write_csv(tables: Sequence[TableText]) -> WrittenTable:
    """A CSV file with a column for every field that a table says anything of, and one of names for several tables.

    Raises:
        InputError: there are several tables, and what comments declare about all rows is not the same of each.
    """
    if len(tables) == 1:
        return _written(tables[0], tables[0].columns(), tables[0].rows)
    first, *others = tables
    for table in others:
        if differing := [key for key in _COMMON if getattr(table, key) != getattr(first, key)]:
            found = f"{getattr(table, differing[0]) or 'none'}, after {getattr(first, differing[0]) or 'none'}"
            keys = " and ".join(differing)
            raise InputError(say("different-in-one-file", robot=table.name, found=found, differing=keys))
    used = {field for table in tables for field in table.columns()}
    rows = [{"robot": table.name, **row} for table in tables for row in table.rows]
    return _written(replace(first, name=""), ("robot", *(field for field in FIELDS if field in used)), rows)


def _written(table: TableText, fields: Sequence[str], rows: Sequence[Mapping[str, str]]) -> WrittenTable:
    """A CSV file of some columns, below what comments say."""
    lines: list[str] = []
    places: list[Place] = []
    for field, value in _comments(table).items():
        places.append(Place(line=len(lines) + 1, column=1, row=None, field=field))
        lines.append(f"# {field if field not in ('length_unit', 'angle_unit') else 'units'}: {value}")
    lines.append(",".join(fields))
    for number, row in enumerate(rows):
        line = ""
        for index, field in enumerate(fields):
            line += "," if index else ""
            places.append(Place(line=len(lines) + 1, column=len(line) + 1, row=number, field=field))
            line += _cell(row.get(field, ""), is_name=field in ("robot", "joint", "link"))
        lines.append(line)
    return WrittenTable(content="\n".join([*lines, ""]).encode(), places=tuple(places))


def cell_texts(source: RowSource, path: Path) -> Iterator[TableText]:
    """The one table of a CSV file; none where it holds several manipulators, or what a table of texts has no place for.

    Raises:
        TableError: the file is no table, or its header is wrong.
    """
    top = read_top(source, Mark(file=str(path)))
    columns = source.start(top.columns)
    fields = [field if field not in ("index", "flip") else None for field in columns.fields]
    units = units_of({unit.symbol for unit in columns.units.values()})  # as those of a whole table
    if {"robot", "convention", "flip"}.intersection(filter(None, columns.fields)) or units is None:
        return
    rows = []
    for _, batch in source.batches():
        for cells in batch:
            named = zip(fields, (text_of(cell).strip(SPACES) for cell in cells), strict=False)
            row: dict[str, str] = {}
            for field, text in named:
                if field and text:
                    parts = split_cell(GROUPS[field], text) if field in GROUPS else {field: text}
                    if isinstance(parts, Problem):
                        return
                    row |= parts
            if row:
                rows.append(row)
    said = statements_of(top.statements, default_name=path.stem)
    if said is not None:
        yield TableText(**{**said, **units}, rows=tuple(rows))


def _comments(table: TableText) -> dict[str, str]:
    """What comment lines say, by key, in their order."""
    units = units_text(table) if (table.length_unit, table.angle_unit) != ("m", "rad") else ""
    said = {"name": _comment(table.name) if table.name.strip() else "", "convention": table.convention}
    said |= {"length_unit": units, "base": table.base, "tool": table.tool, "payload": table.payload}
    return {field: text for field, text in (said | {"defaults": table.defaults}).items() if text.strip()}


def _comment(name: str) -> str:
    """A name as YAML in a comment, whose parts a spreadsheet takes for cells: none of them begins with a sign."""
    if not re.search(rf"[,;\t]\s*[{COMPUTED}]", name):
        return yaml_word(name)
    return re.sub("[,;]", lambda found: f"\\u{ord(found[0]):04x}", json.dumps(name, ensure_ascii=False))


def _cell(text: str, *, is_name: bool) -> str:
    """A text as a cell, quoted where it has to be.

    No spreadsheet computes a name: OWASP's apostrophe stands before a sign, and `CsvRows` takes it away again.
    """
    if is_name and text.lstrip("'").startswith(tuple(COMPUTED)):
        text = f"'{text}"
    if not _QUOTED.intersection(text) and not text.startswith(SIGNS):
        return text
    written = io.StringIO()
    csv.writer(written, lineterminator="", quoting=csv.QUOTE_ALL).writerow([text])
    return written.getvalue()


# --- YAML ------------------------------------------------------------------------------------------------------------


def write_yaml(tables: Sequence[TableText]) -> WrittenTable:
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
    for group, fields in _INNER.items():
        if inner := [f"{field}: {yaml_word(row[field])}" for field in fields if field in row]:
            yield f"{group}: {{{', '.join(inner)}}}"
    if any(field in row for field in COM):
        yield f"com: [{', '.join(yaml_word(row.get(field, '')) for field in COM)}]"


def yaml_texts(path: Path) -> Iterator[TableText]:
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


# --- What holds for all rows -----------------------------------------------------------------------------------------


def statements_of(statements: Mapping[str, Node], *, default_name: str) -> dict[str, str] | None:
    """The texts of a table's statements by attribute of `TableText`; None where one has a form that has no such text.

    Args:
        statements: the statements by key.
        default_name: the manipulator's name where none of them says it.
    """
    name, convention = statements.get("name"), statements.get("convention")
    said = {"name": (name and name.text) or default_name}
    if convention is not None:
        word = convention_of(convention.text or "")
        said["convention"] = str(word) if word else convention.text or ""
    for key in ("base", "tool", "payload", "defaults", "visuals", "collisions"):
        if key in statements:
            said[key] = flow_text(statements[key])
    if (units := statements.get("units")) is not None:
        entries = units.value if isinstance(units.value, dict) else {}
        if any(flow_text(node) != _WITHOUT_CHOICE.get(key) for key, node in entries.items() if key not in _CHOSEN):
            return None
        words = [entries[key].text or "" for key in _CHOSEN if key in entries] if entries else []
        found = units_of(words or (units.text or "").replace(",", " ").split())
        if found is None:
            return None
        said |= found
    return said


def units_of(words: Iterable[str]) -> dict[str, str] | None:
    """Units by attribute of `TableText`; None where they are not at most one of lengths and one of angles."""
    found: dict[str, str] = {}
    for word in words:
        key = "length_unit" if word in _LENGTHS else "angle_unit" if word in ANGLE_UNITS else None
        if key is None or found.setdefault(key, word) != word:
            return None
    return found


def units_text(table: TableText) -> str:
    """What a table declares about its units, as a mapping of YAML: its own choice, and units of other numbers."""
    said = {"length": table.length_unit, "angle": table.angle_unit}
    if (table.length_unit, table.angle_unit) != ("m", "rad"):
        used = table.columns()
        said |= {key: _WITHOUT_CHOICE[key] for key, fields in _MEASURED.items() if {*fields}.intersection(used)}
    return f"{{{', '.join(f'{key}: {unit}' for key, unit in said.items())}}}"
