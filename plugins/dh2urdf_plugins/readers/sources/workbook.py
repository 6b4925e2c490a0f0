"""Tables in the sheets of workbooks of Excel and LibreOffice: what openpyxl parses, with what a cell shows beside it.

openpyxl's read-only sheets leave out merged cells and texts of several fonts, and give nothing for a formula that was
never computed. Its parser knows all of them, so it is called here.
"""

from __future__ import annotations

import datetime as dt
import re
import zipfile
from contextlib import contextmanager
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from openpyxl.cell.read_only import ReadOnlyCell
from openpyxl.chartsheet import Chartsheet
from openpyxl.reader.excel import ExcelReader
from openpyxl.utils import get_column_letter
from openpyxl.worksheet._reader import FORMULA_TAG, INLINE_STRING, VALUE_TAG, WorkSheetParser

from dh2urdf.documents import BROKEN_ARCHIVE, check_file, kind_of_file
from dh2urdf.errors import TableError
from dh2urdf.quantities import is_unit
from dh2urdf.source import Mark, Messages, Problem, did_you_mean, listed, shown
from dh2urdf.stages import Rejected
from dh2urdf.table_text import CellRow
from dh2urdf_plugins.readers.comments.top import MAX_TITLES, is_header
from dh2urdf_plugins.readers.table import read_table
from dh2urdf_plugins.readers.tables.cell_rows import choose, one_table, starts_table
from dh2urdf_plugins.readers.words.cells import text_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from dh2urdf.manipulator import Manipulator
    from dh2urdf.table_text import Trace
    from dh2urdf_plugins.readers.options import XlsxOptions

    Value = str | float | Problem | None

MAX_UNPACKED = 2**29
"""Bytes of a workbook when unpacked [B]: a zip archive may hold a thousand times its own size."""
MAX_PARTS = 10_000
"""Parts of a workbook."""
_PROLOG = 2**16
_STRICT = b"http://purl.oclc.org/ooxml/"
"""What the names of a strict workbook's elements begin with (ISO/IEC 29500-1); openpyxl knows the transitional ones."""

MAX_ROW, MAX_COLUMN = 2**20, 2**14
"""The last row and column of a sheet in Excel."""
_YES = ("1", "true")
_EXACT = 2**53
"""Whole numbers up to here are doubles."""
_RAISED = str.maketrans("0123456789+-−oO", "⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻⁻ºº")
_MOMENTS = {dt.datetime: "a date", dt.date: "a date", dt.time: "a time", dt.timedelta: "a duration"}
_TOKENS = re.compile(
    r'"(?P<quoted>[^"]*)"|\\(?P<escaped>.)|_.|\*.|\[\$(?P<currency>[^\]-]*)[^\]]*\]|\[[^\]]*\]'
    r"|(?P<code>General|E[+-]|[0#?.,/%@])|(?P<bare>.)",
    re.IGNORECASE | re.DOTALL,
)
"""The parts of a section of a number format (ECMA-376-1, 18.8.31)."""
_NEUTRAL = "()+-− \u00a0\u202f"
"""Characters beside a number that do not change what it means; between digits, apostrophes do not, either."""

say = Messages(__file__)


def read_workbook(path: Path, options: XlsxOptions, trace: Trace | None = None) -> Iterator[Manipulator | Rejected]:
    """The manipulators of a workbook: those of every sheet that holds a table and is not hidden."""
    check_workbook(path)
    with reporting_errors(path):
        opened = _Reader(path, read_only=True, data_only=True, keep_links=False, rich_text=True)
        opened.read()
        sheets = opened.wb.worksheets  # without those that are charts
    try:
        tables, notices = _tables(path, sheets, options.sheet)
        found = [(table, at) for table in tables for at in range(1, len(table.headers) + 1)]
        if options.table_number is not None:
            found = [_chosen(found, options.table_number, path)]
            tables = [found[0][0]]
        for table in tables:
            name = path.stem if len(tables) == 1 else table.title
            try:
                own = [each for each in found if each[0] is table]  # none: the reader of tables says what it lacks
                number = _chosen(own, None, path)[1] if own else 1
                rows, said = one_table(table, number) if len(table.headers) > 1 else table, [*notices, *table.hidden()]
                yield from read_table(
                    rows, str(path), options, name=name, decimal_comma=True, notices=said, trace=trace
                )
            except TableError as error:
                if len(tables) == 1:
                    raise
                place = Mark(file=str(path), place=table.title)
                yield Rejected(name=name, problems=tuple(error.problems), mark=place, notices=tuple(error.notices))
            notices = []
    finally:
        opened.wb.close()


