"""What a workbook holds beside the values of its cells, and the bounds of what its reading may cost.

openpyxl reads the values row by row, without holding a sheet. Merged cells, hidden rows and formulas that have never
been computed are not among what it gives so, and are read here from the sheet's XML (ECMA-376-1, part 18.3).
"""

from __future__ import annotations

import posixpath
import zipfile
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NoReturn
from xml.parsers import expat

from lxml import etree

from dh2urdf.documents import BROKEN_ARCHIVE, check_file, kind_of_file
from dh2urdf.errors import TableError
from dh2urdf.source import Mark, Problem

if TYPE_CHECKING:
    from pathlib import Path

MAX_UNPACKED = 2**29
"""Bytes of a workbook when unpacked [B]: a zip archive may hold a thousand times its own size."""
MAX_PARTS = 10_000
"""Parts of a workbook."""
MAX_ROW, MAX_COLUMN = 2**20, 2**14
"""The last row and column of a sheet in Excel: rows that hold nothing are read up to the one that has a cell."""

_LONGEST_REFERENCE = 20
_PROLOG = 2**16
_STRICT = b"http://purl.oclc.org/ooxml/"
"""What the names of a strict workbook's elements begin with (ISO/IEC 29500-1); openpyxl knows the transitional ones."""
_ACCEPTED = "a workbook in the format of Excel 2007 and later (.xlsx)"


@dataclass(slots=True)
class SheetLayout:
    """What a sheet has beside values.

    Attributes:
        merged: the merged ranges: first row, first column, last row and last column, counted from 1.
        hidden_rows: rows that are not shown and hold anything.
        hidden_columns: first and last of each run of columns that are not shown.
        uncomputed: by row, the columns of formulas without a value.
        comments: the comments on cells: row, column and text.
        fonts: by row and column, texts of the sheet itself whose parts have fonts of their own.
    """

    merged: list[tuple[int, int, int, int]] = field(default_factory=list)
    hidden_rows: list[int] = field(default_factory=list)
    hidden_columns: list[tuple[int, int]] = field(default_factory=list)
    uncomputed: dict[int, list[int]] = field(default_factory=dict)
    comments: list[tuple[int, int, str]] = field(default_factory=list)
    fonts: dict[int, dict[int, Any]] = field(default_factory=dict)


def check_workbook(path: Path) -> None:
    """Refuses what is no workbook, and one that would cost too much.

    Raises:
        TableError: the file is of another kind, is broken, holds too much, or XML that declares entities.
    """
    check_file(path, TableError)
    with path.open("rb") as binary:
        start = binary.read(100)
    if start.startswith(b"\xd0\xcf\x11\xe0"):
        _refuse(
            path,
            "this is a workbook of Excel 97 to 2003 (xls), or one with a password",
            "save it as .xlsx, without a password",
        )
    if not start:
        _refuse(path, "the file is empty", "save the sheet as .xlsx")
    if path.name.startswith("~$"):
        _refuse(path, "this is what Excel keeps beside a workbook that is open", f"give the workbook {path.name[2:]}")
    if not start.startswith(b"PK"):
        if found := kind_of_file(start):
            _refuse(path, f"this is {found[0]}, no workbook", found[1])
        _refuse(path, "this is no workbook", "save the sheet as .xlsx; a table of text is read by the reader csv")
    try:
        with zipfile.ZipFile(path) as archive:
            _check_parts(path, archive)
    except BROKEN_ARCHIVE as error:
        _refuse(path, f"the workbook is broken: {error or type(error).__name__}", "save it again")


def _check_parts(path: Path, archive: zipfile.ZipFile) -> None:
    parts = archive.infolist()
    names = {part.filename for part in parts}
    if "mimetype" in names and "content.xml" in names:
        _refuse(path, "this is a spreadsheet in the OpenDocument format (ods)", "save it as .xlsx")
    if "[Content_Types].xml" not in names or "xl/workbook.bin" in names:
        _refuse(path, "this zip archive is no workbook in XML", "save it as .xlsx")
    if "xl/workbook.xml" in names and _STRICT in archive.open("xl/workbook.xml").read(_PROLOG):
        _refuse(
            path,
            "this is a workbook in the format Strict Open XML",
            "save it as `Excel Workbook (.xlsx)`, not as `Strict Open XML Spreadsheet (.xlsx)`",
        )
    size = sum(part.file_size for part in parts)
    if size > MAX_UNPACKED or len(parts) > MAX_PARTS:
        found = f"{size / 2**20:,.0f} MiB in {len(parts):,} parts"
        accepted = f"at most {MAX_UNPACKED / 2**20:,.0f} MiB in {MAX_PARTS:,} parts"
        message = f"the workbook holds {found} when unpacked"
        raise TableError(
            Problem(
                message=message,
                mark=Mark(file=str(path)),
                accepted=accepted,
                suggestion="save the sheet as CSV: a CSV file of any length is read",
            )
        )
    for part in parts:
        if part.filename.endswith((".xml", ".rels")) and _declares_entities(archive, part):
            _refuse(path, f"its part {part.filename} has a document type, as no spreadsheet writes it", "save it again")


def _declares_entities(archive: zipfile.ZipFile, part: zipfile.ZipInfo) -> bool:
    """Whether a part has a document type, in which entities could be declared that unfold to gigabytes."""
    found: list[str] = []
    parser = expat.ParserCreate()
    parser.StartDoctypeDeclHandler = lambda name, *_: found.append(name)
    with archive.open(part) as content:
        try:
            parser.Parse(content.read(_PROLOG), False)
        except expat.ExpatError:
            return bool(found)  # what is broken is refused where it is read
    return bool(found)


