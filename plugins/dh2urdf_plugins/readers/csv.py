"""Reads Denavit-Hartenberg tables as CSV, one manipulator or a million in a file."""

from __future__ import annotations

from operator import itemgetter
from typing import TYPE_CHECKING

from dh2urdf.source import Mark, Problem
from dh2urdf.stages import Reader, Rejected
from dh2urdf_plugins.readers import csv_texts
from dh2urdf_plugins.readers.csv_comments import prose_notices
from dh2urdf_plugins.readers.csv_header import DELIMITERS, read_top
from dh2urdf_plugins.readers.csv_lines import CsvLines
from dh2urdf_plugins.readers.row_table import RowTable
from dh2urdf_plugins.readers.statements import TableOptions

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from dh2urdf.manipulator import Manipulator
    from dh2urdf_plugins.readers.headers import Columns
    from dh2urdf_plugins.readers.row_table import Row


def read(path: Path, options: TableOptions) -> Iterator[Manipulator | Rejected]:
    """The manipulators of a CSV file.

    Args:
        path: the file.
        options: what the table does not say itself.

    Yields:
        Each manipulator, or what is wrong with it.

    Raises:
        TableError: the file is no table at all, or its header or its quotes are wrong.
    """
    lines = CsvLines(path)
    top = read_top(lines, str(path))
    table = RowTable(path, options, top.columns, top.statements, _CsvRows(lines, top.columns))
    if convention := table.statements.convention:
        table.notices += prose_notices(top.comments, convention[0])
    yield from table.manipulators()


READER: Reader[TableOptions] = Reader(
    name="csv",
    summary="tables with one row per joint, cells separated by commas, semicolons or tabs; many manipulators in a file",
    read=read,
    options=TableOptions,
    suffixes=(".csv", ".tsv"),
    write=csv_texts.write,
    texts=csv_texts.texts,
)


class _CsvRows:
    """The rows below the header.

    Attributes:
        notices: of comment lines that look like rows.
    """

    def __init__(self, lines: CsvLines, columns: Columns) -> None:
        self.lines = lines
        self.headers = columns.headers
        self.delimiter = columns.delimiter or ","
        self.needed = max(index for index, header in enumerate(columns.headers) if header) + 1
        lines.row_form = self.delimiter, len(columns.headers)
        self.notices = lines.notices

    def batches(self) -> Iterator[tuple[Sequence[int], Sequence[Row]]]:
        """The rows that hold anything, and the line at which each starts."""
        width = len(self.headers)
        for lines, batch in self.lines.records(self.delimiter):
            if set(map(len, batch)) == {width} and all(map(itemgetter(0), batch)):
                yield lines, batch
            else:
                pairs = [(line, cells) for line, cells in zip(lines, batch, strict=True) if any(map(str.strip, cells))]
                yield [line for line, _ in pairs], [cells for _, cells in pairs]

    def mark(self, line: int) -> Mark:
        """The line of a row."""
        return Mark(file=self.lines.file, line=line)

    def marks(self, line: int, texts: Sequence[str]) -> list[Mark]:
        """Where the cells of a row start."""
        starts = self.lines.starts(line, texts, self.delimiter)
        return [Mark(file=self.lines.file, line=line, column=start) for start in starts]

    def row_problem(self, line: int, texts: Sequence[str], number: int) -> Problem | None:
        """What is wrong with a row that has more or fewer cells than the header has columns."""
        headers = self.headers
        if len(texts) >= self.needed and not any(map(str.strip, texts[len(headers) :])):
            return None
        comma = self.delimiter == "," and len(texts) > len(headers)
        return Problem(
            message=f"row {number} has {len(texts)} cells, and the header has {len(headers)} columns",
            mark=self.mark(line),
            joint=f"joint_{number}",
            accepted=f"one cell for each column, with a {DELIMITERS[self.delimiter]} between them",
            suggestion="is there a decimal comma in it, or a comma in a text without quotes?" if comma else None,
        )