def _chosen(found: Sequence[tuple[SheetRows, int]], number: int | None, path: Path) -> tuple[SheetRows, int]:
    """The sheet that has the table that is meant, and the table's number on it."""
    return choose(found, [str(table.headers[at - 1].mark.in_file) for table, at in found], number, path)


def _tables(path: Path, sheets: Sequence[Any], wanted: str | None) -> tuple[list[SheetRows], list[Problem]]:
    """The sheets to read, and notices of the others."""
    mark, titles = Mark(file=str(path)), [sheet.title for sheet in sheets]
    if wanted is not None:
        by_title = {title.casefold(): sheet for title, sheet in zip(titles, sheets, strict=True)}
        if sheet := by_title.get(wanted.casefold()):
            return [SheetRows(sheet, path)], []
        near = did_you_mean(wanted, titles)
        raise TableError(
            say("no-such-sheet", mark, field="sheet", found=wanted, titles=_listed(titles), suggestion=near)
        )
    hidden = [sheet.title for sheet in sheets if sheet.sheet_state != "visible"]
    tables = [SheetRows(sheet, path) for sheet in sheets if sheet.sheet_state == "visible"]
    found = [table for table in tables if table.headers] or (tables if len(tables) == 1 else [])
    if not found:
        advice = f"`--sheet NAME` reads one that is hidden: {_listed(hidden)}" if hidden else None
        code, visible = "no-sheet-with-a-table" if tables else "no-sheet", _listed([table.title for table in tables])
        raise TableError(say(code, mark, titles=visible, suggestion=advice))
    return found, [say("hidden-sheets", mark, titles=_listed(hidden))] if hidden else []


def _listed(titles: Sequence[str]) -> str:
    return listed([shown(title) for title in titles], 8)


def check_workbook(path: Path) -> None:
    """Refuses what is no workbook, and one that would cost too much."""
    check_file(path, TableError)
    mark = Mark(file=str(path))
    with path.open("rb") as binary:
        start = binary.read(100)
    if start.startswith(b"\xd0\xcf\x11\xe0"):
        raise TableError(say("old-workbook", mark))
    if not start.startswith(b"PK"):
        kind, advice = kind_of_file(start) or ("empty" if not start else "text", None)
        raise TableError(say("no-workbook", mark, kind=kind, suggestion=advice))
    try:
        with zipfile.ZipFile(path) as archive:
            if problem := _fault(mark, archive):
                raise TableError(problem)
    except BROKEN_ARCHIVE as error:
        raise TableError(say("broken-archive", mark, reason=str(error) or type(error).__name__)) from error


def _fault(mark: Mark, archive: zipfile.ZipFile) -> Problem | None:
    """Why an archive is not read; None where it is a workbook."""
    parts = {part.filename: part for part in archive.infolist()}
    if "[Content_Types].xml" not in parts or "xl/workbook.bin" in parts:
        return say("other-archive", mark)
    if "xl/workbook.xml" in parts and _STRICT in archive.open("xl/workbook.xml").read(_PROLOG):
        return say("strict-workbook", mark)
    size, count = sum(part.file_size for part in archive.infolist()), len(archive.infolist())
    if size > MAX_UNPACKED or count > MAX_PARTS:
        found = f"{size / 2**20:,.0f} MiB in {count:,} parts"
        most = f"at most {MAX_UNPACKED / 2**20:,.0f} MiB in {MAX_PARTS:,} parts"
        return say("large-workbook", mark, size=found, limit=most)
    for part in archive.infolist():
        if part.filename.endswith((".xml", ".rels")):
            with archive.open(part) as content:
                if b"<!DOCTYPE" in content.read(_PROLOG).replace(b"\0", b""):
                    return say("workbook-with-entities", mark, part=part.filename)
    return None


