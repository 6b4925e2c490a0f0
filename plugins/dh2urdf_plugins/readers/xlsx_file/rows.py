"""The rows of a sheet of a workbook, as the grammar of all tables takes them."""

from __future__ import annotations

import datetime as dt
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, overload

from dh2urdf.source import Mark, Problem, shown
from dh2urdf.table_text import CellRow
from dh2urdf_plugins.readers.words.cells import text_of
from dh2urdf_plugins.readers.xlsx_file.formats import ShownOtherwiseError, shown_unit
from dh2urdf_plugins.readers.xlsx_file.workbook import SheetLayout

if TYPE_CHECKING:
    from collections.abc import Iterator

    Value = str | float | Problem | None

_EXACT = 2**53
"""Whole numbers up to here are doubles."""
_RAISED = str.maketrans("0123456789+-−oO", "⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻⁻ºº")
_MOMENTS = {
    dt.datetime: "a date",
    dt.date: "a date",
    dt.time: "a time",
    dt.timedelta: "a duration",
}


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
        struck: places of cells that are struck through.
    """

    sheet: Any
    file: str
    layout: SheetLayout
    header: int = 0
    columns: set[int] = field(default_factory=set)
    struck: list[Mark] = field(default_factory=list)

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
                _put(values, column, self._of_fonts(blocks, cell_mark(self.file, title, number, column)))
            merged.fill(number, values)
            filled = [index for index, value in enumerate(values, start=1) if value is not None]
            if filled or not was_empty:
                del values[filled[-1] if filled else 0 :]
                marks = _Marks(self.file, title, number, len(values))
                yield CellRow(values, cell_mark(self.file, title, number, filled[0] if filled else 1), marks)
            was_empty = not filled

    def _value(self, cell: Any) -> Value:  # noqa: ANN401 - a cell of openpyxl
        value = cell.value
        if cell.has_style and cell.font is not None and cell.font.strike:
            self.struck.append(self._mark(cell))
        if cell.data_type == "e":
            return self._problem(
                cell,
                f"the cell shows the error {value}",
                str(value),
                "a number or text",
                "fix the formula, and save the workbook again",
            )
        if isinstance(value, bool | str | list):
            return self._of_fonts(value, self._mark(cell)) if isinstance(value, list) else value
        for kind, what in _MOMENTS.items():
            if isinstance(value, kind):
                return self._problem(
                    cell,
                    f"the cell holds {what}, {value}",
                    str(value),
                    "a number or text",
                    "a spreadsheet makes dates of 1/2 and 3-4: format the cell as text, and type it again",
                )
        if not isinstance(value, int | float):
            return self._problem(cell, f"the cell holds {type(value).__name__}", str(value), "a number or text", None)
        text = text_of(float(value)) if abs(value) <= _EXACT else str(value)
        try:
            unit = shown_unit(cell.number_format or "General", negative=value < 0, zero=value == 0)
        except ShownOtherwiseError as error:
            return self._problem(
                cell,
                f"the cell holds {text}, and its number format {shown(cell.number_format)} shows {error}",
                text,
                'a number format without text, or one that shows a unit, such as 0.00" mm"',
                None,
            )
        return f"{text} {unit}" if unit else float(value) if abs(value) <= _EXACT else text

    def _of_fonts(self, blocks: Sequence[Any], mark: Mark) -> Value:
        """A text whose parts have fonts of their own: 300 with a raised 1 is no 3001, and m with a raised 2 is m²."""
        fonts = [None if isinstance(block, str) else block.font for block in blocks]
        if any(font is not None and font.strike for font in fonts):
            return Problem(
                message="a part of the cell is struck through",
                mark=mark,
                found="".join(map(str, blocks)),
                accepted="a cell without such a part",
                suggestion="delete that part",
            )
        raised = [font is not None and font.vertAlign == "superscript" for font in fonts]
        texts = [str(block).translate(_RAISED) if up else str(block) for block, up in zip(blocks, raised, strict=True)]
        return "".join(texts)

    def _mark(self, cell: Any) -> Mark:  # noqa: ANN401 - a cell of openpyxl
        return cell_mark(self.file, self.sheet.title, cell.row, cell.column)

    def _problem(self, cell: Any, message: str, found: str, accepted: str, suggestion: str | None) -> Problem:  # noqa: ANN401
        return Problem(message=message, mark=self._mark(cell), found=found, accepted=accepted, suggestion=suggestion)


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
            _put(values, first, value)
            if last > first and not isinstance(value, Problem):
                values[first - 1] = _across(values[first - 1])
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
    return Problem(
        message=f"the cell with {shown(text)} is merged across several columns",
        found=text,
        accepted="a cell of its own in each column",
    )
