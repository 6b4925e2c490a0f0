"""Rows of cells that come one by one, from whatever container."""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import chain, islice
from typing import TYPE_CHECKING

from dh2urdf.errors import SCREENFUL
from dh2urdf.source import Problem, listed, shown
from dh2urdf.table_text import REQUIRED
from dh2urdf_plugins.readers.comments.declared import comment_below
from dh2urdf_plugins.readers.comments.top import comment_text, is_header
from dh2urdf_plugins.readers.header.header_rows import completed, headers_in, is_beside, text_in
from dh2urdf_plugins.readers.header.unknown_columns import is_number, stray_number
from dh2urdf_plugins.readers.header.words import read_header
from dh2urdf_plugins.readers.words.cells import LINE_END, SPACES
from dh2urdf_plugins.readers.words.comment_lines import Comment, is_comment, sign_of
from dh2urdf_plugins.readers.words.fields import FIELDS

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from dh2urdf.columns import PlaceInFile
    from dh2urdf.source import Mark
    from dh2urdf.table_text import CellRow
    from dh2urdf_plugins.readers.header.columns import Columns
    from dh2urdf_plugins.readers.rows.source import Row
    from dh2urdf_plugins.readers.words.cells import Value

_BATCH = 200
"""Rows that are handed on at once."""
BELOW = "what is below the table, after an empty row"
NOTE_HINT = "if this is a note, put an empty row before it, or a # at its beginning"
_PROSE = (
    r"(?i)(?:(?:[*†‡§•>\\_¹²³⁰⁴-⁹][*\\_\s]*|-\s+(?=[^\W\d_]{3})|[\[(]?(?:[0-9]{1,2}|[a-z])[)\]:]\s*|[0-9]"
    r"\.\s+)[^\W\d_]{2,}|[^\W\d_]{3,})(?:[\s:;,.]|$)"
)
"""How a note begins, and no number, expression or symbol: with a word, perhaps behind the mark of a footnote."""
_FOOTMARK = r"[*†‡§•¹²³⁰⁴-⁹]+|[\[(]?[0-9a-z][)\]]"
"""The mark of a footnote in a cell of its own."""


class CellRows:
    """The rows of a container that has cells with places of their own: the key of a row is the row itself.

    Attributes:
        notices: of comments below the header that look like rows, and of notes beside and below the table.
        comments: those below the header that nobody has looked at yet.
    """

    def __init__(self, rows: Iterable[CellRow], *, decimal_comma: bool = False) -> None:
        self.rows = iter(rows)
        self.decimal_comma = decimal_comma
        self.notices: list[Problem] = []
        self.comments: list[Comment] = []
        self.fields: list[str | None] = []
        self.header: list[str] = []
        self.named: list[bool] = []
        self.geometry: list[int] = []
        self.quantities: frozenset[int] = frozenset()
        self.begun = self.ended = False
        self.below: list[tuple[str, Mark]] = []
        self.beside: list[tuple[str, Mark]] = []

    def __iter__(self) -> Iterator[CellRow]:
        """The rows one by one."""
        return self.rows

    def complete(self, header: CellRow) -> CellRow:
        """The header with a row of units, or of names under shared titles, that follows it.

        Raises:
            TableError: the row of units contradicts the header.
        """
        row = next(self.rows, None)
        if row is None:
            return header
        joined = completed(header, row)
        if joined is None:
            self.rows = chain((row,), self.rows)
        return joined or header

    def start(self, columns: Columns) -> Columns:
        """Takes the columns of the rows to come."""
        self.fields = columns.fields
        self.header = columns.headers
        self.named = [bool(header) for header in columns.headers]
        self.geometry = [index for index, field in enumerate(columns.fields) if field in REQUIRED]
        columns.decimal_comma = self.decimal_comma
        self.quantities = frozenset(
            index for index, name in enumerate(columns.fields) if name and FIELDS[name].dimension
        )
        columns.numbers = self.quantities
        return columns

    def batches(self) -> Iterator[tuple[Sequence[CellRow], Sequence[Row]]]:
        """The rows that hold anything and are no comments and no notes."""
        rows = filter(self._is_row, self.rows)
        while batch := list(islice(rows, _BATCH)):
            yield batch, [self._values(row) for row in batch]
        self.notices += unread_notes(BELOW, self.below)
        self.notices += unread_notes("what is beside the table", self.beside)

    def row_places(self, keys: Iterable[CellRow]) -> Iterator[PlaceInFile]:
        """The places of rows."""
        return ((row.mark.line, row.mark.column, row.mark.place) for row in keys)

    def row_marks(self, keys: Iterable[CellRow]) -> Iterator[Mark]:
        """The same, with the file."""
        return (row.mark for row in keys)

    def marks(self, key: CellRow, texts: Sequence[object]) -> Sequence[Mark]:
        """The place of each cell of a row."""
        marks = list(key.marks or ())
        return marks + [key.mark] * (len(texts) - len(marks))

    def row_problems(self, key: CellRow, texts: Sequence[str], number: int) -> Iterator[Problem]:
        """What the container declares about the row's cells, and of numbers behind the last column of the header."""
        joint = f"joint_{number}"
        if headers_in(key) != self.header and (problem := other_header(key, number, "on a sheet")):
            yield problem
            return
        for index, cell in enumerate(key.cells):
            field = self.fields[index] if index < len(self.fields) else None
            if isinstance(cell, Problem) and field:
                yield replace(cell, joint=joint, field=field, mark=cell.mark or self.marks(key, texts)[index])
            elif index >= len(self.fields) and self._is_stray(index, cell):
                yield stray_number(text_in(cell), self.marks(key, texts)[index], joint)

    # --- Cells --------------------------------------------------------------------------------------------------------

    def _is_stray(self, index: int, cell: object) -> bool:
        """Whether a cell is a number in a column of the table that has no header."""
        if is_beside(index, self.named) or (index < len(self.named) and self.named[index]):
            return False
        return isinstance(cell, float | int) or is_number(text_in(cell).strip(SPACES))

    def _is_note(self, index: int, cell: object) -> bool:
        """Whether a cell without a header holds what belongs to no column of the table."""
        named = index < len(self.named) and self.named[index]
        return not named and bool(text_in(cell).strip(SPACES)) and not self._is_stray(index, cell)

    def _values(self, row: CellRow) -> list[Value]:
        """The same, with numbers as numbers where quantities stand: they have no sign between thousands."""
        texts = self._texts(row)
        values: list[Value] = [*texts]
        for index, cell in enumerate(row.cells):
            if isinstance(cell, float) and index in self.quantities and texts[index]:
                values[index] = float(cell)
        return values

    def _texts(self, row: CellRow) -> list[str]:
        """The cells of a row, one for each column; a row with a problem has one that is never read as plain."""
        texts = list(map(text_in, row.cells))
        width = len(self.named)
        for index, cell in enumerate(row.cells):
            if isinstance(cell, Problem) and index < width and self.fields[index]:
                texts[index] = LINE_END + texts[index]
            elif self._is_note(index, cell):
                mark = self.marks(row, texts)[index]
                self.comments.append(Comment.note(texts[index], mark))
                if not is_comment(texts[index]):
                    self.beside.append((texts[index], mark))
                    texts[index] = ""
                elif index < width:
                    texts[index] = ""  # else it is behind the row
        while len(texts) > width and not texts[-1].strip(SPACES):
            texts.pop()
        return texts + [""] * (width - len(texts))

    def _is_row(self, row: CellRow) -> bool:
        texts = [text for text in map(text_in, row.cells) if text.strip(SPACES)]
        if not texts:
            self.ended = self.ended or self.begun
            return False
        if is_comment(texts[0]):
            self._see_comment(row, texts)
            return False
        if self.ended and is_note(row, self.geometry, len(self.named)):
            text = comment_text(row)
            self.below.append((text, row.mark))
            self.comments.append(Comment.note(text, row.mark))
            return False
        self.begun = True
        return True

    def _see_comment(self, row: CellRow, texts: Sequence[str]) -> None:
        text = comment_text(row)
        self.comments.append(comment_below(text, row.mark))
        if len(texts) > 1 and len(self.notices) < SCREENFUL:
            self.notices.append(
                Problem(
                    message=f"{shown(text)} is a comment, since it begins with {sign_of(text)}, and no row",
                    severity="notice",
                    mark=row.mark,
                    found=text,
                )
            )


