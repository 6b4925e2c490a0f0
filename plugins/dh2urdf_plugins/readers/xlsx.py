"""The stage ``xlsx``: tables in the sheets of workbooks. What reads them is imported when it is called."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.stages import Reader, Traces
from dh2urdf_plugins.readers.options import XlsxOptions

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from dh2urdf.manipulator import Manipulator
    from dh2urdf.stages import Rejected
    from dh2urdf.table_text import Trace


def read(path: Path, options: XlsxOptions, trace: Trace | None = None) -> Iterator[Manipulator | Rejected]:
    """The manipulators of a workbook: those of every sheet that holds a table and is not hidden.

    Args:
        path: the file.
        options: what the workbook does not say itself, and which sheet is read.
        trace: takes what the cells of each manipulator say, where it is wanted.

    Returns:
        Each manipulator, or what is wrong with it.

    Raises:
        TableError: the file is no workbook, holds no table, or its one table has no header that can be read.
        MissingDependencyError: openpyxl is not installed.
    """
    from dh2urdf_plugins.readers.xlsx_file.reading import read_workbook

    return read_workbook(path, options, trace)


READER: Reader[XlsxOptions] = Reader(
    name="xlsx",
    summary="tables with one row per joint in the sheets of an Excel or LibreOffice workbook",
    read=read,
    options=XlsxOptions,
    suffixes=(".xlsx", ".xlsm"),
    capabilities=(Traces(read),),
)
