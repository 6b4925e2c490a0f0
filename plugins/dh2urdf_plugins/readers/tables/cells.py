"""The cells of rows by field, and what can be wrong with a row before any of them is read."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from dh2urdf.quantities import DEGREE_SIGNS, is_unit
from dh2urdf.source import Mark, Problem, shown
from dh2urdf.table_text import REQUIRED
from dh2urdf_plugins.readers.header.header_rows import is_beside
from dh2urdf_plugins.readers.header.unknown_columns import (
    is_number,
    left_out,
    refusal,
    refused,
    stray_number,
)
from dh2urdf_plugins.readers.header.words import read_header
from dh2urdf_plugins.readers.rows.joint_rows import LABEL
from dh2urdf_plugins.readers.words.bounds import MAX_TEXT
from dh2urdf_plugins.readers.words.cells import SPACES, Cell, text_of
from dh2urdf_plugins.readers.words.comment_lines import SPREADSHEET_ERROR
from dh2urdf_plugins.readers.words.decimal_signs import DecimalSigns
from dh2urdf_plugins.readers.words.fields import FIELDS, GROUPS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf_plugins.readers.header.columns import Columns
    from dh2urdf_plugins.readers.rows.rows import RowReader
    from dh2urdf_plugins.readers.words.cells import Value
    from dh2urdf_plugins.readers.words.fields import Refusal

_DECIMAL_COMMA = (
    rf"[-+−]?[0-9]*,[0-9]+(?:[eE][-+]?[0-9]+)?\s*(?:[^\W\d_]{{1,3}}|[{DEGREE_SIGNS}])?(?:[/·][^\W\d_]{{1,3}})?"
)


class TableCells:
    """Tells the cells of rows apart, and notes what is wrong with them as cells.

    Args:
        columns: the columns of the table.
    """

    def __init__(self, columns: Columns) -> None:
        self.columns = columns
        self.left_out = set[int]()
        self.refused: dict[int, Problem] = {}  # of the manipulator: the first cell of each column that is refused
        self.signs = DecimalSigns()
        headers = columns.headers
        self.strays = {k for k, header in enumerate(headers) if not header and not is_beside(k, headers)}
        self.reasons: dict[int, Refusal] = {}
        self.first_counts: dict[int, int] = {}  # of the manipulator: where a column without a header begins to count
        self.has_type = "type" in columns.fields

    def read(
        self, row: Sequence[Value], marks: Sequence[Mark], number: int, reader: RowReader
    ) -> dict[str, Cell] | None:
        """The cells of a row by field, or None where they cannot be told apart.

        Args:
            row: the cells as they are in the file.
            marks: the place of each.
            number: the number of the row within its manipulator.
            reader: what takes the problems.
        """
        columns, joint, cells = self.columns, f"joint_{number}", dict[str, Cell]()
        for index, (name, value) in enumerate(zip(columns.fields, row, strict=False)):
            if index in columns.ignored:
                continue
            is_name, text = name in ("joint", "link"), text_of(value)
            as_written = is_name and columns.as_written
            cell = Cell(text if as_written else text.strip(SPACES), marks[index], index in columns.of_theta, as_written)
            if name is None:
                self._unknown(cell, index, number, cells)
                continue
            if problem := _unreadable(cell, name, joint):
                reader.add(problem)
                return None
            if name == "type" and (kind := columns.types.get(cell.text.casefold())):
                cell = cell._replace(text=kind.value)
            if is_name and "#" in cell.text and re.match(SPREADSHEET_ERROR, cell.text):
                reader.add(_spreadsheet_error(cell, name, joint))
            found = self._split(cell, name, number, reader) if name in GROUPS else {name: cell}
            for part, of_part in found.items():
                is_text = FIELDS[part].dimension is not None and isinstance(value, str)
                cells[part] = self._number(of_part) if is_text else of_part
        return cells

    def problems(self, types_from: str | None) -> list[Problem]:
        """What is wrong with a manipulator's columns, once for each, and its numbers; forgets the manipulator.

        The notice of columns that are left out comes with the first manipulator that has something in them.

        Args:
            types_from: the header of a column that names no field, and was read as the types of the joints.
        """
        columns = self.columns
        found = sorted(self.left_out - self.refused.keys())
        found = [index for index in found if columns.headers[index] != types_from]
        problems = [*self.refused.values(), *filter(None, [self.signs.problem()])]
        columns.silent.difference_update(found)
        for each in (self.left_out, self.refused, self.first_counts):
            each.clear()
        if found:
            problems.append(left_out([(index, columns.headers[index]) for index in found], columns.marks[found[0]]))
        return problems

    def no_joint(self, texts: Sequence[str], mark: Mark, number: int) -> Problem | None:
        """What is wrong with a row that is no joint: it holds units, or is the header again; it does not count."""
        if number == 1 and self._are_units(texts):
            return self._row_of_units(texts, mark)
        if [text.strip(SPACES) for text in texts[: len(self.columns.headers)]] != self.columns.headers:
            return None
        place = self.columns.mark.in_file
        return Problem(
            message=f"row {number} is the header{f' of {place}' if place else ''} again",
            mark=mark,
            joint=f"joint_{number}",
            accepted="one header; tables of several manipulators have a column robot",
        )

    # --- Columns that no field knows ----------------------------------------------------------------------------------

    def _unknown(self, cell: Cell, index: int, number: int, cells: dict[str, Cell]) -> None:
        """Notes that a column that names no field holds something, and refuses values in it."""
        if not cell.text:
            return
        header, problem = self.columns.headers[index], None
        counts = is_number(cell.text) and self._counts(cell.text, index, number)
        why = self.reasons.get(index) or refusal(header, read_header(header))
        self.reasons[index] = why
        if not (self.has_type or cell.text.isdigit()):
            cells[f"{LABEL}{header}"] = cell  # which may be its type
        if not header:
            stray = index in self.strays and is_number(cell.text) and not counts
            problem = stray_number(cell.text, cell.mark, f"joint_{number}") if stray else None
        elif len(cell.text) <= MAX_TEXT and (why.any_text or not counts):
            problem = refused(cell, header, why, f"joint_{number}", number=number)
        if problem:
            self.refused.setdefault(index, problem)
        if index in self.columns.silent and not counts:
            self.left_out.add(index)

    def _counts(self, text: str, index: int, number: int) -> bool:
        """Whether a number without a header counts the rows: from 0 or 1, or through all manipulators of the table."""
        if not (text.isascii() and text.isdigit()):
            return False
        before = int(text) - number
        return before == self.first_counts.setdefault(index, before) and (
            before in (-1, 0) or (index in self.strays and "robot" in self.columns.fields)
        )

    # --- Cells that a field knows -------------------------------------------------------------------------------------

    def _number(self, cell: Cell) -> Cell:
        """A number as text, whose decimal sign is remembered where it may be a comma.

        Between commas a number with a decimal comma is in quotes: so a German spreadsheet writes it.
        """
        if self.columns.decimal_comma:
            self.signs.note(cell)
        elif self.columns.quoted_commas and "," in cell.text and re.fullmatch(_DECIMAL_COMMA, cell.text):
            self.signs.note(cell)
            return cell._replace(text=cell.text.replace(",", "."))
        elif self.columns.quoted_commas and "." in cell.text:
            self.signs.note(cell)
        return cell

    def _split(self, cell: Cell, name: str, number: int, reader: RowReader) -> dict[str, Cell]:
        """The cells of the fields that share a cell."""
        if not cell.text:
            return dict.fromkeys(GROUPS[name].parts, cell)
        from dh2urdf_plugins.readers.tables.cell_groups import ACCEPTED, split_cell

        parts = split_cell(FIELDS[name], cell.text, decimal_comma=self.columns.decimal_comma)
        if isinstance(parts, dict):
            self.signs.note_list(cell, parts.values())
            return {part: cell._replace(text=text) for part, text in parts.items()}
        reader.add(
            Problem(
                message=parts.message,
                mark=cell.mark,
                joint=f"joint_{number}",
                field=name,
                found=cell.text,
                accepted=ACCEPTED[name],
                suggestion=parts.suggestion,
            )
        )
        return {}

    def _are_units(self, texts: Sequence[str]) -> bool:
        """Whether what is in the columns of geometry are units, and nothing else."""
        words = dict(zip(self.columns.fields, texts, strict=False))
        return all(
            is_unit(words.get(name, "").strip(f"{SPACES}[]()")) for name in self.columns.fields if name in REQUIRED
        )

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


def _unreadable(cell: Cell, name: str, joint: str) -> Problem | None:
    """What is wrong with a cell that is too long, or runs over several lines."""
    if len(cell.text) <= MAX_TEXT and "\n" not in cell.text:
        return None
    if len(cell.text) > MAX_TEXT:
        message, accepted = f"the cell has {len(cell.text):,} characters", f"at most {MAX_TEXT:,} characters"
    else:
        message = f"the cell that begins with {shown(cell.text.split(chr(10))[0])} runs over several lines"
        accepted = "a cell on one line, with a quote at both ends or none"
    return Problem(
        message=message, mark=cell.mark, joint=joint, field=name, found=cell.text[:MAX_TEXT], accepted=accepted
    )


def _spreadsheet_error(cell: Cell, name: str, joint: str) -> Problem:
    return Problem(
        message=f"{shown(cell.text)} is what a spreadsheet writes for an error, not the name of a {name}",
        mark=cell.mark,
        joint=joint,
        field=name,
        found=cell.text,
        accepted="a name",
        suggestion="fix the formula in the spreadsheet, and save the table again",
    )