def is_note(row: CellRow, geometry: Iterable[int], width: int) -> bool:
    """Whether a row after an empty one is a note below the table, and not a row, whole or cut off.

    A note is one cell of prose; or it begins with prose, has no number, and says nothing where the geometry stands. A
    text with commas in it, which a reader takes for cells, is a note without a number.

    Args:
        row: the row.
        geometry: the columns of a, alpha and d.
        width: how many columns the table has.
    """
    texts = [text_in(cell).strip(SPACES) for cell in row.cells]
    filled = [text for text in texts if text]
    filled = filled[len(filled) > 1 and re.fullmatch(_FOOTMARK, filled[0]) is not None :]
    if not re.match(_PROSE, filled[0]):
        return False
    if len(filled) == 1:
        return True
    says = len(texts) >= width and any(texts[index] for index in geometry)
    return not (says or any(map(is_number, filled[1:])) or is_header(row) or _names_fields(row))


def _names_fields(row: CellRow) -> bool:
    """Whether each cell of a row is the header of a field: ``joint, min, max``."""
    fields = [read_header(text).field for text in headers_in(row) if text]
    return len(fields) > 1 and None not in fields and len({each.name for each in fields if each}) == len(fields)


def _is_decimal(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def other_header(row: CellRow, number: int, place: str) -> Problem | None:
    """What is wrong with a row that is the header of another table; None where it is none.

    Args:
        row: the row.
        number: its number.
        place: where each table may be, by itself: `on a sheet`.
    """
    if any(text[-1:].isdecimal() and _is_decimal(text) for text in map(text_in, row.cells)):
        return None  # It is known without a look at what its words mean.
    if is_header(row):
        advice = f"put each table {place} of its own, or all rows below one header with a column robot"
    elif _names_fields(row):
        advice = "if it is of the same joints, put its columns beside those of the first table"
    else:
        return None
    return Problem(
        message=f"row {number} is the header of another table",
        mark=row.mark,
        joint=f"joint_{number}",
        accepted="one table below its header",
        suggestion=advice,
    )


def unread_notes(what: str, notes: Sequence[tuple[str, Mark]]) -> list[Problem]:
    """The one notice of notes that nothing is read from; none where there are none."""
    if not notes:
        return []
    texts = listed([shown(text) for text, _ in notes])
    return [Problem(message=f"nothing is read from {what}: {texts}", severity="notice", mark=notes[0][1])]
