"""Reads Denavit-Hartenberg tables from workbooks of Excel and LibreOffice (xlsx).

A sheet may hold a table anywhere: titles above it, notes beside and below it. Cells are read as those of a CSV file;
formulas by the values that the workbook holds, and numbers with the unit that their number format shows.
"""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from dh2urdf.errors import MissingDependencyError, TableError
from dh2urdf.source import Mark, Problem, did_you_mean, listed, shown
from dh2urdf.stages import Rejected
from dh2urdf_plugins.readers.comments.top import find_header
from dh2urdf_plugins.readers.table import read_table

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from dh2urdf.manipulator import Manipulator
    from dh2urdf.table_text import Trace
    from dh2urdf_plugins.readers.options import XlsxOptions
    from dh2urdf_plugins.readers.xlsx_file.rows import SheetRows

_FEW = 8


def read_workbook(path: Path, options: XlsxOptions, trace: Trace | None = None) -> Iterator[Manipulator | Rejected]:
    """The manipulators of a workbook: those of every sheet that holds a table and is not hidden.

    Args:
        path: the file.
        options: what the workbook does not say itself, and which sheet is read.
        trace: takes what the cells of each manipulator say, where it is wanted.

    Yields:
        Each manipulator, or what is wrong with it.

    Raises:
        TableError: the file is no workbook, holds no table, or its one table has no header that can be read.
        MissingDependencyError: openpyxl is not installed.
    """
    try:
        from openpyxl import chartsheet, reader
    except ImportError as error:
        raise MissingDependencyError("reader 'xlsx'", "openpyxl", "dh2urdf[xlsx]", error) from None
    from dh2urdf_plugins.readers.xlsx_file.workbook import check_workbook

    class WithoutCharts(reader.excel.ExcelReader):  # type: ignore[misc]
        """A sheet that is a chart holds no table, and openpyxl fails with an empty one."""

        def read_chartsheet(self, sheet: Any, rel: Any) -> None:  # noqa: ANN401, ARG002 - openpyxl's signature
            self.wb._sheets.append(chartsheet.Chartsheet(parent=self.wb, title=sheet.name))  # noqa: SLF001 - as openpyxl does

    check_workbook(path)
    with _reporting_errors(path):
        opened = WithoutCharts(path, read_only=True, data_only=True, keep_links=False, rich_text=True)
        opened.read()
        book = opened.wb
    try:
        yield from _Workbook(path, book, options, trace).manipulators()
    finally:
        book.close()


class _Workbook:
    """A workbook that is being read."""

    def __init__(self, path: Path, book: Any, options: XlsxOptions, trace: Trace | None) -> None:  # noqa: ANN401
        from dh2urdf_plugins.readers.xlsx_file.workbook import sheet_parts

        self.path = path
        self.trace = trace
        self.file = str(path)
        self.options = options
        self.notices: list[Problem] = []
        with _reporting_errors(path):
            self.parts = sheet_parts(path)
        self.sheets = [sheet for sheet in book.worksheets if sheet.title in self.parts]

    def manipulators(self) -> Iterator[Manipulator | Rejected]:
        """Those of each sheet that is read."""
        tables = self._tables()
        if len(tables) == 1:
            yield from self._read(tables[0], self.path.stem)
            return
        for table in tables:
            title = table.sheet.title
            try:
                yield from self._read(table, title)
            except TableError as error:
                place = Mark(file=self.file, place=title)
                yield Rejected(name=title, problems=tuple(error.problems), mark=place, notices=error.notices)

    def _read(self, table: SheetRows, name: str) -> Iterator[Manipulator | Rejected]:
        notices = [*self.notices, *_hidden(table), *_comments(table)]
        self.notices = []
        rows = _guarded(table, self.path)
        for item in read_table(
            rows,
            self.file,
            self.options,
            name=name,
            decimal_comma=True,
            notices=notices,
            trace=self.trace,
        ):
            struck, table.struck = table.struck, []
            yield replace(item, notices=(*item.notices, _struck(struck))) if struck else item

    # --- Sheets -------------------------------------------------------------------------------------------------------

    def _tables(self) -> list[SheetRows]:
        """The sheets to read.

        Raises:
            TableError: there are none.
        """
        if self.options.sheet is not None:
            return [self._table(self._named(self.options.sheet))]
        shown_sheets = [sheet for sheet in self.sheets if sheet.sheet_state == "visible"]
        hidden = [sheet.title for sheet in self.sheets if sheet.sheet_state != "visible"]
        tables = [self._table(sheet) for sheet in shown_sheets]
        found = [table for table in tables if table.header]
        if not found and len(tables) == 1:
            found = tables  # the grammar says what its header lacks
        if not found:
            titles = [table.sheet.title for table in tables]
            message = f"no sheet holds a table: {_listed(titles)}" if titles else "the workbook shows no sheet"
            raise TableError(
                Problem(
                    message=message,
                    mark=Mark(file=self.file),
                    accepted="a sheet with a header of at least the columns a, alpha and d, and one row for each joint",
                    suggestion=f"hidden sheets are read where the option sheet names them: {_listed(hidden)}"
                    if hidden
                    else None,
                )
            )
        unread = [table.sheet.title for table in tables if table not in found]
        for titles, why in ((unread, "holds no table"), (hidden, "is hidden")):
            if titles:
                words = "the sheet" if len(titles) == 1 else "each of the sheets"
                message = f"{words} {_listed(titles)} {why}, and is not read"
                self.notices.append(Problem(message=message, severity="notice", mark=Mark(file=self.file)))
        return found

    def _named(self, title: str) -> Any:  # noqa: ANN401 - a sheet of openpyxl
        by_title = {sheet.title.casefold(): sheet for sheet in self.sheets}
        if title.casefold() in by_title:
            return by_title[title.casefold()]
        titles = [sheet.title for sheet in self.sheets]
        raise TableError(
            Problem(
                message=f"the workbook has no sheet {shown(title)}",
                mark=Mark(file=self.file),
                field="sheet",
                found=title,
                accepted=_listed(titles),
                suggestion=next((f"did you mean {near!r}?" for near in titles if _is_near(title, near)), None),
            )
        )

    def _table(self, sheet: Any) -> SheetRows:  # noqa: ANN401 - a sheet of openpyxl
        from dh2urdf_plugins.readers.xlsx_file.rows import SheetRows
        from dh2urdf_plugins.readers.xlsx_file.workbook import read_layout

        with _reporting_errors(self.path):
            table = SheetRows(sheet, self.file, read_layout(self.path, self.parts[sheet.title]))
            header = find_header(table)
        table.struck = []
        if header:
            table.header = header.mark.line or 0
            table.columns = {index for index, cell in enumerate(header.cells, start=1) if cell is not None}
        return table


