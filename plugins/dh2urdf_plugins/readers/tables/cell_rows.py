"""Rows of cells that come one by one, from whatever container, without those that are no joints of the table."""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import chain, islice
from typing import TYPE_CHECKING, TypeVar

from dh2urdf.errors import TableError
from dh2urdf.quantities import Symbols
from dh2urdf.source import Mark, Messages, Problem
from dh2urdf.table_text import REQUIRED, CellRow
from dh2urdf_plugins.readers.comments.declared import comment_below
from dh2urdf_plugins.readers.comments.top import comment_text, is_header
from dh2urdf_plugins.readers.header.columns import stray_number
from dh2urdf_plugins.readers.header.header_rows import completed, headers_in, is_beside, is_number, text_in
from dh2urdf_plugins.readers.header.words import read_header
from dh2urdf_plugins.readers.words.cells import LINE_END, SPACES
from dh2urdf_plugins.readers.words.comment_lines import Comment, is_comment
from dh2urdf_plugins.readers.words.fields import FIELDS

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from pathlib import Path

    from dh2urdf_plugins.readers.header.columns import Columns, Row
    from dh2urdf_plugins.readers.words.cells import Value

    Table = TypeVar("Table")

_BATCH = 3000
"""Rows that are handed on at once."""
_LONGEST_NOTE = 200
"""Characters of a note at whose beginning it is known."""
_PROSE = (
    r"(?i)(?:(?:[*†‡§•>\\_¹²³⁰⁴-⁹][*\\_\s]*|-\s+(?=[^\W\d_]{3})|[\[(]?(?:[0-9]{1,2}|[a-z])[)\]:]\s*|[0-9]"
    r"\.\s+)[^\W\d_]{2,}|[^\W\d_]{3,})(?:[\s:;,.]|$)"
)
"""How a note begins, and no number, expression or symbol: with a word, perhaps behind the mark of a footnote."""
_SURE_NOTE = r"[*†‡§•>¹²³⁰⁴-⁹]|[^\W\d_]{3,}\s*:|(?:\S+\s+){3}"
"""How one begins that needs no empty row above it: with a mark or a key, or with several words."""
_FOOTMARK = r"[*†‡§•¹²³⁰⁴-⁹]+|[\[(]?[0-9a-z][)\]]"
"""The mark of a footnote in a cell of its own."""
say = Messages(__file__)


