"""The rows of a CSV file, as the grammar of all tables takes them."""

from __future__ import annotations

from operator import itemgetter
from typing import TYPE_CHECKING

from dh2urdf.source import Mark, Problem
from dh2urdf.table_text import REQUIRED, CellRow
from dh2urdf_plugins.readers.header.header_rows import completed, headers_in
from dh2urdf_plugins.readers.sources.csv_header import row_below, top_rows
from dh2urdf_plugins.readers.sources.csv_lines import CsvLines
from dh2urdf_plugins.readers.sources.texts import DELIMITERS
from dh2urdf_plugins.readers.tables.cell_rows import is_note, other_header
from dh2urdf_plugins.readers.words.comment_lines import Comment, joined, marks_a_comment

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from pathlib import Path

    from dh2urdf.columns import PlaceInFile
    from dh2urdf_plugins.readers.header.columns import Columns
    from dh2urdf_plugins.readers.rows.source import Row


class CsvRows:
    """The rows of a CSV file: comment lines of one cell each, the header, and what is below it.

    The key of a row is the number of its line.

    Attributes:
        delimiter: what stands between cells, once the header has been read.
    """

    def __init__(self, path: Path) -> None:
        self.lines = CsvLines(path)
        self.below = self.lines.below
        self.delimiter = ","
        self.header: list[str] = []
        self.width = self.needed = 0
        self.geometry: list[int] = []
        self.after_empty = False
        self.held: list[tuple[int, list[str]]] = []  # notes, as long as no joint follows

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
        self.needed = max(index for index, header in enumerate(columns.headers) if header) + 1
        self.lines.required = self.geometry = [columns.fields.index(name) for name in REQUIRED]
        columns.decimal_comma = self.delimiter != ","
        columns.quoted_commas = self.delimiter == ","
        return columns

    def batches(self) -> Iterator[tuple[Sequence[int], Sequence[Row]]]:
        """The rows that hold anything, and the line at which each starts."""
        for lines, batch in self.lines.records(self.delimiter):
            plain = set(map(len, batch)) == {self.width} and all(map(str.strip, map(itemgetter(0), batch)))
            if plain and not self.after_empty and not self.held and not _may_be_note(batch[-1]):
                yield lines, batch
            else:
                pairs = [pair for each in zip(lines, batch, strict=True) for pair in self._joints(*each)]
                yield [line for line, _ in pairs], [cells for _, cells in pairs]
        self.below += (Comment.of(joined(cells), Mark(file=self.lines.file, line=line)) for line, cells in self.held)

    def _joints(self, line: int, cells: list[str]) -> list[tuple[int, list[str]]]:
        """What a line adds to the rows: itself with notes that a joint follows after all, or nothing."""
        if not any(map(str.strip, cells)):
            self.after_empty = self.after_empty or line not in self.lines.passed
            return []
        row = CellRow(cells, Mark(file=self.lines.file, line=line))
        if is_note(row, self.geometry, self.needed, after_empty=self.after_empty):
            self.held.append((line, cells))
            return []
        joints, self.held, self.after_empty = [*self.held, (line, cells)], [], False
        return joints

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
        if headers_in(row) != self.header and (problem := other_header(row, number)):
            yield problem
            return
        more = next((text for text in texts[self.width :] if text.strip()), None)
        if len(texts) >= self.needed and (more is None or marks_a_comment(more)):
            return
        suggestion = "if this is a note, put an empty row before it, or a # at its beginning"
        if self.delimiter == "," and len(texts) > self.width:
            suggestion = "is there a decimal comma in it, or a comma in a text without quotes?"
        yield Problem(
            message=f"row {number} has {len(texts)} cells, and the header has {self.width} columns",
            mark=row.mark,
            joint=f"joint_{number}",
            accepted=f"one cell for each column, with a {DELIMITERS[self.delimiter]} between them",
            suggestion=suggestion,
        )


def _may_be_note(cells: Sequence[str]) -> bool:
    """Whether a line below the last joint may be a note with as many commas as a joint has."""
    return cells[0][:1].isalpha() and " " in cells[0]
