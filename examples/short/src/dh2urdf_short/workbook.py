"""The reader `workbook`: every sheet of an Excel workbook is a DH table, whose arm has the sheet's name."""

from __future__ import annotations

from typing import TYPE_CHECKING
from zipfile import BadZipFile

from dh2urdf.errors import TableError
from dh2urdf.source import Mark, Problem
from dh2urdf.stages import Reader
from dh2urdf_plugins.readers.table import CellRow, TableOptions, read_table

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path
    from typing import Any

    from dh2urdf.manipulator import Manipulator
    from dh2urdf.stages import Rejected


def read(path: Path, options: TableOptions) -> Iterator[Manipulator | Rejected]:
    """The arms of a workbook.

    Raises:
        TableError: the file is no workbook.
    """
    from openpyxl import load_workbook  # type: ignore[import-untyped]
    from openpyxl.utils.exceptions import InvalidFileException  # type: ignore[import-untyped]

    try:
        book = load_workbook(path, data_only=True)
    except (OSError, BadZipFile, KeyError, ValueError, InvalidFileException) as error:
        problem = Problem(message=f"the file is no Excel workbook: {error}", mark=Mark(file=str(path)))
        raise TableError(problem) from error
    for sheet in book.worksheets:
        yield from read_table(_rows(sheet, str(path)), str(path), options, name=sheet.title)


def _rows(sheet: Any, file: str) -> Iterator[CellRow]:
    for number, cells in enumerate(sheet.iter_rows(), start=1):
        marks = [Mark(file=file, line=number, place=f"{sheet.title}!{cell.coordinate}") for cell in cells]
        yield CellRow([cell.value for cell in cells], marks[0], marks)


READER = Reader(
    name="workbook", summary="sheets of an Excel workbook", read=read, options=TableOptions, suffixes=(".xlsm",)
)