def _is_near(title: str, other: str) -> bool:
    return did_you_mean(title, [other.casefold()]) is not None


def _guarded(rows: SheetRows, path: Path) -> Iterator[Any]:
    """The rows of a sheet, with errors of the table where the workbook is broken."""
    left = iter(rows)
    while True:
        with _reporting_errors(path):
            row = next(left, None)
        if row is None:
            return
        yield row


def _hidden(table: SheetRows) -> list[Problem]:
    """A notice of hidden rows and columns, which are read as all others."""
    from dh2urdf_plugins.readers.xlsx_file.rows import cell_mark, letters

    layout, title = table.layout, table.sheet.title
    rows = [row for row in layout.hidden_rows if row >= table.header]
    columns = [
        letters(column)
        for column in sorted(table.columns)
        if any(first <= column <= last for first, last in layout.hidden_columns)
    ]
    found = [*(f"row {row}" for row in rows[:_FEW]), *(f"column {name}" for name in columns[:_FEW])]
    more = len(rows) + len(columns) - len(found)
    if not found:
        return []
    message = f"what is hidden is read too: {', '.join(found)}{f' and {more} more' if more else ''}"
    place = cell_mark(table.file, title, rows[0], 1) if rows else Mark(file=table.file, place=title)
    return [
        Problem(message=message, severity="notice", mark=place, suggestion="delete what does not belong to the table")
    ]


def _comments(table: SheetRows) -> list[Problem]:
    """Notices of the comments on cells, from which nothing is read."""
    from dh2urdf_plugins.readers.xlsx_file.rows import cell_mark

    found, title = table.layout.comments, table.sheet.title
    notices = [
        Problem(
            message=f"the comment {shown(text)} is not read",
            severity="notice",
            mark=cell_mark(table.file, title, row, column),
            suggestion="write what is part of the arm into a cell: a unit into the header, a convention above it",
        )
        for row, column, text in found[:_FEW]
    ]
    if len(found) > _FEW:
        message = f"{len(found) - _FEW} more comments on cells are not read"
        notices.append(Problem(message=message, severity="notice", mark=Mark(file=table.file, place=title)))
    return notices


def _struck(places: Sequence[Mark]) -> Problem:
    cells = listed([mark.in_file.rpartition("!")[2] for mark in places], _FEW)
    return Problem(
        message=f"what is struck through is read too: {cells}",
        severity="notice",
        mark=places[0],
        suggestion="delete what does not belong to the table",
    )


def _listed(titles: Sequence[str]) -> str:
    return listed([shown(title) for title in titles], _FEW)


@contextmanager
def _reporting_errors(path: Path) -> Iterator[None]:
    """Turn what openpyxl reports about a broken workbook into an error of the table.

    Raises:
        TableError: openpyxl raised anything, as it does in many ways.
    """
    try:
        yield
    except TableError:
        raise
    except Exception as error:
        reason = (str(error) or type(error).__name__).splitlines()[0]
        message = f"the workbook cannot be read: {shown(reason)[1:-1]}"
        accepted = "a workbook as Excel and LibreOffice save it (.xlsx)"
        raise TableError(Problem(message=message, mark=Mark(file=str(path)), accepted=accepted)) from error
