"""What a table of rows is read from: a file of rows, as each format gives them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from dh2urdf.columns import PlaceInFile
    from dh2urdf.source import Mark, Problem
    from dh2urdf.table_text import CellRow
    from dh2urdf_plugins.readers.header.columns import Columns
    from dh2urdf_plugins.readers.words.cells import Value
    from dh2urdf_plugins.readers.words.comment_lines import Comment

Row: TypeAlias = "Sequence[Value]"
"""The cells of a row, one for each column."""


class RowSource(Protocol):
    """A file of rows, as its format gives them: those down to the header one by one, and the others by the hundred.

    The key of a row is what the format knows its place by: the number of a line, or more.

    Attributes:
        below: comments and notes below the header, which may define names for lengths.
    """

    below: list[Comment]

    def __iter__(self) -> Iterator[CellRow]:
        """The rows down to the header."""

    def start(self, columns: Columns) -> Columns:
        """Takes the columns that the header names, and gives them with those that hold numbers known."""

    def batches(self) -> Iterator[tuple[Sequence[Any], Sequence[Row]]]:
        """Some hundred rows below the header at a time, and the key of each."""

    def complete(self, header: CellRow) -> CellRow:
        """The header with what the row below it adds: units, or names of columns that share a title."""

    def places(self, keys: Iterable[Any]) -> Iterable[PlaceInFile]:
        """The places of rows in the file."""

    def mark(self, key: Any) -> Mark:  # noqa: ANN401 - a key of its own
        """The place of a row, with the file."""

    def row(self, key: Any, cells: Row, number: int) -> tuple[CellRow, Iterable[Problem]]:  # noqa: ANN401
        """A row with the place of each cell, and why the cells are not those of the columns.

        Args:
            key: the row's key.
            cells: its cells, as they were handed on.
            number: its number within its manipulator.
        """
