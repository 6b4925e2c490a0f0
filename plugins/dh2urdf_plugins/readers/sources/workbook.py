"""Tables in the sheets of workbooks of Excel and LibreOffice: rows of cells, with what a cell shows beside its value.

openpyxl reads the values row by row, without holding a sheet. Merged cells, formulas that were never computed and texts
of several fonts are not among what it gives so, and are read from the sheet's XML (ECMA-376-1, part 18.3).
"""

from __future__ import annotations

import datetime as dt
import posixpath
import re
import zipfile
from collections import defaultdict
from collections.abc import Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NoReturn, overload

from lxml import etree

from dh2urdf.documents import BROKEN_ARCHIVE, check_file, kind_of_file
from dh2urdf.errors import MissingDependencyError, TableError
from dh2urdf.source import Mark, Problem, did_you_mean, listed, shown
from dh2urdf.stages import Rejected
from dh2urdf.table_text import CellRow
from dh2urdf_plugins.readers.comments.top import find_header
from dh2urdf_plugins.readers.sources.number_formats import ShownOtherwiseError, shown_unit
from dh2urdf_plugins.readers.table import read_table
from dh2urdf_plugins.readers.words.cells import text_of

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from dh2urdf.manipulator import Manipulator
    from dh2urdf.table_text import Trace
    from dh2urdf_plugins.readers.options import XlsxOptions

    Value = str | float | Problem | None

MAX_UNPACKED = 2**29
"""Bytes of a workbook when unpacked [B]: a zip archive may hold a thousand times its own size."""
MAX_PARTS = 10_000
"""Parts of a workbook."""
MAX_ROW, MAX_COLUMN = 2**20, 2**14
"""The last row and column of a sheet in Excel: rows that hold nothing are read up to the one that has a cell."""
_FEW = 8
_PROLOG = 2**16
_LONGEST_REFERENCE = 20
_EXACT = 2**53
"""Whole numbers up to here are doubles."""
_STRICT = b"http://purl.oclc.org/ooxml/"
"""What the names of a strict workbook's elements begin with (ISO/IEC 29500-1); openpyxl knows the transitional ones."""
_ACCEPTED = "a workbook in the format of Excel 2007 and later (.xlsx)"
_RAISED = str.maketrans("0123456789+-−oO", "⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻⁻ºº")
_MOMENTS = {dt.datetime: "a date", dt.date: "a date", dt.time: "a time", dt.timedelta: "a duration"}


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
        with _reporting_errors(path):
            parts = _sheet_parts(path)
        sheets = [sheet for sheet in book.worksheets if sheet.title in parts]
        tables, notices = _tables(path, sheets, parts, options.sheet)
        for table in tables:
            title = table.sheet.title
            name = path.stem if len(tables) == 1 else title
            try:
                said = [*notices, *_hidden(table)]
                rows = _guarded(table, path)
                yield from read_table(
                    rows, str(path), options, name=name, decimal_comma=True, notices=said, trace=trace
                )
            except TableError as error:
                if len(tables) == 1:
                    raise
                place = Mark(file=str(path), place=title)
                yield Rejected(name=title, problems=tuple(error.problems), mark=place, notices=tuple(error.notices))
            notices = []
    finally:
        book.close()


def _tables(
    path: Path, sheets: Sequence[Any], parts: dict[str, str], wanted: str | None
) -> tuple[list[SheetRows], list[Problem]]:
    """The sheets to read, and notices of the others.

    Raises:
        TableError: there are none, or not the one that is wanted.
    """
    mark = Mark(file=str(path))
    if wanted is not None:
        by_title = {sheet.title.casefold(): sheet for sheet in sheets}
        if sheet := by_title.get(wanted.casefold()):
            return [_table(path, sheet, parts)], []
        titles = [sheet.title for sheet in sheets]
        near = next((title for title in titles if did_you_mean(wanted, [title.casefold()])), None)
        raise TableError(
            Problem(
                message=f"the workbook has no sheet {shown(wanted)}",
                mark=mark,
                field="sheet",
                found=wanted,
                accepted=_listed(titles),
                suggestion=f"did you mean {near!r}?" if near else None,
            )
        )
    hidden = [sheet.title for sheet in sheets if sheet.sheet_state != "visible"]
    tables = [_table(path, sheet, parts) for sheet in sheets if sheet.sheet_state == "visible"]
    found = [table for table in tables if table.header] or (tables if len(tables) == 1 else [])
    if not found:
        titles = [table.sheet.title for table in tables]
        raise TableError(
            Problem(
                message=f"no sheet holds a table: {_listed(titles)}" if titles else "the workbook shows no sheet",
                mark=mark,
                accepted="a sheet with a header of at least the columns a, alpha and d, and one row for each joint",
                suggestion=f"`--sheet NAME` reads one that is hidden: {_listed(hidden)}" if hidden else None,
            )
        )
    if not hidden:
        return found, []
    message = f"hidden sheets are not read: {_listed(hidden)}"
    return found, [Problem(message=message, severity="notice", mark=mark, suggestion="`--sheet NAME` reads one")]


