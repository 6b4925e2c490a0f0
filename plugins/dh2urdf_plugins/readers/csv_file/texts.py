"""CSV tables as their authors type them: written cell by cell, and read without giving the cells a meaning."""

from __future__ import annotations

import csv
import io
from typing import TYPE_CHECKING

from dh2urdf.source import Mark
from dh2urdf.table_text import Place, TableText, WrittenTable, yaml_word
from dh2urdf_plugins.readers.csv_file.rows import CsvRows
from dh2urdf_plugins.readers.statements.top import read_top
from dh2urdf_plugins.readers.words.cells import SPACES, text_of
from dh2urdf_plugins.readers.words.table_words import statements_of, units_of, units_text

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from dh2urdf.quantities import Unit

_QUOTED = frozenset(',;\t"#')
"""Characters that mean something to a reader of CSV where they stand bare."""


def write(table: TableText) -> WrittenTable:
    """A CSV file with a column for every field that the table says anything of."""
    lines: list[str] = []
    places: list[Place] = []
    for field, value in _top(table).items():
        places.append(Place(line=len(lines) + 1, column=1, row=None, field=field))
        lines.append(f"# {field if field not in ('length_unit', 'angle_unit') else 'units'}: {value}")
    fields = table.columns()
    lines.append(",".join(fields))
    for number, row in enumerate(table.rows):
        line = ""
        for index, field in enumerate(fields):
            line += "," if index else ""
            places.append(Place(line=len(lines) + 1, column=len(line) + 1, row=number, field=field))
            line += _cell(row.get(field, ""))
        lines.append(line)
    return WrittenTable(content="\n".join([*lines, ""]).encode(), places=tuple(places))


def texts(path: Path) -> Iterator[TableText]:
    """The one table of a CSV file; none where it holds several manipulators, or columns that no field knows.

    Raises:
        TableError: the file is no table, or its header is wrong.
    """
    source = CsvRows(path)
    top = read_top(source, Mark(file=str(path)))
    columns = source.start(top.columns)
    fields = [field if field not in ("index", "flip") else None for field in columns.fields]
    units = _common_units(columns.units)
    if {"robot", "convention", "flip"}.intersection(filter(None, columns.fields)) or units is None:
        return
    rows = []
    for _, batch in source.batches():
        for cells in batch:
            named = zip(fields, (text_of(cell).strip(SPACES) for cell in cells), strict=False)
            if row := {field: text for field, text in named if field and text}:
                rows.append(row)
    said = statements_of(top.statements, default_name=path.stem)
    if said is not None:
        yield TableText(**{**said, **units}, rows=tuple(rows))


def _top(table: TableText) -> dict[str, str]:
    """What comment lines say, by key, in their order."""
    said = {"name": yaml_word(table.name) if table.name.strip() else "", "convention": table.convention}
    if (table.length_unit, table.angle_unit) != ("m", "rad"):
        said["length_unit"] = units_text(table)
    said |= {"base": table.base, "tool": table.tool, "payload": table.payload, "defaults": table.defaults}
    return {field: text for field, text in said.items() if text.strip()}


def _cell(text: str) -> str:
    """A text as a cell, quoted where it has to be."""
    if not _QUOTED.intersection(text):
        return text
    written = io.StringIO()
    csv.writer(written, lineterminator="", quoting=csv.QUOTE_ALL).writerow([text])
    return written.getvalue()


def _common_units(units: Mapping[str, Unit]) -> dict[str, str] | None:
    """The units of headers as those of a whole table; None where columns differ."""
    return units_of({unit.symbol for unit in units.values()})