# --- Sheets -----------------------------------------------------------------------------------------------------------


class _Reader(ExcelReader):  # type: ignore[misc]
    """A sheet that is a chart holds no table, and openpyxl fails with an empty one."""

    def read_chartsheet(self, sheet: Any, rel: Any) -> None:  # noqa: ANN401, ARG002 - openpyxl's signature
        self.wb._sheets.append(Chartsheet(parent=self.wb, title=sheet.name))  # noqa: SLF001 - as openpyxl does


class _Layout(WorkSheetParser):  # type: ignore[misc]
    """Of a cell whether it holds anything; the parser itself notes what is merged and what is hidden."""

    def parse_cell(self, element: Any) -> bool:  # noqa: ANN401 - an element
        return bool(element.findtext(VALUE_TAG)) or element.find(INLINE_STRING) is not None


class _Cells(WorkSheetParser):  # type: ignore[misc]
    """The cells of a row, formulas without a value among them."""

    def parse_cell(self, element: Any) -> dict[str, Any]:  # noqa: ANN401 - an element
        cell: dict[str, Any] = super().parse_cell(element)
        if cell["row"] > MAX_ROW or cell["column"] > MAX_COLUMN:
            raise ValueError(f"the cell {element.get('r')} is beyond the last one of a sheet")
        # A formula whose value is an empty text has the type of texts, and is an empty cell.
        if cell["value"] is None and cell["data_type"] != "str" and element.find(FORMULA_TAG) is not None:
            cell["data_type"] = "f"
        return cell


@contextmanager
def reporting_errors(path: Path) -> Iterator[None]:
    """Turn what openpyxl raises of a broken workbook, which may be anything, into an error of the table."""
    try:
        yield
    except TableError:
        raise
    except Exception as error:
        reason = (str(error) or type(error).__name__).splitlines()[0]
        raise TableError(say("broken-workbook", Mark(file=str(path)), reason=shown(reason)[1:-1])) from error


def cell_mark(file: str, sheet: str, row: int, column: int) -> Mark:
    """The place of a cell: ``arm.xlsx:Sheet2!C4``."""
    plain = sheet.replace("_", "").isalnum() and not sheet[:1].isdigit()
    title = sheet if plain else f"'{sheet.replace(chr(39), chr(39) * 2)}'"
    return Mark(file=file, line=row, column=column, place=f"{title}!{get_column_letter(column)}{row}")


