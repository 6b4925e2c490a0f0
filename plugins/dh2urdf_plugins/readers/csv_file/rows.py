"""The rows of a CSV file, as the grammar of all tables takes them."""

from __future__ import annotations

from operator import itemgetter
from typing import TYPE_CHECKING

from dh2urdf.source import Mark, Problem
from dh2urdf.table_text import REQUIRED, CellRow
from dh2urdf_plugins.readers.csv_file.header import DELIMITERS, row_below, top_rows
from dh2urdf_plugins.readers.csv_file.lines import CsvLines
from dh2urdf_plugins.readers.header.header_rows import completed, headers_in
from dh2urdf_plugins.readers.tables.cell_rows import BELOW, NOTE_HINT, is_note, other_header, unread_notes
from dh2urdf_plugins.readers.words.cells import text_of
from dh2urdf_plugins.readers.words.comment_lines import Comment, joined, marks_a_comment
from dh2urdf_plugins.readers.words.fields import joint_type

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from pathlib import Path

    from dh2urdf.columns import PlaceInFile
    from dh2urdf_plugins.readers.header.columns import Columns
    from dh2urdf_plugins.readers.rows.source import Row

_NOTES = 1000
"""Different texts in columns without a header that are looked at."""


class CsvRows:
    """The rows of a CSV file: comment lines of one cell each, the header, and what is below it.

    The key of a row is the number of its line.

    Attributes:
        notices: of comment lines that look like rows, and of notes below the table.
        comments: those below the header that nobody has looked at yet.
        delimiter: what stands between cells, once the header has been read.
    """

    def __init__(self, path: Path) -> None:
        self.lines = CsvLines(path)
        self.notices = self.lines.notices
        self.comments = self.lines.comments
        self.delimiter = ","
        self.header: list[str] = []
        self.width = self.needed = 0
        self.begun = self.ended = False
        self.below: list[tuple[str, Mark]] = []
        self.unnamed: list[int] = []
        self.noted: set[str] = set()

    def __iter__(self) -> Iterator[CellRow]:
        """The rows down to the header."""
        for row, delimiter in top_rows(self.lines, self.lines.file, self.lines.ahead):
            self.delimiter = delimiter or self.delimiter
            yield row

    def complete(self, header: CellRow) -> CellRow:
        """The header with a row of units, or of names under shared titles, that follows it.

        Raises:
            TableError: the row of units contradicts the header.
        """
        found = row_below(self.lines.ahead(), self.lines.number, self.lines.file, self.delimiter)
        joined = completed(header, found[0]) if found else None
        if found and joined:
            self.lines.skip(found[1])
        return joined or header

    def start(self, columns: Columns) -> Columns:
        """Takes the columns of the rows to come."""
        self.header = columns.headers
        self.width = len(columns.headers)
        self.unnamed = [index for index, header in enumerate(columns.headers) if not header]
        self.needed = max(index for index, header in enumerate(columns.headers) if header) + 1
        self.lines.required = [columns.fields.index(name) for name in REQUIRED]
        columns.decimal_comma = self.delimiter != ","
        columns.quoted_commas = self.delimiter == ","
        return columns

    def batches(self) -> Iterator[tuple[Sequence[int], Sequence[Row]]]:
        """The rows that hold anything, and the line at which each starts."""
        for lines, batch in self.lines.records(self.delimiter):
            for index in self.unnamed:
                self._look_for_notes(index, lines, batch)
            plain = set(map(len, batch)) == {self.width} and all(map(str.strip, map(itemgetter(0), batch)))
            if plain and not self.ended:
                self.begun = True
                yield lines, batch
            else:
                pairs = [pair for pair in zip(lines, batch, strict=True) if self._is_row(*pair)]
                yield [line for line, _ in pairs], [cells for _, cells in pairs]
        self.notices += unread_notes(BELOW, self.below)

    def _look_for_notes(self, index: int, lines: Sequence[int], batch: Sequence[Row]) -> None:
        """Takes what a column without a header holds besides numbers, each text once."""
        for line, cells in zip(lines, batch, strict=True):
            text = text_of(cells[index]).strip() if index < len(cells) else ""
            if not text or text.isdecimal() or text in self.noted or len(self.noted) == _NOTES:
                continue
            self.noted.add(text)
            if joint_type(text) is None:  # a type concerns its joint alone
                self.comments.append(Comment.note(text, Mark(file=self.lines.file, line=line)))

    def _is_row(self, line: int, cells: Sequence[str]) -> bool:
        """Whether cells are a row: they hold something, and are no note behind an empty row."""
        if not any(map(str.strip, cells)):
            self.ended = self.ended or (self.begun and line not in self.lines.passed)
            return False
        mark = Mark(file=self.lines.file, line=line)
        if self.ended and is_note(CellRow(cells, mark), self.lines.required, self.needed):
            text = joined([cell for cell in cells if cell.strip()]).strip()
            self.below.append((text, mark))
            self.comments.append(Comment.note(text, mark))
            return False
        self.comments += [Comment.note(cell, mark) for cell in cells[self.width :] if marks_a_comment(cell)]
        self.begun = True
        return True

    def row_places(self, keys: Iterable[int]) -> Iterable[PlaceInFile]:
        """The lines of rows."""
        return keys

    def row_marks(self, keys: Iterable[int]) -> Iterable[Mark]:
        """The lines of rows, with the file."""
        return (Mark(file=self.lines.file, line=key) for key in keys)

    def marks(self, key: int, texts: Sequence[str]) -> list[Mark]:
        """Where the cells of a row start."""
        starts = self.lines.starts(key, texts, self.delimiter)
        return [Mark(file=self.lines.file, line=key, column=start) for start in starts]

    def row_problems(self, key: int, texts: Sequence[str], number: int) -> Iterator[Problem]:
        """What is wrong with a row that is another header, or has other cells than the header has columns."""
        row = CellRow(texts, Mark(file=self.lines.file, line=key))
        if headers_in(row) != self.header and (problem := other_header(row, number, "in a file")):
            yield problem
            return
        more = next((text for text in texts[self.width :] if text.strip()), None)
        if len(texts) >= self.needed and (more is None or marks_a_comment(more)):
            return
        suggestion = NOTE_HINT if is_note(row, self.lines.required, self.needed) else None
        if self.delimiter == "," and len(texts) > self.width:
            suggestion = "is there a decimal comma in it, or a comma in a text without quotes?"
        yield Problem(
            message=f"row {number} has {len(texts)} cells, and the header has {self.width} columns",
            mark=row.mark,
            joint=f"joint_{number}",
            accepted=f"one cell for each column, with a {DELIMITERS[self.delimiter]} between them",
            suggestion=suggestion,
        )