class CellRows:
    """The rows of a table one by one, from whatever container: those down to the header, and the joints below it.

    Records such as those of YAML have no prose, which is comments and notes among the rows.
    """

    are_values = False
    """Whether the cells are texts and numbers as they are read, one for each column where nothing is wrong."""

    def __init__(self, rows: Iterable[CellRow], *, decimal_comma: bool = False, prose: bool = True) -> None:
        self.rows = iter(rows)
        self.decimal_comma = decimal_comma
        self.prose = prose
        self.below: list[Comment] = []  # and notes below the header, which may define names for lengths
        self.fields: list[str | None] = []
        self.named: list[bool] = []
        self.joints = Joints([], 0, self.below)

    def __iter__(self) -> Iterator[CellRow]:
        """The rows down to the header, and below it."""
        return self.rows

    def complete(self, header: CellRow) -> CellRow:
        """The header with a row of units, or of names under shared titles, that follows it."""
        passed = list[CellRow]()
        while self.prose and (row := next(self.rows, None)):
            if any(map(text_in, row.cells)):
                joined = completed(header, row)
                self.rows = self.rows if joined else chain((*passed, row), self.rows)
                return joined or header
            passed.append(row)
        return header

    def start(self, columns: Columns) -> Columns:
        """Takes the columns of the rows to come, and gives them with those that hold numbers known."""
        self.fields, self.named = columns.fields, [bool(header) for header in columns.headers]
        geometry = [index for index, field in enumerate(columns.fields) if field in REQUIRED]
        self.joints = Joints(geometry, len(self.named) - self.named[::-1].index(True), self.below)
        columns.decimal_comma = self.decimal_comma
        columns.as_written = not self.prose
        columns.numbers = frozenset(k for k, name in enumerate(columns.fields) if name and FIELDS[name].dimension)
        return columns

    def batches(self) -> Iterator[tuple[Sequence[CellRow], Sequence[Row]]]:
        """Some thousand rows at a time that hold anything and are no comments and no notes, and their cells."""
        while batch := list(islice(self.rows, _BATCH)):
            is_whole = not self.prose or self._are_joints(batch)
            rows = batch if is_whole else list(chain.from_iterable(map(self._taken, batch)))
            yield rows, [row.cells for row in rows] if self.are_values else list(map(self._values, rows))  # type: ignore[misc]
        self.joints.finish()

    def _are_joints(self, rows: Sequence[CellRow]) -> bool:  # noqa: ARG002 - as of rows that are all texts
        """Whether some rows are surely joints, all of them."""
        return False

    def _taken(self, row: CellRow) -> list[CellRow]:
        """The joints that a row adds: none where it is empty, a comment, or a note below the last joint."""
        first = next((text for text in map(text_in, row.cells) if text.strip(SPACES)), "")
        if not is_comment(first):
            return self.joints.take(row)
        self.joints.after_gap = True
        self.below.append(comment_below(comment_text(row), row.mark))
        return []

    def _values(self, row: CellRow) -> Row:
        """The cells of a row, one for each column; numbers of quantities are numbers, and problems are never plain."""
        width = len(self.named)
        values: list[Value] = []
        for index, cell in enumerate(row.cells):
            field = self.fields[index] if index < width else None
            if isinstance(cell, float) and field and FIELDS[field].dimension:
                values.append(cell)
            elif isinstance(cell, Problem) and field:
                values.append(LINE_END + text_in(cell))
            elif (index < width and self.named[index]) or self._is_stray(index, cell):
                values.append(text_in(cell))
            elif index < width:
                values.append("")  # a note
        return values + [""] * (width - len(values))

    def _is_stray(self, index: int, cell: object) -> bool:
        """Whether a cell is a number in a column of the table that has no header."""
        if is_beside(index, self.named) or (index < len(self.named) and self.named[index]):
            return False
        return isinstance(cell, float | int) or is_number(text_in(cell).strip(SPACES))

    def row(self, key: CellRow, cells: Row, number: int) -> tuple[CellRow, list[Problem]]:
        """A row, of a number within its manipulator: the place of each cell, and why they are not the columns'."""
        marks, problems = [*(key.marks or ()), *[key.mark] * (len(cells) - len(key.marks or ()))], list[Problem]()
        if self.prose and (problem := other_header(key, number)):
            return key._replace(marks=marks), [problem]
        for index, cell in enumerate(key.cells):
            field = self.fields[index] if index < len(self.fields) else None
            if isinstance(cell, Problem) and field:
                problems.append(replace(cell, joint=f"joint_{number}", field=field, mark=cell.mark or marks[index]))
            elif index >= len(self.fields) and self._is_stray(index, cell):
                problems.append(stray_number(text_in(cell), marks[index], number))
        return key._replace(marks=marks), problems


# --- Rows that are no joints ------------------------------------------------------------------------------------------