class SheetRows:
    """The rows of a sheet that hold anything, with one empty row where there are any between them."""

    def __init__(self, sheet: Any, path: Path) -> None:  # noqa: ANN401 - a sheet of openpyxl
        self.sheet, self.path, self.title = sheet, path, str(sheet.title)
        self.layout = self._parser(_Layout)
        self.filled = set[int]()  # hidden rows that hold anything
        with reporting_errors(path), self.layout.source:
            hidden = self.layout.row_dimensions
            for number, cells in self.layout.parse():
                if number > MAX_ROW:
                    raise ValueError(f"a row has the number {number:,}, and a sheet has {MAX_ROW:,} rows")
                if str(number) in hidden and any(cells):
                    self.filled.add(number)
        self.headers: list[CellRow] = []  # one for each table of the sheet
        for at, row in enumerate(self):
            if not self.headers and at > MAX_TITLES:
                break
            if starts_table(row) if self.headers else is_header(row):
                self.headers.append(row)

    def _parser(self, kind: type[Any]) -> Any:  # noqa: ANN401 - a parser of openpyxl
        book = self.sheet.parent
        return kind(
            self.sheet._get_source(),  # noqa: SLF001 - as openpyxl's own read-only sheet does
            self.sheet._shared_strings,  # noqa: SLF001
            data_only=True,
            epoch=book.epoch,
            date_formats=book._date_formats,  # noqa: SLF001
            timedelta_formats=book._timedelta_formats,  # noqa: SLF001
            rich_text=True,
        )

    def __iter__(self) -> Iterator[CellRow]:
        """The rows from the top."""
        first = self.headers[0].mark.line or 0 if self.headers else 0
        merged = _Merged(self.layout.merged_cells, first)
        parser, file, last = self._parser(_Cells), str(self.path), 0
        with reporting_errors(self.path), parser.source:
            for number, cells in parser.parse():
                values: list[Value] = []
                for cell in cells:
                    values += [None] * (cell["column"] - len(values))
                    values[cell["column"] - 1] = self._value(cell)
                merged.fill(number, values)
                filled = [index for index, value in enumerate(values, start=1) if value is not None]
                if not filled:
                    continue
                if number > last + 1 and last:
                    yield CellRow([], cell_mark(file, self.title, last + 1, 1))
                del values[filled[-1] :]
                marks = [cell_mark(file, self.title, number, column) for column in range(1, len(values) + 1)]
                yield CellRow(values, marks[filled[0] - 1], marks)
                last = number

    def hidden(self) -> list[Problem]:
        """A notice of hidden rows and columns, which are read as all others."""
        header = self.headers[0] if self.headers else CellRow([], Mark(file=str(self.path)))
        rows = [number for number in sorted(self.filled) if number >= (header.mark.line or 0)]
        found = [f"row {row}" for row in rows if self.layout.row_dimensions[str(row)].get("hidden") in _YES]
        columns = [each for each in self.layout.column_dimensions.values() if each.get("hidden") in _YES]
        for index, cell in enumerate(header.cells, start=1):
            if cell is not None and any(int(each["min"]) <= index <= int(each["max"]) for each in columns):
                found.append(f"column {get_column_letter(index)}")
        place = Mark(file=str(self.path), place=self.title)
        return [say("hidden-cells", place, hidden=listed(found, 8))] if found else []

    def _value(self, cell: dict[str, Any]) -> Value:  # noqa: PLR0911 - one for each kind of value
        """What a cell holds, and the unit that it shows."""
        value, kind = cell["value"], cell["data_type"]
        mark = cell_mark(str(self.path), self.title, cell["row"], cell["column"])
        if value is None:
            return say("formula-without-a-value", mark, found="") if kind == "f" else None
        styled = ReadOnlyCell(self.sheet, **cell)
        if styled.has_style and styled.font is not None and styled.font.strike:
            return say("struck-through", mark, found=str(value))
        if kind == "e":
            return say("error-in-a-cell", mark, found=str(value))
        if isinstance(value, bool | str | list):
            return _of_fonts(value, mark) if isinstance(value, list) else value
        if not isinstance(value, int | float):
            what = next((words for kind, words in _MOMENTS.items() if isinstance(value, kind)), type(value).__name__)
            return say("moment-in-a-cell", mark, found=str(value), kind=what)
        # A number, or a text where it has a unit or is no double.
        number_format, is_double = styled.number_format or "General", abs(value) <= _EXACT
        text = text_of(float(value)) if is_double else str(value)
        try:
            unit = shown_unit(number_format, (value > 0) - (value < 0))
        except ShownOtherwiseError as error:
            return say("shown-otherwise", mark, found=text, format=number_format, shows=error)
        return f"{text} {unit}" if unit else float(value) if is_double else text


def _of_fonts(blocks: Sequence[Any], mark: Mark) -> Value:
    """A text whose parts have fonts of their own: 300 with a raised 1 is no 3001, and m with a raised 2 is m²."""
    fonts = [None if isinstance(block, str) else block.font for block in blocks]
    if any(font is not None and font.strike for font in fonts):
        return say("struck-through", mark, found="".join(map(str, blocks)))
    raised = [font is not None and font.vertAlign == "superscript" for font in fonts]
    texts = map(str, blocks)
    return "".join(text.translate(_RAISED) if up else text for text, up in zip(texts, raised, strict=True))