def _table(path: Path, sheet: Any, parts: dict[str, str]) -> SheetRows:  # noqa: ANN401 - a sheet of openpyxl
    with _reporting_errors(path):
        table = SheetRows(sheet, str(path), read_layout(path, parts[sheet.title]))
        header = find_header(table)
    if header:
        table.header = header.mark.line or 0
        table.columns = {index for index, cell in enumerate(header.cells, start=1) if cell is not None}
    return table


def _guarded(rows: SheetRows, path: Path) -> Iterator[CellRow]:
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
    layout = table.layout
    rows = [f"row {row}" for row in layout.hidden_rows if row >= table.header]
    hidden = [k for k in sorted(table.columns) if any(first <= k <= last for first, last in layout.hidden_columns)]
    found = [*rows, *(f"column {letters(column)}" for column in hidden)]
    if not found:
        return []
    message = f"what is hidden is read too: {listed(found, _FEW)}"
    advice = "delete what does not belong to the table"
    mark = Mark(file=table.file, place=table.sheet.title)
    return [Problem(message=message, severity="notice", mark=mark, suggestion=advice)]


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


# --- Rows -------------------------------------------------------------------------------------------------------------


def letters(column: int) -> str:
    """The name of a column, counted from 1: ``A``, ``Z``, ``AA``."""
    name = ""
    while column > 0:
        column, rest = divmod(column - 1, 26)
        name = chr(65 + rest) + name
    return name


def cell_mark(file: str, sheet: str, row: int, column: int) -> Mark:
    """The place of a cell: ``arm.xlsx:Sheet2!C4``."""
    plain = sheet.replace("_", "").isalnum() and not sheet[:1].isdigit()
    title = sheet if plain else f"'{sheet.replace(chr(39), chr(39) * 2)}'"
    return Mark(file=file, line=row, column=column, place=f"{title}!{letters(column)}{row}")


class _Marks(Sequence[Mark]):
    """The places of the cells of a row, made when asked for."""

    def __init__(self, file: str, sheet: str, row: int, width: int) -> None:
        self.file, self.sheet, self.row, self.width = file, sheet, row, width

    def __len__(self) -> int:
        return self.width

    @overload
    def __getitem__(self, index: int) -> Mark: ...
    @overload
    def __getitem__(self, index: slice) -> list[Mark]: ...
    def __getitem__(self, index: int | slice) -> Mark | list[Mark]:
        columns = range(1, self.width + 1)[index]
        if isinstance(columns, range):
            return [cell_mark(self.file, self.sheet, self.row, column) for column in columns]
        return cell_mark(self.file, self.sheet, self.row, columns)


