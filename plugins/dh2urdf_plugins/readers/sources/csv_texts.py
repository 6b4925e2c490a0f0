"""CSV tables as their authors type them: written cell by cell, and read without giving the cells a meaning."""

from __future__ import annotations

import csv
import io
import json
import re
from dataclasses import replace
from typing import TYPE_CHECKING

from dh2urdf.errors import InputError
from dh2urdf.source import Mark, Messages, Problem
from dh2urdf.table_text import FIELDS, Place, TableText, WrittenTable
from dh2urdf.table_text.texts import yaml_word
from dh2urdf_plugins.readers.comments.top import read_top
from dh2urdf_plugins.readers.rows.groups import split_cell
from dh2urdf_plugins.readers.sources.delimited import COMPUTED
from dh2urdf_plugins.readers.words.cells import SPACES, text_of
from dh2urdf_plugins.readers.words.comment_lines import SIGNS
from dh2urdf_plugins.readers.words.fields import GROUPS
from dh2urdf_plugins.readers.words.table_words import statements_of, units_of, units_text

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from dh2urdf_plugins.readers.rows.source import RowSource

_QUOTED = frozenset(',;\t"#')
"""Characters that mean something to a reader of CSV where they stand bare."""
_COMMON = ("convention", "length_unit", "angle_unit", "base", "tool", "payload", "defaults")
"""What comments declare about all rows."""

say = Messages(__file__)


def write(tables: Sequence[TableText]) -> WrittenTable:
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
    for field, value in _top(table).items():
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


def texts(source: RowSource, path: Path) -> Iterator[TableText]:
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


def _top(table: TableText) -> dict[str, str]:
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

    No spreadsheet computes a name: OWASP's apostrophe stands before a sign, and `CsvLines` takes it away again.
    """
    if is_name and text.lstrip("'").startswith(tuple(COMPUTED)):
        text = f"'{text}"
    if not _QUOTED.intersection(text) and not text.startswith(SIGNS):
        return text
    written = io.StringIO()
    csv.writer(written, lineterminator="", quoting=csv.QUOTE_ALL).writerow([text])
    return written.getvalue()
