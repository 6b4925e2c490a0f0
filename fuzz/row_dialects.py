"""Known tables as rows: CSV files and workbooks, with what is above their headers."""

from __future__ import annotations

import codecs
import re
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from file_texts import NUMBER, WORDS, File, flow, statements
from known_units import DIMENSIONS as NUMBERS
from known_words import header_words, other_spelling
from statement_forms import as_cells, commented

if TYPE_CHECKING:
    import random
    from collections.abc import Iterator, Sequence

    from known_quantities import Text
    from known_tables import Arm, Column, Table


# --- Headers ----------------------------------------------------------------------------------------------------------


def first_headers(rng: random.Random, table: Table, *, bulk: bool) -> list[str]:
    """The headers of the columns of manipulators and of conventions, where the file has them."""
    fields = (["robot"] if bulk else []) + (["convention"] if table.convention_column else [])
    words = [header_words(field, table.language) or header_words(field) for field in fields]
    return [other_spelling(rng, rng.choice(found)) if rng.random() < 0.3 else found[0] for found in words]


def header_rows(rng: random.Random, before: Sequence[str], columns: Sequence[Column]) -> list[list[str]]:
    """A header in one row, with its units in a row below it, or with titles over several columns."""
    plain = [[*before, *(column.header for column in columns)]]
    has_units = any(column.parts and column.parts.unit for column in columns)
    first = next((k for k in range(len(columns) - 1) if _share_title(columns[k : k + 2])), None)
    form = rng.random()
    if form < 0.3 and has_units:
        none = rng.choice(["", "-", "–"])
        form_of_unit = rng.choice(["{}", "[{}]", "({})"])
        units = [
            form_of_unit.format(column.parts.unit) if column.parts and column.parts.unit else none for column in columns
        ]
        stems = [column.parts.stem if column.parts and column.parts.unit else column.header for column in columns]
        return [[*before, *stems], [none] * len(before) + units]
    if form > 0.7 and first is not None:
        title, unit = [""] * len(columns), columns[first].parts
        title[first] = f"Limits [{unit.unit}]" if unit and unit.unit else "Limits"
        names = [column.header for column in columns]
        names[first : first + 2] = ["lower", "upper"]
        return [[""] * len(before) + title, [*before, *names]]
    return plain


def _share_title(columns: Sequence[Column]) -> bool:
    """Whether two columns are the limits under headers of their own, which no test has changed."""
    own = all(column.header == (column.parts.text if column.parts else column.field) for column in columns)
    return own and [column.field for column in columns] == ["lower", "upper"]


# --- CSV --------------------------------------------------------------------------------------------------------------


def as_csv(rng: random.Random, table: Table, *, bulk: bool, plain: bool = False) -> File:
    """A CSV file of all arms of a table, or of its only one."""
    delimiter = "," if plain else rng.choice(",,;\t")
    comma = delimiter != "," and rng.random() < 0.5
    always = not plain and rng.random() < 0.2
    padding = 0 if plain or rng.random() < 0.7 else rng.randint(1, 4)
    space = "" if plain or always or rng.random() < 0.6 else " "
    columns = table.columns
    lines = []
    for key, value in statements(table, bulk=bulk).items():
        lines += [f"# {key}: {flow(value)}"] if plain else commented(rng, key, value, delimiter)
    if not plain and rng.random() < 0.3:
        lines.insert(rng.randint(0, len(lines)), rng.choice(["", "# from a data sheet, page 12", "#"]))
    before = first_headers(rng, table, bulk=bulk) if not plain else _plain_headers(table, bulk=bulk)
    header = header_rows(rng, before, columns) if not plain else [[*before, *(column.header for column in columns)]]

    def line(texts: Sequence[str]) -> str:
        cells = [_cell(text, delimiter, always=always) for text in texts] + [""] * padding
        return delimiter.join(space + cell if space and not cell.startswith('"') else cell for cell in cells)

    start = len(lines)
    lines += map(line, header)
    if not plain and len(header) == 1 and rng.random() < 0.1:  # as numpy writes it
        lines[start] = f"# {lines[start]}"
    for arm in table.arms:
        for row in arm.rows:
            texts = [_with_comma(row[column.field].bare, comma=comma and column.field in NUMBERS) for column in columns]
            lines.append(line(([arm.known.name] if bulk else []) + list(arm.said.values()) + texts))
            if not plain and rng.random() < 0.05:
                lines.append(rng.choice(["", "# a note", delimiter * len(header[0]), " "]))
    if delimiter != "," and rng.random() < 0.2:
        lines.insert(0, f"sep={delimiter}")
    end = "\n" if plain else rng.choice(["\n", "\n", "\r\n", "\r"])
    encoding = "utf-8" if plain else rng.choice(["utf-8", "utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be"])
    bom = {"utf-16-le": codecs.BOM_UTF16_LE, "utf-16-be": codecs.BOM_UTF16_BE}.get(encoding, b"")
    text = end.join(lines) + rng.choice(["", end])
    dialect = f"csv {delimiter!r} {len(header)} {comma} {always} {bool(padding)} {bool(space)} {end!r} {encoding}"
    return File(".csv" if delimiter != "\t" else ".tsv", bom + text.encode(encoding), dialect)


