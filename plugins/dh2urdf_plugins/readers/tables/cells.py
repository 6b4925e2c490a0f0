"""The cells of rows by field, and what can be wrong with a row before any of them is read."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from dh2urdf.quantities import DEGREE_SIGNS, is_unit, is_zero
from dh2urdf.source import Mark, Problem, shown
from dh2urdf.table_text import REQUIRED
from dh2urdf_plugins.readers.header.header_rows import is_beside
from dh2urdf_plugins.readers.header.unknown_columns import (
    how_to_leave_out,
    is_number,
    left_out,
    refused,
    stray_number,
    unread,
)
from dh2urdf_plugins.readers.header.words import read_header
from dh2urdf_plugins.readers.rows.joint_rows import LABEL
from dh2urdf_plugins.readers.words.bounds import MAX_TEXT, REMEMBERED
from dh2urdf_plugins.readers.words.cells import SPACES, Cell, text_of
from dh2urdf_plugins.readers.words.comment_lines import SPREADSHEET_ERROR, Comment, joined, marks_a_comment
from dh2urdf_plugins.readers.words.decimal_signs import DecimalSigns, largest
from dh2urdf_plugins.readers.words.fields import FIELDS, GROUPS

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from dh2urdf_plugins.readers.header.columns import Columns
    from dh2urdf_plugins.readers.rows.rows import RowReader
    from dh2urdf_plugins.readers.statements.statements import Statements
    from dh2urdf_plugins.readers.words.cells import Units, Value

_DECIMAL_COMMA = (
    rf"[-+−]?[0-9]*,[0-9]+(?:[eE][-+]?[0-9]+)?\s*(?:[^\W\d_]{{1,3}}|[{DEGREE_SIGNS}])?(?:[/·][^\W\d_]{{1,3}})?"
)
_DIGITS = r"[0-9]{2,}"
_STEPS = {"parent": "child", "parentlink": "childlink", "from": "to", "predecessor": "successor", "von": "nach"}
"""Headers of the link that a row begins at, and of that which it leads to, as a description has them."""


class TableCells:
    """Tells the cells of rows apart, and notes what is wrong with them as cells."""

    def __init__(self, columns: Columns, units: Units) -> None:
        """Takes the columns of the table, and its units."""
        self.columns = columns
        self.has_type = "type" in columns.fields
        self.left_out = set[int]()
        self.refused: dict[int, Problem] = {}  # of the manipulator: the first cell of each column that is refused
        self.signs = DecimalSigns(largest(columns.fields, units))
        headers = columns.headers
        self.strays = {k for k, header in enumerate(headers) if not header and not is_beside(k, headers)}
        keys = [read_header(header).key for header in headers] if None in columns.fields else []
        starts = [k for k, key in enumerate(keys) if _STEPS.get(key) in keys]
        self.steps = (starts[0], keys.index(_STEPS[keys[starts[0]]])) if starts else None
        self.reached = ""  # of the manipulator: the link that the row above leads to
        self.remarks: dict[
            str, tuple[Comment, int, str]
        ] = {}  # of the manipulator: texts of columns that no field knows
        self.first_counts: dict[int, int] = {}  # of the manipulator: where a column without a header begins to count

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
        columns, joint, texts = self.columns, f"joint_{number}", list(map(text_of, row))
        if problem := self._pass_over(texts, marks, joint):
            reader.add(problem)
            return None
        cells: dict[str, Cell] = {}
        if self.steps:
            parent, child = (Cell(texts[k].strip(SPACES), marks[k]) for k in self.steps)
            self._follow(parent, child, number)
        self._note_behind(texts, marks, number)
        for index, (name, text) in enumerate(zip(columns.fields, texts, strict=False)):
            if index in columns.ignored:
                continue
            cell = Cell(text.strip(SPACES), marks[index], index in columns.of_theta)
            if name is None and index not in columns.unheld:
                self._left_out(cell, index, number)
                cells |= self._may_be_type(cell, index)
                continue
            if "\n" in cell.text:
                reader.add(_several_lines(cell, name, joint))
                return None
            if name is None:
                self._refuse(index, refused(cell, columns.headers[index], columns.unheld[index], joint, number=number))
                continue
            if name in ("joint", "link") and "#" in cell.text and re.match(SPREADSHEET_ERROR, cell.text):
                reader.add(_spreadsheet_error(cell, name, joint))
            found = self._split(cell, name, number, reader) if name in GROUPS else {name: cell}
            for part, of_part in found.items():
                is_text = FIELDS[part].dimension is not None and isinstance(row[index], str)
                cells[part] = self._number(of_part, part, number) if is_text else of_part
        return cells

    def _note_behind(self, texts: Sequence[str], marks: Sequence[Mark], number: int) -> None:
        """Notes a comment behind the row, which may have commas."""
        columns = self.columns
        behind = (place for place in range(len(columns.fields), len(texts)) if marks_a_comment(texts[place]))
        if (place := next(behind, None)) is not None:
            comment = Comment.of(joined(texts[place:]).strip(SPACES), marks[place])
            beside = "; ".join(map("{}: {}".format, columns.fields, texts))
            words = not any(map(str.isdigit, comment.text))  # they say the same beside other numbers
            key = dict(zip(columns.fields, texts, strict=False)).get("type", "") if words else beside
            self.remarks.setdefault(f"{key}; {comment.line}", (comment, number, beside))

    def _pass_over(self, texts: list[str], marks: Sequence[Mark], joint: str) -> Problem | None:
        """Empties the long cells that no field knows, which are prose; what is wrong where a field knows one."""
        for index, name in enumerate(self.columns.fields[: len(texts)]):
            if len(texts[index]) <= MAX_TEXT:
                continue
            if name and index not in self.columns.ignored:
                return _long_cell(Cell(texts[index], marks[index]), name, joint)
            if index in self.columns.silent:
                self.left_out.add(index)
            texts[index] = ""
        return None

    def _follow(self, parent: Cell, child: Cell, number: int) -> None:
        """Notes a row that does not begin where the row above it ends: a branch, or another order."""
        reached, self.reached = self.reached, child.text
        if self.steps and number > 1 and reached != parent.text:
            parents, children = (self.columns.headers[k] for k in self.steps)
            problem = Problem(
                message=f"the row leads from {shown(parent.text)} to {shown(child.text)}, and the row above it to "
                f"{shown(reached)}: rows are a chain from the base to the tool",
                mark=parent.mark,
                joint=f"joint_{number}",
                field=parents,
                found=parent.text,
                accepted="rows in order, each from the link that the one above it leads to",
                suggestion=f"{how_to_leave_out(parents)}, and {shown(children)} likewise",
            )
            self._refuse(self.steps[0], problem)

    def no_joint(self, texts: Sequence[str], mark: Mark, number: int) -> Problem | None:
        """What is wrong with a row that is no joint: it holds units, or is the header again; it does not count."""
        if number == 1 and self._are_units(texts):
            return self._row_of_units(texts, mark)
        is_header = [text.strip(SPACES) for text in texts[: len(self.columns.headers)]] == self.columns.headers
        return self._header_again(mark, number) if is_header else None

    def _number(self, cell: Cell, name: str, number: int) -> Cell:
        """A number as text, whose decimal sign is remembered where it may be a comma.

        Between commas a number with a decimal comma is in quotes: so a German spreadsheet writes it.
        """
        if self.columns.decimal_comma:
            self.signs.note(cell, name, number)
        elif self.columns.quoted_commas and "," in cell.text and re.fullmatch(_DECIMAL_COMMA, cell.text):
            self.signs.note(cell, name, number)
            return cell._replace(text=cell.text.replace(",", "."))
        elif self.columns.quoted_commas and "." in cell.text:
            self.signs.note_point(cell)
        return cell

    def _refuse(self, index: int, problem: Problem | None) -> None:
        """Keeps what is wrong with a column that names no field: its first cell that is not 0, or its first one."""
        first = self.refused.get(index)
        if problem and (first is None or (is_zero(first.found or "") and not is_zero(problem.found or ""))):
            self.refused[index] = problem

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

    def _header_again(self, mark: Mark, number: int) -> Problem:
        place = self.columns.mark.in_file
        return Problem(
            message=f"row {number} is the header{f' of {place}' if place else ''} again",
            mark=mark,
            joint=f"joint_{number}",
            accepted="one header; tables of several manipulators have a column robot",
        )

    def _may_be_type(self, cell: Cell, index: int) -> dict[str, Cell]:
        """A cell that no field knows, where it may be a type since no column is of types."""
        named = self.has_type or not cell.text or cell.text.isdigit()
        return {} if named else {f"{LABEL}{self.columns.headers[index]}": cell}

    def _left_out(self, cell: Cell, index: int, number: int) -> None:
        """Notes that a column that names no field holds something, and refuses quantities in it."""
        if index in self.strays and is_number(cell.text) and not self._counts(cell.text, index, number):
            self._refuse(index, stray_number(cell.text, cell.mark, f"joint_{number}"))
            return
        if cell.text and index in self.columns.silent:
            self.left_out.add(index)
        problem = unread(cell, self.columns.headers[index], number)
        self._refuse(index, problem)
        if not problem and _is_remark(cell.text):
            self.remarks.setdefault(cell.text, (Comment.note(cell.text, cell.mark), number, ""))

    def _counts(self, text: str, index: int, number: int) -> bool:
        """Whether a number without a header counts the rows: from 0 or 1, or through all manipulators of the table."""
        if not (text.isascii() and text.isdigit()):
            return False
        before = int(text) - number
        return before == self.first_counts.setdefault(index, before) and (
            before in (-1, 0) or "robot" in self.columns.fields
        )

    def problems(self) -> list[Problem]:
        """What is wrong with a manipulator's columns, once for each, and its numbers; forgets the manipulator.

        The notice of columns that are left out comes with the first manipulator that has something in them.
        """
        found, columns = sorted(self.left_out), self.columns
        problems = [*self.refused.values(), *filter(None, [self.signs.problem()])]
        columns.silent.difference_update(found)
        self.left_out.clear()
        self.refused.clear()
        self.first_counts.clear()
        if found:
            problems.append(left_out([(index, columns.headers[index]) for index in found], columns.marks[found[0]]))
        return problems

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


class Remarks:
    """What cells of columns that no field knows declare about the table or their joint, as comments do, once."""

    def __init__(self, statements: Statements, columns: Columns, whole: Mark) -> None:
        """Takes what the table and the options declare, its headers, and the place of the table."""
        self.statements, self.columns, self.whole = statements, columns, whole
        self.known: set[str] = set()  # there is a notice of them
        self.quiet: set[str] = set()  # nothing, whatever their longer numbers are

    def problems(self, cells: TableCells, *, slides: bool, rejected: bool) -> list[Problem]:
        """What is wrong with the remarks of a manipulator, or worth a notice; forgets them.

        Args:
            cells: what has told its cells apart.
            slides: whether one of its joints is prismatic, so that no remark speaks of one that is not.
            rejected: whether it is rejected, with all notices.
        """
        remarks, cells.remarks = cells.remarks, {}
        new = [remark for text, remark in remarks.items() if text not in self.known]
        found = [problem for remark in new for problem in self._said_in(*remark)]
        found = [problem for problem in found if not (slides and problem.field == "type")]
        if len(self.known) < REMEMBERED and not (rejected or any(problem.severity == "error" for problem in found)):
            self.known.update(remarks)
        return found

    def say_nothing(self, texts: Iterable[str]) -> bool:
        """Whether cells say nothing that has not been reported."""
        for text in texts:
            shape = re.sub(_DIGITS, "10", text)
            if text in self.known or shape in self.quiet or not _is_remark(text):
                continue
            if self._said_in(Comment.note(text, self.whole), 1):
                return False
            if len(self.quiet) < REMEMBERED:
                self.quiet.add(shape)
        return True

    def _said_in(self, remark: Comment, number: int, beside: str = "") -> list[Problem]:
        from dh2urdf_plugins.readers.comments.judged import behind_problems, remark_problems

        if beside:
            typed = "type" in self.columns.fields
            return behind_problems(remark, beside, number, self.statements, typed=typed)
        return remark_problems(remark, number, self.statements, self.columns)


def _is_remark(text: str) -> bool:
    """Whether a cell has words, as what a column of notes holds."""
    return len(text) > 1 and text != "in" and any(map(str.isalpha, text))


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


def _long_cell(cell: Cell, name: str, joint: str) -> Problem:
    return Problem(
        message=f"the cell has {len(cell.text):,} characters",
        mark=cell.mark,
        joint=joint,
        field=name,
        found=cell.text[:MAX_TEXT],
        accepted=f"at most {MAX_TEXT:,} characters",
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
