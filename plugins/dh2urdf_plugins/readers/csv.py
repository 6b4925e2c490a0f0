"""The stage ``csv``: tables as CSV, many manipulators in a file. What reads them is imported when it is called."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.stages import Reader, ReadsCells, ReadsInColumns, Traces, WritesTables
from dh2urdf_plugins.late import Late
from dh2urdf_plugins.readers.options import TableOptions

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from pathlib import Path

    from dh2urdf.columns import ManipulatorGroups
    from dh2urdf.manipulator import Manipulator
    from dh2urdf.stages import Rejected
    from dh2urdf.table_text import CellRow, TableText, Trace, WrittenTable


def read(path: Path, options: TableOptions, trace: Trace | None = None) -> Iterator[Manipulator | Rejected]:
    """The manipulators of a CSV file.

    Args:
        path: the file.
        options: what the table does not say itself.
        trace: takes what the cells of each manipulator say, where it is wanted.

    Returns:
        Each manipulator, or what is wrong with it.

    Raises:
        TableError: the file is no table at all, or its header or its quotes are wrong.
    """
    from dh2urdf_plugins.readers.sources.files import read_file

    return read_file(path, options, trace)


def read_columns(path: Path, options: TableOptions) -> Iterator[Manipulator | ManipulatorGroups | Rejected]:
    """The same as `read`, most of them in columns.

    Raises:
        TableError: as of `read`.
    """
    from dh2urdf_plugins.readers.sources.files import read_file_columns

    return read_file_columns(path, options)


def read_cells(rows: Iterable[CellRow], file: str, options: TableOptions) -> Iterator[Manipulator | Rejected]:
    """The manipulators of rows of cells that come from no file."""
    from dh2urdf_plugins.readers.table import read_table

    return read_table(rows, file, options)


def write(tables: Sequence[TableText]) -> WrittenTable:
    """The file of some tables.

    Raises:
        InputError: the format cannot hold them.
    """
    from dh2urdf_plugins.readers.sources import csv_texts as texts

    return texts.write(tables)


def typed_texts(path: Path) -> Iterator[TableText]:
    """The tables of a file as their authors typed them."""
    from dh2urdf_plugins.readers.sources import files

    return files.typed_texts(path)


TEXTS = (".txt", ".md", ".tex", ".py", ".m")
"""Suffixes of texts that are read and not written."""

READER: Reader[TableOptions] = Reader(
    name="csv",
    summary="tables with one row per joint: CSV with many manipulators in a file, Markdown, LaTeX, columns, numbers in "
    "brackets",
    read=read,
    options=TableOptions,
    suffixes=(".csv", ".tsv", *TEXTS),
    capabilities=(
        WritesTables(write, typed_texts, not_written=(".tsv", *TEXTS)),
        Traces(read),
        ReadsCells(read_cells, any_text=".txt", cells_of=Late("dh2urdf_plugins.readers.sources.files:cells_of")),
        ReadsInColumns(read_columns),
    ),
)
