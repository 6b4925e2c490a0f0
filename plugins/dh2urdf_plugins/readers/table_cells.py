"""The cells of rows by field, and what can be wrong with a row before any of them is read."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from dh2urdf.manipulator import JointType
from dh2urdf.quantities import Dimension, Quantity, QuantityError, evaluate, is_unit
from dh2urdf.source import Mark, Problem, shown
from dh2urdf_plugins.readers.cells import SPACES, Cell
from dh2urdf_plugins.readers.csv_comments import SPREADSHEET_ERROR
from dh2urdf_plugins.readers.fields import FIELDS, REQUIRED, joint_type

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf_plugins.readers.headers import Columns
    from dh2urdf_plugins.readers.rows import RowReader

_GROUPED = re.compile(r"[+-]?[1-9][0-9]{0,2}[.,][0-9]{3}")
_WITH_COMMA = re.compile(r"[+-]?[0-9]*,[0-9]+")
_WITH_POINT = re.compile(r"[+-]?[0-9]*\.[0-9]+")
_LONGEST_INDEX = 9


class TableCells:
    """Tells the cells of rows apart, and notes what is wrong with them as cells."""

    def __init__(self, columns: Columns) -> None:
        """Takes the columns of the table."""
        self.columns = columns
        self.has_type = "type" in columns.fields
        self._comma: Cell | None = None
        self._point: Cell | None = None
        self._grouped: tuple[Cell, int] | None = None

    @property
    def has_decimal_commas(self) -> bool:
        """Whether a number with a decimal comma has been seen."""
        return self._comma is not None

    def read(
        self, texts: Sequence[str], marks: Sequence[Mark], mark: Mark, number: int, reader: RowReader
    ) -> dict[str, Cell] | None:
        """The cells of a row by field, or None where they cannot be told apart.

        Args:
            texts: the cells as they stand in the file.
            marks: the place of each.
            mark: the place of the row.
            number: the number of the row within its manipulator.
            reader: what takes the problems.
        """
        columns, joint = self.columns, f"joint_{number}"
        if number == 1 and self._are_units(texts):
            reader.add(self._row_of_units(texts, mark))
            return None
        if [text.strip(SPACES) for text in texts[: len(columns.headers)]] == columns.headers:
            reader.add(self._header_again(mark, number))
            return None
        cells = {}
        for index, (name, text) in enumerate(zip(columns.fields, texts, strict=False)):
            if name is None and index not in columns.unheld:
                self._look_for_types(text, index, mark, number, reader)
                continue
            cell = Cell(text.strip(SPACES), marks[index])
            if "\n" in cell.text:
                reader.add(_several_lines(cell, name, joint))
                return None
            if name is None:
                self._unheld(cell, index, joint, reader)
                continue
            if name in ("joint", "link") and SPREADSHEET_ERROR.match(cell.text):
                reader.add(_spreadsheet_error(cell, name, joint))
            cells[name] = cell
            if columns.decimal_comma and FIELDS[name].dimension is not None:
                self._look_for_commas(cell, number)
        return cells

    def _are_units(self, texts: Sequence[str]) -> bool:
        """Whether what stands in the columns of geometry are units, and nothing else."""
        words = [
            text.strip(f"{SPACES}[]()")
            for name, text in zip(self.columns.fields, texts, strict=False)
            if name in REQUIRED
        ]
        return all(map(is_unit, words))

    def _row_of_units(self, texts: Sequence[str], mark: Mark) -> Problem:
        index = self.columns.fields.index("a")
        header, unit = self.columns.headers[index], texts[index].strip(f"{SPACES}[]()")
        return Problem(
            message="row 1 holds units, not a joint",
            mark=mark,
            joint="joint_1",
            field="a",
            found=texts[index].strip(SPACES),
            accepted=f"units in the headers, such as `{header} [{unit}]`",
        )

    def _header_again(self, mark: Mark, number: int) -> Problem:
        line = self.columns.mark.line
        return Problem(
            message=f"row {number} is the header{f' of line {line}' if line else ''} again",
            mark=mark,
            joint=f"joint_{number}",
            accepted="one header; tables of several manipulators have a column robot",
        )

    def _look_for_types(self, text: str, index: int, mark: Mark, number: int, reader: RowReader) -> None:
        """Refuses a column that no field knows where it plainly holds types, since joints without are revolute."""
        word = text.strip(SPACES)
        if self.has_type or not word.isalpha():
            return
        kind = joint_type(word)
        if kind is None or kind is JointType.REVOLUTE:
            return
        header = self.columns.headers[index]
        reader.add(
            Problem(
                message=f"{shown(word)} seems to be a type, and no field is called {shown(header)}: the joint would be "
                "taken as revolute",
                mark=mark,
                joint=f"joint_{number}",
                field="type",
                found=word,
                accepted=f"one of the headers {', '.join(FIELDS['type'].headers)}",
            )
        )

    def _unheld(self, cell: Cell, index: int, joint: str, reader: RowReader) -> None:
        """Refuses geometry that no field holds, where there is any."""
        if _is_zero(cell.text):
            return
        header = self.columns.headers[index]
        reader.add(
            Problem(
                message=f"{shown(header)} is {self.columns.unheld[index]}, which no column holds, and it is "
                f"{shown(cell.text)}",
                mark=cell.mark,
                joint=joint,
                field=header,
                found=cell.text,
                accepted="0 in this column, or a table of a, alpha, d and theta (or offset) without it",
            )
        )

    def _look_for_commas(self, cell: Cell, number: int) -> None:
        """Remembers the first of each form in which a number may have a decimal sign, or a sign between thousands."""
        text = cell.text
        if self._comma is None and _WITH_COMMA.fullmatch(text):
            self._comma = cell
        if self._point is None and _WITH_POINT.fullmatch(text):
            self._point = cell
        if self._grouped is None and _GROUPED.fullmatch(text):
            self._grouped = (cell, number)

    def ambiguous_number(self) -> Problem | None:
        """What is wrong with a manipulator's numbers where one may have a sign between thousands; forgets them."""
        grouped, self._grouped = self._grouped, None
        if grouped is None:
            return None
        cell, number = grouped
        word, other, decimal = ("point", self._comma, "comma") if "." in cell.text else ("comma", self._point, "point")
        if other is None:
            return None
        return Problem(
            message=f"{shown(cell.text)} can be read in two ways, since {shown(other.text)} in line "
            f"{other.mark.line} has a decimal {decimal}: the {word} may separate thousands",
            mark=cell.mark,
            joint=f"joint_{number}",
            found=cell.text,
            accepted="decimal commas alone, or decimal points alone, without separators of thousands",
        )