@dataclass(slots=True)
class SheetRows:
    """The rows of a sheet.

    Attributes:
        sheet: the sheet, as openpyxl reads it.
        file: the workbook.
        layout: what the sheet has beside values.
        header: the row of the header, where it is known: cells that are merged across columns are one cell in each of
            them there and in the row above.
        columns: the columns that have a header.
    """

    sheet: Any
    file: str
    layout: SheetLayout
    header: int = 0
    columns: set[int] = field(default_factory=set)

    def __iter__(self) -> Iterator[CellRow]:
        """The rows that hold anything, with one empty row where there are any between them."""
        merged = _Merged(self.layout, self.header)
        title = self.sheet.title
        was_empty = True
        self.sheet.reset_dimensions()  # the size that it declares may be wrong, or a million rows
        for number, cells in enumerate(self.sheet.rows, start=1):
            values = [None if cell.value is None else self._value(cell) for cell in cells]
            for column in self.layout.uncomputed.get(number, ()):
                _put(values, column, _uncomputed(cell_mark(self.file, title, number, column)))
            for column, blocks in self.layout.fonts.get(number, {}).items():
                _put(values, column, _of_fonts(blocks, cell_mark(self.file, title, number, column)))
            merged.fill(number, values)
            filled = [index for index, value in enumerate(values, start=1) if value is not None]
            if filled or not was_empty:
                del values[filled[-1] if filled else 0 :]
                marks = _Marks(self.file, title, number, len(values))
                yield CellRow(values, cell_mark(self.file, title, number, filled[0] if filled else 1), marks)
            was_empty = not filled

    def _value(self, cell: Any) -> Value:  # noqa: ANN401 - a cell of openpyxl
        value, mark = cell.value, cell_mark(self.file, self.sheet.title, cell.row, cell.column)
        accepted = "a number or text"
        if cell.has_style and cell.font is not None and cell.font.strike:
            return _struck(str(value), mark)
        if cell.data_type == "e":
            advice = "fix the formula, and save the workbook again"
            message = f"the cell shows the error {value}"
            return Problem(message=message, mark=mark, found=str(value), accepted=accepted, suggestion=advice)
        if isinstance(value, bool | str | list):
            return _of_fonts(value, mark) if isinstance(value, list) else value
        if not isinstance(value, int | float):
            what = next((words for kind, words in _MOMENTS.items() if isinstance(value, kind)), type(value).__name__)
            advice = "a spreadsheet makes dates of 1/2 and 3-4: format the cell as text, and type it again"
            message = f"the cell holds {what}, {value}"
            return Problem(message=message, mark=mark, found=str(value), accepted=accepted, suggestion=advice)
        text = text_of(float(value)) if abs(value) <= _EXACT else str(value)
        try:
            unit = shown_unit(cell.number_format or "General", negative=value < 0, zero=value == 0)
        except ShownOtherwiseError as error:
            message = f"the cell holds {text}, and its number format {shown(cell.number_format)} shows {error}"
            accepted = 'a number format without text, or one that shows a unit, such as 0.00" mm"'
            return Problem(message=message, mark=mark, found=text, accepted=accepted)
        return f"{text} {unit}" if unit else float(value) if abs(value) <= _EXACT else text


def _of_fonts(blocks: Sequence[Any], mark: Mark) -> Value:
    """A text whose parts have fonts of their own: 300 with a raised 1 is no 3001, and m with a raised 2 is m²."""
    fonts = [None if isinstance(block, str) else block.font for block in blocks]
    if any(font is not None and font.strike for font in fonts):
        return _struck("".join(map(str, blocks)), mark)
    raised = [font is not None and font.vertAlign == "superscript" for font in fonts]
    texts = [str(block).translate(_RAISED) if up else str(block) for block, up in zip(blocks, raised, strict=True)]
    return "".join(texts)


def _struck(text: str, mark: Mark) -> Problem:
    message, advice = "the cell, or a part of it, is struck through", "delete what does not hold"
    return Problem(message=message, mark=mark, found=text, accepted="a cell without a line", suggestion=advice)


def _uncomputed(mark: Mark) -> Problem:
    return Problem(
        message="the cell holds a formula without a value",
        mark=mark,
        found="",
        accepted="a formula whose value the workbook holds too",
        suggestion="open the workbook in a spreadsheet program, which computes it, and save it",
    )


class _Merged:
    """Fills merged cells.

    A cell that is merged down the rows of one column has its value in each row; so has one that is merged across
    columns, in the header and above it. Below the header nothing names the column of its value.
    """

    def __init__(self, layout: SheetLayout, header: int) -> None:
        self.header = header
        self.starts = defaultdict(list)
        self.open: list[tuple[int, int, int, Value]] = []  # last row, first and last column, and what is there
        for first_row, first, last_row, last in layout.merged:
            self.starts[first_row].append((first, last_row, last))

    def fill(self, number: int, values: list[Value]) -> None:
        """Fills the merged cells of a row."""
        self.open = [entry for entry in self.open if entry[0] >= number]
        for _, first, last, value in self.open:
            _put(values, first, _across(value) if last > first else value)
        for first, last_row, last in self.starts.get(number, ()):
            value = values[first - 1] if first <= len(values) else None
            if value is None:
                continue
            if last > first and self.header - 1 <= number <= self.header:
                for column in range(first, last + 1):
                    _put(values, column, value)
            elif last > first and number > self.header > 0:
                values[first - 1] = value = _across(value)
            if last_row > number and (number > self.header or number < self.header - 1):
                self.open.append((last_row, first, last, value))


