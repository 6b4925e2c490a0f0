"""The cells of the rows of one manipulator: by field, without typesetting, and what is wrong with them as cells."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from dh2urdf.quantities import DEGREE_SIGNS, plain_text, unwrapped
from dh2urdf.source import Mark, Messages, Problem, shown
from dh2urdf_plugins.readers.header.columns import refusal, refused, stray_number
from dh2urdf_plugins.readers.header.header_rows import is_beside, is_number
from dh2urdf_plugins.readers.words.bounds import MAX_TEXT
from dh2urdf_plugins.readers.words.cells import SPACES, Cell, text_of
from dh2urdf_plugins.readers.words.comment_lines import SPREADSHEET_ERROR
from dh2urdf_plugins.readers.words.fields import FIELDS, GROUPS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf_plugins.readers.header.columns import Columns
    from dh2urdf_plugins.readers.rows.rows import RowReader
    from dh2urdf_plugins.readers.words.cells import Value

LABEL = ":"
"""What the key of a cell in a column that no field knows begins with; the header is behind it."""
_DECIMAL_COMMA = (
    rf"[-+−]?[0-9]*,[0-9]+(?:[eE][-+]?[0-9]+)?\s*(?:[^\W\d_]{{1,3}}|[{DEGREE_SIGNS}])?(?:[/·][^\W\d_]{{1,3}})?"
)
_COMMA = r"[0-9],[0-9]|(?<![0-9]),[0-9]"
_GROUPED = r"[-+−–]?[1-9][0-9]{0,2}(?:,[0-9]{3})+(?![0-9])"
"""A number whose commas may separate thousands."""
_GROUPED_BY_POINTS = r"(?<![0-9.,])[1-9][0-9]{0,2}(?:\.[0-9]{3})+(?![0-9])"
"""A number whose points may separate thousands."""
say = Messages(__file__)


class CellReader:
    """Tells the cells of one manipulator's rows apart; what reads the rows takes the problems."""

    def __init__(self, columns: Columns, reader: RowReader) -> None:
        self.columns, self.reader = columns, reader
        headers = columns.headers
        self.strays = {k for k, header in enumerate(headers) if not header and not is_beside(k, headers)}
        self.left_out = set[int]()
        self.refused: dict[int, Problem] = {}  # the first cell of each column that is refused
        self.first_counts: dict[int, int | None] = {}  # where a column without a header begins to count
        self.comma: Cell | None = None
        self.point: Cell | None = None  # a number whose point may separate thousands
        self.is_sure = False  # whether a comma cannot separate thousands

    def read(self, row: Sequence[Value], marks: Sequence[Mark], number: int) -> dict[str, Cell] | None:
        """The cells of a row by field, or None where they cannot be told apart."""
        columns, cells = self.columns, dict[str, Cell]()
        for index, (name, value) in enumerate(zip(columns.fields, row, strict=False)):
            if index in columns.ignored:
                continue
            is_name, text = name in ("joint", "link"), text_of(value)
            as_written = is_name and columns.as_written
            cell = Cell(text if as_written else text.strip(SPACES), marks[index], index in columns.of_theta)
            if name is None:
                self._unknown(cell, index, number, cells)
                continue
            if len(cell.text) > MAX_TEXT or "\n" in cell.text:
                code = "cell-too-long" if len(cell.text) > MAX_TEXT else "cell-of-lines"
                start = shown(cell.text.partition("\n")[0])
                self._note(code, cell, name, number, count=len(cell.text), most=MAX_TEXT, start=start)
                return None
            if name == "type" and (kind := columns.types.get(cell.text.casefold())):
                cell = cell._replace(text=kind.value, typed=cell.text)
            if is_name and "#" in cell.text and re.match(SPREADSHEET_ERROR, cell.text):
                self._note("spreadsheet-error", cell, name, number)
            parts = dict.fromkeys(FIELDS[name].columns, cell)
            if name in GROUPS and cell.text:
                from dh2urdf_plugins.readers.rows.groups import split_cell

                comma = columns.decimal_comma
                texts = split_cell(FIELDS[name], cell.text, cell.mark, joint=f"joint_{number}", decimal_comma=comma)
                if isinstance(texts, Problem):
                    self.reader.add(texts)
                    continue
                parts = {part: cell._replace(text=text) for part, text in texts.items()}
            cells |= parts if as_written else {part: self._plain(each, part, value) for part, each in parts.items()}
        return cells

    def _note(self, code: str, cell: Cell, name: str, number: int, **values: Any) -> None:  # noqa: ANN401
        about = {"joint": f"joint_{number}", "field": name, "found": cell.text[:MAX_TEXT]}
        self.reader.add(say(code, cell.mark, **about, **values))

    def _plain(self, cell: Cell, name: str, value: Value) -> Cell:
        """A cell without typesetting, without the name that it defines, and with a point where its comma was one."""
        text, field = cell.text, FIELDS[name]
        if text.isascii() and text.isalnum() and not text.lower().startswith("var"):
            return cell
        if field.dimension is None:
            text = unwrapped(text) if name in ("joint", "link", "robot") else plain_text(text)
        else:
            comma, symbols = self.columns.decimal_comma, self.reader.units.symbols
            text, problem = symbols.take_cell(plain_text(text), cell.mark, decimal_comma=comma)
            if problem:
                self.reader.add(problem)
            if isinstance(value, str):
                text = self._with_point(cell._replace(text=text))
        return cell if text == cell.text else cell._replace(text=text, typed=cell.text)

    # --- Decimal signs ------------------------------------------------------------------------------------------------

    def _with_point(self, cell: Cell) -> str:
        """The text of a number, whose decimal sign is remembered where it may be a comma.

        Between commas a number with a decimal comma is in quotes: so a German spreadsheet writes it.
        """
        text, columns = cell.text, self.columns
        in_quotes = columns.quoted_commas and "," in text and re.fullmatch(_DECIMAL_COMMA, text) is not None
        if columns.decimal_comma or in_quotes or (columns.quoted_commas and "." in text):
            if "," in text and re.search(_COMMA, text):
                self.is_sure |= not re.search(_GROUPED, text)
                self.comma = self.comma or cell
            if "." in text and re.search(_GROUPED_BY_POINTS, text):
                self.point = self.point or cell
        return text.replace(",", ".") if in_quotes else text

    # --- Columns that no field knows ----------------------------------------------------------------------------------

    def _unknown(self, cell: Cell, index: int, number: int, cells: dict[str, Cell]) -> None:
        """Notes that a column that names no field holds something, and refuses values in it."""
        if not cell.text:
            return
        header, problem = self.columns.headers[index], None
        # A number without a header may count the rows: from 0 or 1, or through all manipulators of the table.
        is_count = cell.text.isascii() and cell.text.isdigit() and len(cell.text) <= MAX_TEXT
        before = int(cell.text) - number if is_count else None
        follows = is_count and before == self.first_counts.setdefault(index, before)
        counts = follows and (before in (-1, 0) or (index in self.strays and "robot" in self.columns.fields))
        if not ("type" in self.columns.fields or cell.text.isdigit()):
            cells[f"{LABEL}{header}"] = cell  # which may be its type
        if header and len(cell.text) <= MAX_TEXT and (refusal(header).any_text or not counts):
            problem = refused(cell, header, number)
        elif index in self.strays and is_number(cell.text) and not counts:
            problem = stray_number(cell.text, cell.mark, number)
        if problem:
            self.refused.setdefault(index, problem)
        if index in self.columns.silent and not counts:
            self.left_out.add(index)

    # --- All rows -----------------------------------------------------------------------------------------------------

    def finish(self) -> None:
        """Reports what is wrong with columns and numbers of all rows, and once which columns are left out."""
        self.reader.add(*self.refused.values())
        # `1,250` alone is 1.25 in one country and 1250 in another; beside `0,3` it is 1.25. Beside decimal commas
        # `1.250` is refused for the same reason, and `304.8` is read. Other arms of the file do not matter.
        unclear = self.point if self.is_sure else self.comma
        if self.comma and unclear:
            self.reader.add(say("thousands-perhaps", unclear.mark, found=unclear.text))
        columns, left_out = self.columns, sorted(self.left_out - self.refused.keys())
        found = [index for index in left_out if columns.headers[index] != self.reader.types_from]
        if found:
            first, headers = found[0], columns.headers
            names = [shown(headers[k]) if headers[k] else f"{k + 1} (without a header)" for k in found]
            self.reader.add(say("columns-left-out", columns.marks[first], found=headers[first], names=names))
        columns.silent.difference_update(found)