class _Merged:
    """Fills merged cells.

    A cell that is merged down the rows of one column has its value in each row; so has one that is merged across
    columns, in the header and above it. Below the header nothing names the column of its value.
    """

    def __init__(self, merged: Any, header: int) -> None:  # noqa: ANN401 - `MergeCells`
        self.header = header
        self.starts: dict[int, list[tuple[int, int, int]]] = {}
        self.open: list[tuple[int, int, Value]] = []  # last row, column, and what is there
        for each in merged.mergeCell if merged else ():
            first, top, last, bottom = each.bounds
            self.starts.setdefault(top, []).append((first, last, bottom))

    def fill(self, number: int, values: list[Value]) -> None:
        """Fills the merged cells of a row."""
        self.open = [entry for entry in self.open if entry[0] >= number]
        for _, column, value in self.open:
            values += [None] * (column - len(values))
            values[column - 1] = value
        for first, last, bottom in self.starts.get(number, ()):
            value = values[first - 1] if first <= len(values) else None
            if value is None:
                continue
            if last > first and self.header - 1 <= number <= self.header:
                values += [None] * (last - len(values))
                values[first - 1 : last] = [value] * (last + 1 - first)
            elif last > first and not isinstance(value, Problem) and number > self.header > 0:
                text = value if isinstance(value, str) else text_of(float(value))
                values[first - 1] = value = say("merged-across", found=text)
            if bottom > number and not self.header - 1 <= number <= self.header:
                self.open.append((bottom, first, value))


# --- Number formats: what a cell shows beside its number, which may be its unit ---------------------------------------


class ShownOtherwiseError(ValueError):
    """A number format shows another number than the cell holds, or text that is no unit."""


@lru_cache(maxsize=1024)
def shown_unit(number_format: str, sign: int = 0) -> str:
    """The unit that a number format shows behind its number; empty where it shows none.

    ``0.00" mm"`` shows mm and ``0.0°`` shows °; ``0.00`` shows nothing. A second section, for negative numbers or under
    a condition, shows the same unit. A number whose sign is not 0 is shown with this sign, a negative one perhaps in
    brackets or a colour.
    """
    parts = re.findall(r'"[^"]*"|\\.|\[[^\]]*\]|;|[^;"\\\[]+|.', number_format, re.DOTALL)
    sections = "".join("\0" if part == ";" else part for part in parts).split("\0")
    shown = [_unit_of(section) for section in sections[:2]]  # the others are those of zero and of texts
    own = sign < 0 and len(shown) > 1  # a section of its own for negative numbers
    if shown[0] is None or (own and shown[1] is None):
        raise ShownOtherwiseError("nothing")
    if len({each[0] for each in shown if each}) > 1:
        raise ShownOtherwiseError("one unit for some numbers and another for others")
    unit, before, others = shown[own] or shown[0]
    is_signed = not {*"-−("}.isdisjoint(before) or (own and not {*"-["}.isdisjoint(others))
    if sign and own != is_signed and not re.search(r"\[[<>=]", number_format):
        raise ShownOtherwiseError("another sign")
    return unit


def _unit_of(section: str) -> tuple[str, str, str] | None:
    """The unit that a section of a format shows, the text before it and the rest; None where it shows no number."""
    before, between, behind, codes = "", "", "", ""
    for match in _TOKENS.finditer(section):
        text = match["quoted"] or match["escaped"] or match["currency"] or match["bare"] or ""
        if match["code"]:
            codes += match["code"]
            between, behind = between + behind, ""
        elif codes:
            behind += text
        else:
            before += text
    if not codes:
        return None
    if "%" in codes:
        raise ShownOtherwiseError("a percentage")
    if codes.rstrip("eE+-").endswith(","):
        raise ShownOtherwiseError("a multiple of a thousand")
    unit = behind.strip(_NEUTRAL)
    if before.strip(_NEUTRAL) or between.strip(f"{_NEUTRAL}'") or (unit and not is_unit(unit)):
        raise ShownOtherwiseError(f"the text '{(before + between + behind).strip()}'")
    return unit, before, behind + "[" * ("[" in section)
