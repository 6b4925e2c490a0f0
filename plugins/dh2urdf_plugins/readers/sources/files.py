"""The one way into tables that are texts: what a file is, by its suffix or by its first lines, and who reads it."""

from __future__ import annotations

import csv
import io
import re
from contextlib import suppress
from itertools import chain, islice
from typing import TYPE_CHECKING

from dh2urdf.documents import decoded, read_bytes
from dh2urdf.errors import TableError
from dh2urdf.source import Mark, Messages
from dh2urdf_plugins.readers.comments.top import is_header
from dh2urdf_plugins.readers.sources.delimited import CsvRows, line_blocks
from dh2urdf_plugins.readers.sources.texts import all_tables, delimiter_of, form_of, grammar_rows, tables_of
from dh2urdf_plugins.readers.table import one_by_one, read_rows
from dh2urdf_plugins.readers.tables.cell_rows import CellRows, choose

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from dh2urdf.columns import ManipulatorGroups
    from dh2urdf.manipulator import Manipulator
    from dh2urdf.stages import Rejected
    from dh2urdf.table_text import Trace
    from dh2urdf_plugins.readers.options import TableOptions

FORMS = {".md": "markdown", ".tex": "latex"}
"""The forms that a suffix says; of other files the first lines say it."""
say = Messages(__file__)
_TOP = 100
"""Lines in which the header of a CSV file is."""
_LONGEST = 2**24
"""Bytes of a text that is no CSV [B]."""


def read_file(path: Path, options: TableOptions, trace: Trace | None = None) -> Iterator[Manipulator | Rejected]:
    """The manipulators of a text of any form; see `read` of the stage ``csv``."""
    return one_by_one(read_file_columns(path, options, trace))


def read_file_columns(
    path: Path, options: TableOptions, trace: Trace | None = None
) -> Iterator[Manipulator | ManipulatorGroups | Rejected]:
    """The same, most of the manipulators of a CSV file in columns."""
    form = _form_of(path, named=bool(options.columns))
    if form == "yaml":
        from dh2urdf_plugins.readers.sources.documents import read_documents

        yield from read_documents(path, options, trace)
        return
    file = str(path)
    if form == "csv" and not options.columns:
        rows: CellRows = CsvRows(path, options.table_number)
    else:
        text = decoded(read_bytes(path, TableError, limit=_LONGEST), file, TableError)
        tables = all_tables(text, file, form) if form == "csv" else tables_of(text, file, form)
        places = [str(table.rows[0].mark.in_file) for table in tables]
        table = choose(tables, places, options.table_number, path)
        rows = CellRows(grammar_rows(table, options.column_names, file), decimal_comma=True)
    yield from read_rows(rows, file, options, path.stem, trace=trace)


def _form_of(path: Path, *, named: bool = False) -> str:
    """The form of a file."""
    lines = list(chain.from_iterable(islice(line_blocks(path), 2)))
    form = FORMS.get(path.suffix.lower()) or form_of(lines)
    if path.suffix.lower() in (".csv", ".tsv") and form != "csv":
        is_csv = any(map(delimiter_of, lines[:_TOP]))  # a header in a comment, perhaps
        if not is_csv and form in ("blanks", "listing") and not named:
            tables = all_tables("\n".join(lines), str(path), form)
            is_csv = not any(is_header(row) for table in tables for row in table.rows)
        form = "csv" if is_csv else form  # whose reader says what its header lacks
    if form == "csv" and named and any(map(delimiter_of, lines)):
        raise TableError(say("two-headers", Mark(file=str(path)), field="columns"))
    return form


_COMMA = re.compile(r"([-+−–]?\d+),(\d+)")
_GROUPS = re.compile(r"[-+−–]?[1-9]\d{0,2}(?:,\d{3})+")
"""A number whose commas may separate thousands: the reader asks which."""


def cells_of(text: str) -> list[list[str]]:
    """The cells of a text of any form, row by row, without what is around them; one line is one cell at least.

    Decimal commas become points where they can be nothing else.
    """
    text = text.replace("\r\n", "\n").replace("\r", "\n").rstrip("\n")
    lines = text.split("\n")
    form = form_of(lines)
    rows: list[list[str]] = []
    if form not in ("csv", "yaml"):
        with suppress(TableError):  # A program changes the numbers: they are no cells.
            found = tables_of(text, "", form) if form == "blanks" else all_tables(text, "", form)
            rows = [[_typed(str(cell)) for cell in row.cells] for row in found[0].rows] if len(found) == 1 else []
    if not rows:
        sign = next((sign for sign in "\t;," if any(sign in line for line in lines)), None)
        commas = {line.count(",") for line in lines}
        if sign == "," and (len(commas) > 1 or all(_COMMA.fullmatch(line.strip()) for line in lines)):
            sign = None
        cut = csv.reader(io.StringIO(text), delimiter=sign or "\0", skipinitialspace=True)
        rows = [[" ".join(cell.split()) for cell in row] for row in cut if row] or [[""]]
    with_commas = {cell for row in rows for cell in row if _COMMA.fullmatch(cell)}
    if all(map(_GROUPS.fullmatch, with_commas)) or any(re.search(r"\d\.\d", cell) for row in rows for cell in row):
        return rows
    return [[_COMMA.sub(r"\1.\2", cell) if cell in with_commas else cell for cell in row] for row in rows]


def _typed(cell: str) -> str:
    """A cell as a person would type it: ``pi/2`` for ``np.pi/2`` and for ``((pi)/(2))``."""
    plain = re.sub(r"\b(?:np|numpy|math)\.|\bM_(?=PI\b)", "", cell).replace("PI", "pi")
    return re.sub(r"\(\(([\w.]+)\)/\(([\w.]+)\)\)", r"\1/\2", plain)