def _put(values: list[Value], column: int, value: Value) -> None:
    values.extend([None] * (column - len(values)))
    values[column - 1] = value


def _across(value: Value) -> Problem:
    if isinstance(value, Problem):
        return value
    text = value if isinstance(value, str) else text_of(float(value or 0))
    message = f"the cell with {shown(text)} is merged across several columns"
    return Problem(message=message, found=text, accepted="a cell of its own in each column")


# --- The file ---------------------------------------------------------------------------------------------------------


def check_workbook(path: Path) -> None:
    """Refuses what is no workbook, and one that would cost too much.

    Raises:
        TableError: the file is of another kind, is broken, holds too much, or XML that declares entities.
    """
    check_file(path, TableError)
    with path.open("rb") as binary:
        start = binary.read(100)
    if start.startswith(b"\xd0\xcf\x11\xe0"):
        _refuse(
            path,
            "this is a workbook of Excel 97 to 2003, or one with a password",
            "save it as .xlsx, without a password",
        )
    if not start.startswith(b"PK"):
        what, advice = kind_of_file(start) or ("empty" if not start else "text", "save the sheet as .xlsx")
        _refuse(path, f"this is no workbook: the file is {what}", advice)
    try:
        with zipfile.ZipFile(path) as archive:
            _check_parts(path, archive)
    except BROKEN_ARCHIVE as error:
        _refuse(path, f"the workbook is broken: {error or type(error).__name__}", "save it again")


def _check_parts(path: Path, archive: zipfile.ZipFile) -> None:
    parts = archive.infolist()
    names = {part.filename for part in parts}
    if "[Content_Types].xml" not in names or "xl/workbook.bin" in names:
        _refuse(path, "this zip archive is no workbook in XML; an OpenDocument (.ods) is none", "save it as .xlsx")
    if "xl/workbook.xml" in names and _STRICT in archive.open("xl/workbook.xml").read(_PROLOG):
        _refuse(path, "this is a workbook in the format Strict Open XML", "save it as `Excel Workbook (.xlsx)`")
    size = sum(part.file_size for part in parts)
    if size > MAX_UNPACKED or len(parts) > MAX_PARTS:
        found = f"{size / 2**20:,.0f} MiB in {len(parts):,} parts"
        raise TableError(
            Problem(
                message=f"the workbook holds {found} when unpacked",
                mark=Mark(file=str(path)),
                accepted=f"at most {MAX_UNPACKED / 2**20:,.0f} MiB in {MAX_PARTS:,} parts",
                suggestion="save the sheet as CSV: a CSV file of any length is read",
            )
        )
    for part in parts:
        if part.filename.endswith((".xml", ".rels")):
            with archive.open(part) as content:
                if b"<!DOCTYPE" in content.read(_PROLOG).replace(b"\0", b""):
                    _refuse(
                        path,
                        f"its part {part.filename} has a document type, as no spreadsheet writes it",
                        "save it again",
                    )


def _refuse(path: Path, message: str, suggestion: str) -> NoReturn:
    raise TableError(Problem(message=message, mark=Mark(file=str(path)), accepted=_ACCEPTED, suggestion=suggestion))


def _sheet_parts(path: Path) -> dict[str, str]:
    """The part of each sheet, by its title."""
    with zipfile.ZipFile(path) as archive:
        links = _links(archive, "_rels/.rels", "")
        book_name = next(part for part, kind in links.values() if kind.endswith("/officeDocument"))
        folder, _, file = book_name.rpartition("/")
        links = _links(archive, f"{folder}/_rels/{file}.rels", folder)
        book = etree.fromstring(archive.read(book_name), _parser())
        found = {}
        for sheet in book.iter("{*}sheet"):
            key = next((value for name, value in sheet.attrib.items() if str(name).endswith("}id")), "")
            if (target := links.get(str(key))) and target[1].endswith("/worksheet"):
                found[sheet.get("name", "")] = target[0]
        return found


