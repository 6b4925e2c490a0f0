"""Reads Denavit-Hartenberg tables as CSV, one manipulator or a million in a file."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.stages import Reader
from dh2urdf_plugins.readers.csv_file import texts as csv_texts
from dh2urdf_plugins.readers.csv_file.rows import CsvRows
from dh2urdf_plugins.readers.table import TableOptions, read_table, read_table_columns

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from dh2urdf.columns import ManipulatorGroups
    from dh2urdf.manipulator import Manipulator
    from dh2urdf.provenance import Trace
    from dh2urdf.stages import Rejected


def read(path: Path, options: TableOptions, trace: Trace | None = None) -> Iterator[Manipulator | Rejected]:
    """The manipulators of a CSV file.

    Args:
        path: the file.
        options: what the table does not say itself.
        trace: takes what the cells of each manipulator say, where it is wanted.

    Yields:
        Each manipulator, or what is wrong with it.

    Raises:
        TableError: the file is no table at all, or its header or its quotes are wrong.
    """
    return read_table(CsvRows(path), str(path), options, name=path.stem, trace=trace)


def read_columns(path: Path, options: TableOptions) -> Iterator[Manipulator | ManipulatorGroups | Rejected]:
    """The same as `read`, most of them in columns.

    Raises:
        TableError: as of `read`.
    """
    return read_table_columns(CsvRows(path), str(path), options, name=path.stem)


READER: Reader[TableOptions] = Reader(
    name="csv",
    summary="tables with one row per joint, cells separated by commas, semicolons or tabs; many manipulators in a file",
    read=read,
    options=TableOptions,
    suffixes=(".csv", ".tsv"),
    write=csv_texts.write,
    texts=csv_texts.texts,
    trace=read,
    read_cells=read_table,
    read_columns=read_columns,
)
