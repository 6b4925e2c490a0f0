"""Tables in the sheets of workbooks of Excel and LibreOffice: which sheets are read, and what is refused unopened."""

from __future__ import annotations

import zipfile
from typing import TYPE_CHECKING, Any

from dh2urdf.documents import BROKEN_ARCHIVE, check_file, kind_of_file
from dh2urdf.errors import MissingDependencyError, TableError
from dh2urdf.source import Mark, Messages, did_you_mean, listed, shown
from dh2urdf.stages import Rejected
from dh2urdf_plugins.readers.sources.several import choose, one_table
from dh2urdf_plugins.readers.table import read_table

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from dh2urdf.manipulator import Manipulator
    from dh2urdf.source import Problem
    from dh2urdf.table_text import Trace
    from dh2urdf_plugins.readers.options import XlsxOptions
    from dh2urdf_plugins.readers.sources.sheets import SheetRows

MAX_UNPACKED = 2**29
"""Bytes of a workbook when unpacked [B]: a zip archive may hold a thousand times its own size."""
MAX_PARTS = 10_000
"""Parts of a workbook."""
_PROLOG = 2**16
_STRICT = b"http://purl.oclc.org/ooxml/"
"""What the names of a strict workbook's elements begin with (ISO/IEC 29500-1); openpyxl knows the transitional ones."""

say = Messages(__file__)


def read_workbook(path: Path, options: XlsxOptions, trace: Trace | None = None) -> Iterator[Manipulator | Rejected]:
    """The manipulators of a workbook: those of every sheet that holds a table and is not hidden."""
    try:
        import openpyxl  # noqa: F401 - what `sheets` is made of
    except ImportError as error:
        raise MissingDependencyError("reader 'xlsx'", "openpyxl", "dh2urdf[xlsx]", error) from None
    from dh2urdf_plugins.readers.sources.sheets import open_sheets

    check_workbook(path)
    book, sheets = open_sheets(path)
    try:
        tables, notices = _tables(path, sheets, options.sheet)
        found = [(table, at) for table in tables for at in range(1, len(table.headers) + 1)]
        if options.table_number is not None:
            table, number = _chosen(found, options.table_number, path)
            tables = [table]
        for table in tables:
            name = path.stem if len(tables) == 1 else table.title
            try:
                if options.table_number is None:
                    own = [each for each in found if each[0] is table]  # none: the reader of tables says what it lacks
                    number = _chosen(own, None, path)[1] if own else 1
                rows, said = one_table(table, number) if len(table.headers) > 1 else table, [*notices, *table.hidden()]
                yield from read_table(
                    rows, str(path), options, name=name, decimal_comma=True, notices=said, trace=trace
                )
            except TableError as error:
                if len(tables) == 1:
                    raise
                place = Mark(file=str(path), place=table.title)
                yield Rejected(name=name, problems=tuple(error.problems), mark=place, notices=tuple(error.notices))
            notices = []
    finally:
        book.close()


def _chosen(found: Sequence[tuple[SheetRows, int]], number: int | None, path: Path) -> tuple[SheetRows, int]:
    """The sheet that has the table that is meant, and the table's number on it."""
    return choose(found, [str(table.headers[at - 1].mark.in_file) for table, at in found], number, path)


def _tables(path: Path, sheets: Sequence[Any], wanted: str | None) -> tuple[list[SheetRows], list[Problem]]:
    """The sheets to read, and notices of the others."""
    from dh2urdf_plugins.readers.sources.sheets import SheetRows

    mark, titles = Mark(file=str(path)), [sheet.title for sheet in sheets]
    if wanted is not None:
        by_title = {title.casefold(): sheet for title, sheet in zip(titles, sheets, strict=True)}
        if sheet := by_title.get(wanted.casefold()):
            return [SheetRows(sheet, path)], []
        near = next((title for title in titles if did_you_mean(wanted, [title.casefold()])), None)
        about = {"found": wanted, "titles": _listed(titles), "suggestion": near and f"did you mean {near!r}?"}
        raise TableError(say("no-such-sheet", mark, field="sheet", **about))
    hidden = [sheet.title for sheet in sheets if sheet.sheet_state != "visible"]
    tables = [SheetRows(sheet, path) for sheet in sheets if sheet.sheet_state == "visible"]
    found = [table for table in tables if table.headers] or (tables if len(tables) == 1 else [])
    if not found:
        advice = f"`--sheet NAME` reads one that is hidden: {_listed(hidden)}" if hidden else None
        code, visible = "no-sheet-with-a-table" if tables else "no-sheet", _listed([table.title for table in tables])
        raise TableError(say(code, mark, titles=visible, suggestion=advice))
    return found, [say("hidden-sheets", mark, titles=_listed(hidden))] if hidden else []


def _listed(titles: Sequence[str]) -> str:
    return listed([shown(title) for title in titles], 8)


def check_workbook(path: Path) -> None:
    """Refuses what is no workbook, and one that would cost too much."""
    check_file(path, TableError)
    mark = Mark(file=str(path))
    with path.open("rb") as binary:
        start = binary.read(100)
    if start.startswith(b"\xd0\xcf\x11\xe0"):
        raise TableError(say("old-workbook", mark))
    if not start.startswith(b"PK"):
        kind, advice = kind_of_file(start) or ("empty" if not start else "text", None)
        raise TableError(say("no-workbook", mark, kind=kind, suggestion=advice))
    try:
        with zipfile.ZipFile(path) as archive:
            if problem := _fault(mark, archive):
                raise TableError(problem)
    except BROKEN_ARCHIVE as error:
        raise TableError(say("broken-archive", mark, reason=str(error) or type(error).__name__)) from error


def _fault(mark: Mark, archive: zipfile.ZipFile) -> Problem | None:
    """Why an archive is not read; None where it is a workbook."""
    parts = {part.filename: part for part in archive.infolist()}
    if "[Content_Types].xml" not in parts or "xl/workbook.bin" in parts:
        return say("other-archive", mark)
    if "xl/workbook.xml" in parts and _STRICT in archive.open("xl/workbook.xml").read(_PROLOG):
        return say("strict-workbook", mark)
    size, count = sum(part.file_size for part in archive.infolist()), len(archive.infolist())
    if size > MAX_UNPACKED or count > MAX_PARTS:
        found = f"{size / 2**20:,.0f} MiB in {count:,} parts"
        most = f"at most {MAX_UNPACKED / 2**20:,.0f} MiB in {MAX_PARTS:,} parts"
        return say("large-workbook", mark, size=found, limit=most)
    for part in archive.infolist():
        if part.filename.endswith((".xml", ".rels")):
            with archive.open(part) as content:
                if b"<!DOCTYPE" in content.read(_PROLOG).replace(b"\0", b""):
                    return say("workbook-with-entities", mark, part=part.filename)
    return None