def _plain_headers(table: Table, *, bulk: bool) -> list[str]:
    return (["robot"] if bulk else []) + (["convention"] if table.convention_column else [])


def _cell(text: str, delimiter: str, *, always: bool) -> str:
    if always or delimiter in text or '"' in text or text.startswith("#"):
        return '"' + text.replace('"', '""') + '"'
    return text


def _with_comma(text: str, *, comma: bool) -> str:
    return re.sub(r"(?<=[0-9])\.(?=[0-9])", ",", re.sub(r"(?<![0-9.])(?=\.[0-9])", "0", text)) if comma else text


# --- Workbooks --------------------------------------------------------------------------------------------------------


def as_xlsx(rng: random.Random, table: Table, *, bulk: bool) -> File:
    """A workbook, whose tables stand anywhere on their sheets, with numbers as numbers or as texts."""
    import io

    from openpyxl import Workbook

    book = Workbook()
    writer = _SheetWriter(rng, table, numbers=rng.random() < 0.7 and not table.in_texts)
    by_sheet = bulk and len(table.arms) < 8 and rng.random() < 0.3
    if by_sheet:
        book.remove(book.active)
        for number, arm in enumerate(table.arms):
            writer.write(book.create_sheet(f"arm {number}"), [arm], bulk=False)
    else:
        writer.write(book.active, table.arms, bulk=bulk)
    file = io.BytesIO()
    book.save(file)
    return File(".xlsx", file.getvalue(), f"xlsx {by_sheet} {writer.dialect}")


class _SheetWriter:
    """Writes arms of a table to a sheet."""

    def __init__(self, rng: random.Random, table: Table, *, numbers: bool) -> None:
        self.rng = rng
        self.table = table
        self.numbers = numbers
        self.merged, self.formats, self.note = (rng.random() < 0.2 for _ in range(3))
        self.beside, self.two = rng.random() < 0.5, 1

    @property
    def dialect(self) -> str:
        """What describes the sheets in figures."""
        return f"{self.numbers} {self.beside} {self.two} {self.merged} {self.formats} {self.note}"

    def write(self, sheet: Any, arms: Sequence[Arm], *, bulk: bool) -> None:
        """Writes a table anywhere, with what is above it, and a note below it."""
        row, left = self.rng.randint(1, 4), self.rng.randint(1, 3)
        table = replace(self.table, arms=list(arms))
        for key, value in statements(table, bulk=bulk).items():
            for line in as_cells(self.rng, key, value, beside=self.beside):
                self._line(sheet, row, left, line)
                row += 1
        header = header_rows(self.rng, first_headers(self.rng, table, bulk=bulk), table.columns)
        self.two = len(header)
        for line in header:
            self._line(sheet, row, left, line)
            row += 1
        if len(header) > 1 and "Limits" in "".join(header[0]):
            first = left + next(k for k, text in enumerate(header[0]) if text.startswith("Limits"))
            sheet.merge_cells(start_row=row - 2, end_row=row - 2, start_column=first, end_column=first + 1)
        end = self._rows(sheet, row, left, arms, bulk=bulk)
        if self.note:
            sheet.cell(end + 1, left, "measured by the maker")

    def _line(self, sheet: Any, row: int, left: int, texts: Sequence[str]) -> None:
        for column, text in enumerate(texts, start=left):
            if text:
                sheet.cell(row, column, text)

    def _rows(self, sheet: Any, row: int, left: int, arms: Sequence[Arm], *, bulk: bool) -> int:
        """The rows of the arms; returns the number of the row below them."""
        names: list[tuple[int, str]] = []
        for arm in arms:
            for cells in arm.rows:
                before = ([arm.known.name] if bulk else []) + list(arm.said.values())
                self._line(sheet, row, left, before)
                for column, (field, text) in enumerate(self._texts(cells), start=left + len(before)):
                    if text:
                        self._cell(sheet.cell(row, column), field, text)
                names.append((row, arm.known.name))
                row += 1
        if bulk and self.merged:
            for name in dict.fromkeys(name for _, name in names):
                rows = [number for number, other in names if other == name]
                if len(rows) > 1:
                    sheet.merge_cells(start_row=rows[0], end_row=rows[-1], start_column=left, end_column=left)
        return row

    def _texts(self, cells: dict[str, Text]) -> Iterator[tuple[str, str]]:
        for column in self.table.columns:
            yield column.field, cells[column.field].bare

    def _cell(self, cell: Any, field: str, text: str) -> None:
        """A number as a number, with its unit in the format of the cell, or a text."""
        number, _, unit = text.partition(" ")
        in_format = self.formats and re.fullmatch("[a-z]{1,3}", unit)
        is_number = field not in WORDS and self.numbers and bool(NUMBER.fullmatch(number if in_format else text))
        # openpyxl writes 16 digits.
        is_number = is_number and float(f"{float(number):.16g}") == float(number)
        cell.value = float(number) if is_number else text
        if is_number and in_format:
            cell.number_format = f'0.00" {unit}"'