def _refuse(path: Path, message: str, suggestion: str) -> NoReturn:
    raise TableError(Problem(message=message, mark=Mark(file=str(path)), accepted=_ACCEPTED, suggestion=suggestion))


# --- Sheets -----------------------------------------------------------------------------------------------------------


def sheet_parts(path: Path) -> dict[str, str]:
    """The part of each sheet, by its title.

    Raises:
        TableError: the workbook is broken.
    """
    with zipfile.ZipFile(path) as archive:
        book_name = _target(archive, "_rels/.rels", "", "/officeDocument")
        folder, _, file = book_name.rpartition("/")
        links = _links(archive, f"{folder}/_rels/{file}.rels", folder)
        book = etree.fromstring(archive.read(book_name), _parser())
        found = {}
        for sheet in book.iter("{*}sheet"):
            key = next((value for name, value in sheet.attrib.items() if str(name).endswith("}id")), "")
            if (target := links.get(str(key))) and target[1].endswith("/worksheet"):
                found[sheet.get("name", "")] = target[0]
        return found


def _parser() -> etree.XMLParser:
    return etree.XMLParser(resolve_entities=False, no_network=True)


def _links(archive: zipfile.ZipFile, name: str, folder: str) -> dict[str, tuple[str, str]]:
    """The part and the kind of each relation of a part."""
    found = {}
    for link in etree.fromstring(archive.read(name), _parser()).iter("{*}Relationship"):
        path = posixpath.join("/", folder, link.get("Target", ""))
        found[link.get("Id", "")] = posixpath.normpath(path).lstrip("/"), link.get("Type", "")
    return found


def _target(archive: zipfile.ZipFile, name: str, folder: str, kind: str) -> str:
    return next(part for part, type_ in _links(archive, name, folder).values() if type_.endswith(kind))


def read_layout(path: Path, part: str) -> SheetLayout:
    """What a sheet has beside values.

    Args:
        path: the workbook.
        part: the sheet's part.
    """
    layout = SheetLayout()
    with zipfile.ZipFile(path) as archive, archive.open(part) as content:
        tags = [f"{{*}}{name}" for name in ("row", "col", "mergeCell")]
        parsed: Any = etree.iterparse(content, events=("end",), tag=tags, resolve_entities=False, no_network=True)
        number = 0
        for _, element in parsed:
            match etree.QName(element).localname:
                case "row":
                    number = int(element.get("r") or number + 1)
                    _see_row(layout, element, number)
                    element.clear()
                    while element.getprevious() is not None:
                        del element.getparent()[0]
                case "col" if _is_true(element.get("hidden")):
                    layout.hidden_columns.append((int(element.get("min", "1")), int(element.get("max", "1"))))
                case "mergeCell":
                    layout.merged.append(_range(element.get("ref", "A1")))
    layout.comments = _comments(path, part)
    return layout


def _comments(path: Path, part: str) -> list[tuple[int, int, str]]:
    folder, _, file = part.rpartition("/")
    found = []
    with zipfile.ZipFile(path) as archive:
        links, parts = f"{folder}/_rels/{file}.rels", set(archive.namelist())
        if links not in parts:
            return []
        for target, kind in _links(archive, links, folder).values():
            if not kind.endswith("/comments") or target not in parts:
                continue
            with archive.open(target) as content:
                parsed: Any = etree.iterparse(
                    content, events=("end",), tag="{*}comment", resolve_entities=False, no_network=True
                )
                for _, comment in parsed:
                    text = " ".join("".join(comment.itertext("{*}t")).split())
                    if text:
                        found.append((*_cell(comment.get("ref", "A1")), text))
                    comment.clear()
                    while comment.getprevious() is not None:
                        del comment.getparent()[0]
    return found


def _see_row(layout: SheetLayout, row: Any, number: int) -> None:  # noqa: ANN401 - an element
    hidden = _is_true(row.get("hidden"))
    column = 0
    filled = False
    if number > MAX_ROW:
        raise ValueError(f"a row has the number {number:,}, and a sheet has {MAX_ROW:,} rows")
    for cell in row:
        column = _cell(cell.get("r"))[1] if cell.get("r") else column + 1
        value = cell.findtext("{*}v")
        inline = cell.find("{*}is")
        filled = filled or bool(value) or inline is not None
        if inline is not None and inline.find("{*}r/{*}rPr") is not None:
            from openpyxl.cell.rich_text import CellRichText

            layout.fonts.setdefault(number, {})[column] = CellRichText.from_tree(inline)
        # A formula whose value is an empty text has the type of texts, and is an empty cell.
        if not value and cell.get("t") != "str" and cell.find("{*}f") is not None:
            layout.uncomputed.setdefault(number, []).append(column)
    if hidden and filled:
        layout.hidden_rows.append(number)


def _is_true(word: str | None) -> bool:
    return word in ("1", "true")


def _range(ref: str) -> tuple[int, int, int, int]:
    first, _, last = ref.partition(":")
    return (*_cell(first), *_cell(last or first))


def _cell(ref: str) -> tuple[int, int]:
    """Row and column of a reference such as ``C4``.

    Raises:
        ValueError: it is beyond the last row or column of a sheet.
    """
    letters = ref.rstrip("0123456789")
    column = 0
    for letter in letters[:_LONGEST_REFERENCE].replace("$", "").upper():
        column = 26 * column + ord(letter) - 64
    row = int(ref[len(letters) :][:_LONGEST_REFERENCE] or 1)
    if row > MAX_ROW or column > MAX_COLUMN:
        raise ValueError(f"the cell {ref[:_LONGEST_REFERENCE]} is beyond the last one of a sheet")
    return row, column