def _parser() -> etree.XMLParser:
    return etree.XMLParser(resolve_entities=False, no_network=True)


def _links(archive: zipfile.ZipFile, name: str, folder: str) -> dict[str, tuple[str, str]]:
    """The part and the kind of each relation of a part."""
    found = {}
    for link in etree.fromstring(archive.read(name), _parser()).iter("{*}Relationship"):
        path = posixpath.join("/", folder, link.get("Target", ""))
        found[link.get("Id", "")] = posixpath.normpath(path).lstrip("/"), link.get("Type", "")
    return found


@dataclass(slots=True)
class SheetLayout:
    """What a sheet has beside values.

    Attributes:
        merged: the merged ranges: first row, first column, last row and last column, counted from 1.
        hidden_rows: rows that are not shown and hold anything.
        hidden_columns: first and last of each run of columns that are not shown.
        uncomputed: by row, the columns of formulas without a value.
        fonts: by row and column, texts of the sheet itself whose parts have fonts of their own.
    """

    merged: list[tuple[int, int, int, int]] = field(default_factory=list)
    hidden_rows: list[int] = field(default_factory=list)
    hidden_columns: list[tuple[int, int]] = field(default_factory=list)
    uncomputed: dict[int, list[int]] = field(default_factory=dict)
    fonts: dict[int, dict[int, Any]] = field(default_factory=dict)


def read_layout(path: Path, part: str) -> SheetLayout:
    """What a sheet has beside values.

    Args:
        path: the workbook.
        part: the sheet's part.
    """
    layout = SheetLayout()
    with zipfile.ZipFile(path) as archive, archive.open(part) as content:
        tags = [f"{{*}}{name}" for name in ("row", "col", "mergeCell")]
        parsed: Any = etree.iterparse(content, events=("end",), tag=tags, resolve_entities=False, no_network=True)
        number = 0
        for _, element in parsed:
            match etree.QName(element).localname:
                case "row":
                    number = int(element.get("r") or number + 1)
                    _see_row(layout, element, number)
                    element.clear()
                    while element.getprevious() is not None:
                        del element.getparent()[0]
                case "col" if _is_true(element.get("hidden")):
                    layout.hidden_columns.append((int(element.get("min", "1")), int(element.get("max", "1"))))
                case "mergeCell":
                    first, _, last = element.get("ref", "A1").partition(":")
                    layout.merged.append((*_cell(first), *_cell(last or first)))
    return layout


def _see_row(layout: SheetLayout, row: Any, number: int) -> None:  # noqa: ANN401 - an element
    column, filled = 0, False
    if number > MAX_ROW:
        raise ValueError(f"a row has the number {number:,}, and a sheet has {MAX_ROW:,} rows")
    for cell in row:
        column = _cell(cell.get("r"))[1] if cell.get("r") else column + 1
        value, inline = cell.findtext("{*}v"), cell.find("{*}is")
        filled = filled or bool(value) or inline is not None
        if inline is not None and inline.find("{*}r/{*}rPr") is not None:
            from openpyxl.cell.rich_text import CellRichText

            layout.fonts.setdefault(number, {})[column] = CellRichText.from_tree(inline)
        # A formula whose value is an empty text has the type of texts, and is an empty cell.
        if not value and cell.get("t") != "str" and cell.find("{*}f") is not None:
            layout.uncomputed.setdefault(number, []).append(column)
    if filled and _is_true(row.get("hidden")):
        layout.hidden_rows.append(number)


def _is_true(word: str | None) -> bool:
    return word in ("1", "true")


def _cell(ref: str) -> tuple[int, int]:
    """Row and column of a reference such as ``C4``.

    Raises:
        ValueError: it is beyond the last row or column of a sheet.
    """
    name = re.match(r"[^0-9]*", ref)
    column = 0
    for letter in (name[0] if name else "")[:_LONGEST_REFERENCE].replace("$", "").upper():
        column = 26 * column + ord(letter) - 64
    row = int(ref.lstrip("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz$")[:_LONGEST_REFERENCE] or 1)
    if row > MAX_ROW or column > MAX_COLUMN:
        raise ValueError(f"the cell {ref[:_LONGEST_REFERENCE]} is beyond the last one of a sheet")
    return row, column