def check_index(index: Cell, number: int, reader: RowReader) -> None:
    """Refuses the index of a row that is not the row's number."""
    if index.text.isdecimal() and len(index.text) <= _LONGEST_INDEX and int(index.text) == number:
        return
    reader.add(
        Problem(
            message=f"the index is {shown(index.text)}, and this is row {number}",
            mark=index.mark,
            joint=f"joint_{number}",
            field="index",
            found=index.text,
            accepted="1, 2, 3 … in the order of the rows, from the base outwards",
        )
    )


def _spreadsheet_error(cell: Cell, name: str, joint: str) -> Problem:
    return Problem(
        message=f"{shown(cell.text)} is what a spreadsheet writes for an error, not the name of a {name}",
        mark=cell.mark,
        joint=joint,
        field=name,
        found=cell.text,
        accepted="a name",
        suggestion="mend the formula in the spreadsheet, and save the table again",
    )


def _several_lines(cell: Cell, name: str | None, joint: str) -> Problem:
    return Problem(
        message=f"the cell that begins with {shown(cell.text.split(chr(10))[0])} runs over several lines",
        mark=cell.mark,
        joint=joint,
        field=name,
        found=cell.text,
        accepted="a cell on one line",
        suggestion="is its closing quote missing?",
    )


def _is_zero(text: str) -> bool:
    try:
        return not text or evaluate(text.replace(",", "."), Dimension.NUMBER) == Quantity(0.0)
    except QuantityError:
        return False
