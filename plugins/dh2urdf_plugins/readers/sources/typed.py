"""Tables as their authors type them: written text by text as CSV and YAML, and read without giving texts a meaning."""

from __future__ import annotations

import json
import re
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING

from dh2urdf.columns import COM, INERTIA, LIMITS, ROW_FIELDS
from dh2urdf.documents import load_yaml
from dh2urdf.errors import InputError, TableError
from dh2urdf.quantities import Dimension, plain_text
from dh2urdf.source import Messages
from dh2urdf.table_text import ANGLE_UNITS, FIELDS, LENGTH_UNITS, MESHES, Place, TableText, Trace, WrittenTable
from dh2urdf.table_text.texts import yaml_word
from dh2urdf_plugins.readers.options import TableOptions
from dh2urdf_plugins.readers.sources.delimited import COMPUTED
from dh2urdf_plugins.readers.sources.documents import read_documents
from dh2urdf_plugins.readers.sources.files import read_file
from dh2urdf_plugins.readers.words.comment_lines import SIGNS

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

_CHOSEN = {"length": LENGTH_UNITS, "angle": ANGLE_UNITS}
"""Keys of `units` that a `TableText` has a choice of, and what it may choose."""
_STATED = ("convention", "base", "tool", "payload", "defaults", "visuals", "collisions")
_DOCUMENTS = (".yaml", ".yml", ".json")
_WITHOUT_CHOICE = {
    "inertia": (Dimension.INERTIA, "kg·m²"),
    "effort": (Dimension.TORQUE, "[Nm, N]"),
    "damping": (Dimension.DAMPING, "[N·m·s/rad, N·s/m]"),
}
"""What a `TableText` has in SI units, whatever its lengths are in, by the key of `units`."""
_QUOTED = frozenset(',;\t"#')
"""Characters that mean something to a reader of CSV where they stand bare."""
_COMMON = ("convention", "length_unit", "angle_unit", "base", "tool", "payload", "defaults")
"""What comments declare about all rows."""
_INNER = {"limits": LIMITS, "inertia": INERTIA}
_GROUPED = {field: group for group, fields in _INNER.items() for field in fields} | dict.fromkeys(COM, "com")
_FLOW = r"[a-z]+|\{(?:[a-z]+: (?:\[[-\w., /*+]*\]|[-\w.]+)(?:, |(?=\})))+\}"
"""A mapping of numbers and lists of them, as most are."""

say = Messages(__file__)


# --- CSV -------------------------------------------------------------------------------------------------------------


def write_csv(tables: Sequence[TableText]) -> WrittenTable:
    """A CSV file with a column for every field that a table says anything of, and one of names for several tables."""
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
    units = units_text(table) if (table.length_unit, table.angle_unit) != ("m", "rad") else ""
    name = yaml_word(table.name) if table.name.strip() else ""
    if re.search(rf"[,;\t]\s*[{COMPUTED}]", name):  # a spreadsheet takes its parts for cells: none begins with a sign
        name = re.sub("[,;]", lambda sign: f"\\u{ord(sign[0]):04x}", json.dumps(table.name, ensure_ascii=False))
    said = {"name": name, "convention": table.convention, "length_unit": units}
    said |= {key: getattr(table, key) for key in ("base", "tool", "payload", "defaults")}
    for field, text in said.items():
        if text.strip():
            places.append(Place(line=len(lines) + 1, column=1, row=None, field=field))
            lines.append(f"# {'units' if field == 'length_unit' else field}: {text}")
    lines.append(",".join(fields))
    for number, row in enumerate(rows):
        line = ""
        for index, field in enumerate(fields):
            line += "," if index else ""
            places.append(Place(line=len(lines) + 1, column=len(line) + 1, row=number, field=field))
            line += _cell(row.get(field, ""), is_name=field in ("robot", "joint", "link"))
        lines.append(line)
    return WrittenTable(content="\n".join([*lines, ""]).encode(), places=tuple(places))


def _cell(text: str, *, is_name: bool) -> str:
    """A text as a cell, quoted where it has to be.

    No spreadsheet computes a name: OWASP's apostrophe stands before a sign, and `CsvRows` takes it away again.
    """
    if is_name and text.lstrip("'").startswith(tuple(COMPUTED)):
        text = f"'{text}"
    is_bare = not _QUOTED.intersection(text) and not text.startswith(SIGNS)
    return text if is_bare else f'"{text.replace(chr(34), chr(34) * 2)}"'


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


# --- Read back -------------------------------------------------------------------------------------------------------


def typed_texts(path: Path) -> Iterator[TableText]:
    """The tables of a file as their authors typed them, as far as cells and statements say it; see `WritesTables`.

    There are none of a table in a text of another form whose cells are typeset for a page, or whose units a sentence
    declares.
    """
    is_own = path.suffix.lower() in (".csv", ".tsv", *_DOCUMENTS)
    read, trace = read_documents if path.suffix.lower() in _DOCUMENTS else read_file, Trace()
    for found in read(path, TableOptions(), trace):
        said = {key: trace.table[key].text or "" for key in _STATED if key in trace.table}
        units = {cell.unit for row in trace.rows for cell in row.values()}
        for key, known in _CHOSEN.items():
            stated = trace.table.get(f"units.{key}")
            named = [*units.intersection(known)] or [stated.text if stated else None]
            said |= {f"{key}_unit": named[0]} if len(named) == 1 and named[0] in known else {}
        rows = tuple({field: cell.text or "" for field, cell in row.items() if field in FIELDS} for row in trace.rows)
        is_typeset = any(plain_text(text) != text for row in rows for text in row.values())
        by_sentence = any(notice.code == "declared-by-sentences" for notice in found.notices)
        if is_own or not (is_typeset or by_sentence):
            yield TableText(**said | {"name": found.name}, rows=rows)
        trace.rows, trace.table = (), {}


def units_text(table: TableText) -> str:
    """What a table declares about its units, as a mapping of YAML: its own choice, and units of other numbers."""
    said = {"length": table.length_unit, "angle": table.angle_unit}
    if (table.length_unit, table.angle_unit) != ("m", "rad"):
        used = {ROW_FIELDS[name].dimension for name in table.columns() if name in ROW_FIELDS}
        said |= {key: unit for key, (dimension, unit) in _WITHOUT_CHOICE.items() if dimension in used}
    return f"{{{', '.join(f'{key}: {unit}' for key, unit in said.items())}}}"