class Joints:
    """Takes the joints out of rows, among which are empty ones, and notes below the last joint.

    `geometry` are the columns of a, alpha and d, `width` is the number of columns, and `below` takes the notes.
    """

    def __init__(self, geometry: list[int], width: int, below: list[Comment]) -> None:
        self.geometry, self.width, self.below = geometry, width, below
        self.held: list[CellRow] = []  # notes, as long as no joint follows
        self.after_empty = self.after_gap = False  # an empty row is above; that, or a comment

    def take(self, row: CellRow) -> list[CellRow]:
        """What a row adds to the joints: itself with notes that a joint follows after all, or nothing."""
        texts = [text_in(cell).strip(SPACES) for cell in row.cells]
        if not any(texts):
            self.after_empty = self.after_gap = True
            return []
        if self._are_note(texts) and not (is_header(row) or _names_fields(row)):
            self.held.append(row)
            return []
        joints, self.held, self.after_empty, self.after_gap = [*self.held, row], [], False, False
        return joints

    def _are_note(self, texts: Sequence[str]) -> bool:
        """Whether cells are a note, and no joint, whole or cut off: text that says nothing where the geometry stands.

        A text with commas in it, which a reader takes for cells, is a note without a number.
        """
        filled = [text for text in texts if text]
        filled = filled[len(filled) > 1 and re.fullmatch(_FOOTMARK, filled[0]) is not None :]
        start = filled[0][:_LONGEST_NOTE]
        is_prose = re.match(_PROSE, start) and (self.after_empty or re.match(_SURE_NOTE, start))
        if not is_prose and not all(map(Symbols.is_definition, filled)):
            return False
        says = len(texts) >= self.width and any(texts[index] for index in self.geometry)
        return len(filled) == 1 or not (says or any(map(is_number, filled[1:])))

    def finish(self) -> None:
        """Takes the rows that are held for notes."""
        self.below += (Comment.of(comment_text(row), row.mark) for row in self.held)


def _names_fields(row: CellRow) -> bool:
    """Whether each cell of a row is the header of a field: ``joint, min, max``."""
    fields = [read_header(text).field for text in headers_in(row) if text]
    return len(fields) > 1 and None not in fields and len({each.name for each in fields if each}) == len(fields)


def has_number(row: CellRow) -> bool:
    """Whether a cell of a row is a number, which no header has."""
    return any(isinstance(cell, float | int) or is_number(text_in(cell).strip(SPACES)) for cell in row.cells)


def other_header(row: CellRow, number: int) -> Problem | None:
    """What is wrong with a row that is the header of another table; None where it is none."""
    if has_number(row):
        return None  # it is known without a look at what its words mean
    code = "header-of-another-table" if is_header(row) else "header-of-the-same-joints" if _names_fields(row) else None
    return say(code, row.mark, joint=f"joint_{number}", number=number) if code else None


# --- Several tables in one file ---------------------------------------------------------------------------------------


def choose(tables: Sequence[Table], places: Sequence[str], number: int | None, path: Path | str) -> Table:
    """The table that a number means, from 1, or the only one; places are where each begins, as a sentence names it."""
    if number is not None and 0 < number <= len(tables):
        return tables[number - 1]
    if len(tables) == 1 and number is None:
        return tables[0]
    mark, found = Mark(file=str(path)), None if number is None else str(number)
    if not tables:
        raise TableError(say("no-table", mark, field="columns", found=found))
    count = "1 table" if len(tables) == 1 else f"{len(tables)} tables"
    listed = [f"{at} in {place}" for at, place in enumerate(places, start=1)]
    raise TableError(
        say("several-tables", mark, field="table_number", found=found, count=count, places=listed, most=len(tables))
    )


def starts_table(row: CellRow) -> bool:
    """Whether a row is a header, and so begins a table; it has no number in it."""
    return not has_number(row) and is_header(row)


def one_table(rows: Iterable[CellRow], number: int) -> Iterator[CellRow]:
    """The rows of one of several tables below each other, which are counted from 1.

    What is above the first header holds for every table, unless the lines above a table's own header say it.
    """
    top: list[CellRow] = []
    held: list[CellRow] = []  # rows without a number, which a header may follow
    seen = 0
    for row in rows:
        held.append(row)
        if starts_table(row):
            seen += 1
            if seen > number:
                return
            if seen == number:
                own = {key for each in held[:-1] if (key := _key(each))}
                yield from (each for each in top if _key(each) not in own)
        elif not seen:
            top.append(row)
        elif not has_number(row):
            continue
        yield from held if seen == number else ()
        held = []
    yield from held if seen else top


def _key(row: CellRow) -> str | None:
    """What a line above a header declares something under."""
    if not any(map(text_in, row.cells)):
        return None
    key, colon, _ = comment_text(row).partition(":")
    return key.strip("#%/ ").casefold() if colon else None
