"""The grammar that all tables share: rows of cells with their places become manipulators.

A reader of another container, such as a spreadsheet or a page of a document, hands its rows to `read_table` and has
everything that the reader `csv` has: headers in any spelling, units, expressions, several manipulators in a table, and
messages that name the cell.
"""

from __future__ import annotations

from pathlib import PurePath
from typing import TYPE_CHECKING

from dh2urdf.columns import ManipulatorGroups
from dh2urdf.errors import TableError
from dh2urdf.source import Mark
from dh2urdf.table_text import CellRow
from dh2urdf_plugins.readers.comments.top import read_top
from dh2urdf_plugins.readers.options import TableOptions, ignored_columns
from dh2urdf_plugins.readers.tables.cell_rows import CellRows
from dh2urdf_plugins.readers.tables.row_table import RowTable
from dh2urdf_plugins.readers.words.cells import Cell

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from dh2urdf.documents import Node
    from dh2urdf.manipulator import Manipulator
    from dh2urdf.source import Problem
    from dh2urdf.stages import Rejected
    from dh2urdf.table_text import Trace

__all__ = ["CellRow", "TableOptions", "read_table"]


def read_table(
    rows: Iterable[CellRow],
    file: str,
    options: TableOptions,
    *,
    name: str | None = None,
    statements: Mapping[str, Node] | None = None,
    decimal_comma: bool = False,
    notices: Iterable[Problem] = (),
    trace: Trace | None = None,
) -> Iterator[Manipulator | Rejected]:
    """The manipulators of a table.

    The first row that names two of a, alpha, d and theta is the header. What is above it says what holds for all
    rows: ``# convention: standard``, ``# units: {length: mm, angle: deg}``, in one cell or in several. Empty rows, and
    comments that begin with #, may stand anywhere.

    Args:
        rows: the rows of the table from the top; they are read one by one and not held.
        file: what messages name as the file.
        options: what the table does not say itself.
        name: what the manipulator is called where the table does not say it; the file's name without its suffix by
            default.
        statements: what the file says outside its rows, by key: name, convention, units, base, tool, defaults.
        decimal_comma: whether ``0,5`` is a number: it is none where commas separate cells.
        notices: what the reader of the container reports about the file; they come with the first manipulator.
        trace: takes what the cells of each manipulator say before the manipulator is yielded; None where that is not
            wanted, which is faster.

    Yields:
        Each manipulator, or what is wrong with it.

    Raises:
        TableError: there is no header, or it is wrong, or a statement about all rows is.
    """
    stem = PurePath(file).stem if name is None else name
    source = CellRows(rows, decimal_comma=decimal_comma)
    return one_by_one(read_rows(source, file, options, stem, statements=statements, notices=notices, trace=trace))


def read_rows(
    source: CellRows,
    file: str,
    options: TableOptions,
    name: str,
    *,
    statements: Mapping[str, Node] | None = None,
    notices: Iterable[Problem] = (),
    trace: Trace | None = None,
) -> Iterator[Manipulator | ManipulatorGroups | Rejected]:
    """The same of rows in a source, but manipulators about which there is nothing to say come in columns."""
    whole = Mark(file=file)
    try:
        ignore = ignored_columns(options)
        top = read_top(source, whole, statements, convention=options.convention, ignore=ignore)
    except TableError as error:
        raise TableError(error.problems, [*notices, *error.notices]) from error
    table = RowTable(Cell(name, whole), options, top, source, trace)
    table.notices += notices
    yield from table.manipulators()


def one_by_one(items: Iterable[Manipulator | ManipulatorGroups | Rejected]) -> Iterator[Manipulator | Rejected]:
    """The manipulators that a reader yields, of which some come in columns."""
    for item in items:
        if isinstance(item, ManipulatorGroups):
            yield from item.tables()
        else:
            yield item
