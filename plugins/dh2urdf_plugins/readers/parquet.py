"""The stage ``parquet``: tables in the columns of Parquet files. What reads them is imported when it is called."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.stages import Reader, ReadsInColumns, Traces
from dh2urdf_plugins.readers.options import TableOptions

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from dh2urdf.columns import ManipulatorGroups
    from dh2urdf.manipulator import Manipulator
    from dh2urdf.stages import Rejected
    from dh2urdf.table_text import Trace


def read(path: Path, options: TableOptions, trace: Trace | None = None) -> Iterator[Manipulator | Rejected]:
    """The manipulators of a Parquet file.

    Args:
        path: the file.
        options: what the table does not say itself.
        trace: takes what the cells of each manipulator say, where it is wanted.

    Returns:
        Each manipulator, or what is wrong with it.

    Raises:
        TableError: the file is no Parquet file, is broken, or its columns or metadata are wrong.
        MissingDependencyError: pyarrow is not installed.
    """
    from dh2urdf_plugins.readers.parquet_file.reading import read_parquet

    return read_parquet(path, options, trace)


def read_columns(path: Path, options: TableOptions) -> Iterator[Manipulator | ManipulatorGroups | Rejected]:
    """The same as `read`, most of them in columns.

    Raises:
        TableError: as of `read`.
        MissingDependencyError: as of `read`.
    """
    from dh2urdf_plugins.readers.parquet_file.reading import read_parquet_columns

    return read_parquet_columns(path, options)


READER: Reader[TableOptions] = Reader(
    name="parquet",
    summary="tables with one row per joint in the columns of a Parquet file; many manipulators in a file",
    read=read,
    options=TableOptions,
    suffixes=(".parquet",),
    capabilities=(
        Traces(read),
        ReadsInColumns(read_columns),
    ),
)
