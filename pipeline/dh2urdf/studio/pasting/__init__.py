"""What a person pastes: cells of a spreadsheet, a table of a text or of a page, or a whole table with its header."""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING

from dh2urdf.late_dataclasses import dataclass
from dh2urdf.studio.editing.edits import MOST_ROWS, resized, with_cells
from dh2urdf.studio.editing.opening import Opened, tables_of
from dh2urdf.studio.pasting.typeset import is_value, typeset
from dh2urdf.table_text import REQUIRED, TableText

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.plugin_system.catalog import Catalog

_DECIMAL_COMMA = re.compile(r"[-+−–]?\d+,\d+")
_DECIMAL_POINT = re.compile(r"\d\.\d")
_IN_GROUPS = re.compile(r"[-+−–]?[1-9]\d{0,2}(?:,\d{3})+")
"""A number whose commas may separate thousands: the reader asks which."""
_POINTED_GROUPS = re.compile(r"[-+−–]?[1-9]\d{0,2}(?:\.\d{3})+")
"""A number whose points may separate thousands, where others have decimal commas."""
_YAML = re.compile(r"(?:---\s*\n)?\s*(?:(?:- +)?(?:\{\s*)?[A-Za-z_]\w*:(?:\s|$)|\[?\s*\{)")
"""How a YAML table begins; JSON, which is YAML, begins with a brace."""
_CODE = re.compile(
    r"(?:[=\[]\s*(?:Link|Revolute|Prismatic)|\b(?:(?:Revolute|Prismatic)M?DH|SerialLink|DHRobot|rigidBodyJoint))\s*\("
)
"""What makes a link or a robot in the toolboxes for MATLAB and Python."""
_STATEMENT = re.compile(
    r"\s*+[A-Za-z_][\w.]*+(?:[({]\w++[)}])?(?:\.\w++)?\s*+=(?!=)"
    r"|\s*+['\"](?:a|alpha|d|offset|theta)['\"]\s*+,\s*+[-+.\d]"
    r"|.*?(?<![\w.:])(?!(?:arc|a)tan2\b)[A-Za-z_](?:\w*+\s*+\((?:\s*+[\['\"]|[^(),]*+,)|\w*+[.:]++[A-Za-z_][\w.:]*+\s*+\()"
)
"""A line of a program: an assignment, what a toolbox's link is made of, a call with several values or of a module."""
_MARKUP = re.compile(r"\s*<(?:[?!]|[A-Za-z][\w.:-]*[\s/>])")
"""How XML and HTML begin."""
_COMMENTED = re.compile(r"\s*(?:#+|//+|%+|\*(?=\s)|--(?=\s))[ \t]?")
"""How a line of a comment begins."""
_NUMBER_SIGN = re.compile(r"^([ \t]*\|?[ \t]*)\\?#(?=[ \t]*[|&;,\t]|[ ]{2,}[^:\n]*$)", re.MULTILINE)
"""A sign at the head of the column that counts the rows; it begins no comment."""
_GAP = re.compile(r"([^\S\n]{200})[^\S\n]+")
"""Blanks of which the first ones are enough: some patterns here look at each of them as often as there are any."""
_DIGIT = re.compile(r"\d")
_PROGRAM = (
    "this is code of a program, and not a table: paste the matrix of its numbers, or in Python call "
    "dh2urdf.from_roboticstoolbox(robot).to_csv('arm.csv') and open that file"
)
MOST_NUMBERS = 2
"""Rows whose first cells may be 1 and 2 by chance."""
MIN_COLUMNS = 2
"""Of a table with a header."""
_NAME = re.compile(r"(?!pi\b)[^\W\d_][\w -]*", re.IGNORECASE)
_WORD = re.compile(r"\\?[\[(]*(?:[^\W\d_]|°)")
MOST_HEADERS = 4
"""Lines above the numbers: titles, names, units."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Put:
    """A table with pasted cells in it.

    Attributes:
        table: the table.
        left_out: how many cells found no place, to the right of the last column or below the last row.
    """

    table: TableText
    left_out: int = 0


def cells_of(text: str) -> list[list[str]]:
    """The cells of a pasted text, line by line: of LaTeX or Markdown, or with tabs, semicolons or commas between them.

    Decimal commas become points where no number has a point, and one of the commas can separate no thousands. A comma
    is a separator only where nothing else is, and where every line has as many of them.
    """
    text = _GAP.sub(r"\1", re.sub("\r\n?", "\n", text))
    lines = text.rstrip("\n").split("\n")
    if found := typeset(text):
        rows = found.rows
    elif any("\t" in line for line in lines):
        rows = _split(lines, "\t")
    elif any(";" in line for line in lines):
        rows = _split(lines, ";")
    else:
        rows = _split(lines, ",")
        if len({len(row) for row in rows}) > 1 or _decimal(lines):
            rows = _split(lines, "\t")
    stripped = [[cell.strip() for cell in row] for row in rows]
    every = [cell for row in stripped for cell in row]
    commas = [cell for cell in every if _DECIMAL_COMMA.fullmatch(cell)]
    if not all(map(_IN_GROUPS.fullmatch, commas)) and not any(map(_DECIMAL_POINT.search, every)):
        return [
            [_DECIMAL_COMMA.sub(lambda found: found[0].replace(",", "."), cell) for cell in row] for row in stripped
        ]
    return stripped


def _split(lines: Sequence[str], separator: str) -> list[list[str]]:
    """The cells of some lines; spreadsheets put quotes around a cell that holds a quote, a separator or two lines."""
    text = "\n".join(lines)
    if text.count('"') % 2:  # not a quoted cell, but a length in inches
        return [line.split(separator) for line in lines]
    rows: list[list[str]] = [[]]
    for found in re.finditer(rf'(?: *"((?:[^"]|"")*)" *|([^{separator}\n]*))({separator}|\n|$)', text):
        quoted, plain, end = found.groups()
        rows[-1].append(plain if quoted is None else quoted.replace('""', '"').replace("\n", " "))
        if end == "\n":
            rows.append([])
        elif not end:
            break
    return rows


def _decimal(lines: Sequence[str]) -> bool:
    """Whether each line is one number with a decimal comma."""
    return all(_DECIMAL_COMMA.fullmatch(line.strip()) for line in lines)


def first_field(text: str) -> str:
    """The field of the first cell of a text that is pasted into an empty table: names of joints may come first."""
    return "joint" if _NAME.fullmatch(cells_of(text)[0][0]) else "a"


def whole_tables(text: str, catalog: Catalog, convention: str = "") -> tuple[Opened, ...] | str:
    """The tables of a pasted text, as the readers read them: a YAML file, or a table that has comments or a header.

    Args:
        text: the text.
        catalog: the installed stages.
        convention: the convention of a table that names none.

    Returns:
        The tables; none where the text has no header, and so is cells. A message where it has one and cannot be read.
    """
    text = _GAP.sub(r"\1", text)
    if _CODE.search(text):
        return _PROGRAM
    if _MARKUP.match(text):
        return (
            "this is the text of an XML or HTML file, and not a table: open a robot description as a file, and copy "
            "the table of a page as the browser shows it"
        )
    text = _NUMBER_SIGN.sub(r"\1no.", _uncommented(text))
    lines = [line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")]
    shown = typeset(text)
    is_yaml = not shown and _YAML.match("\n".join(lines)) is not None
    if not is_yaml and not shown and 2 * sum(map(bool, map(_STATEMENT.match, lines))) > len(lines):
        return _PROGRAM
    if not is_yaml and not has_header(text) and not (shown and (shown.says_more or _is_headed(shown.rows))):
        return _doubt(text)
    if is_yaml and "joints" not in text and text.lstrip()[:1] in ("-", "["):
        text = "joints:\n" + "\n".join(f"  {line}" for line in text.splitlines())
    if shown:
        text = shown.as_csv()
    found = tables_of("clipboard.yaml" if is_yaml else "clipboard.csv", text.encode(), catalog)
    if isinstance(found, str):
        return found
    return tuple(
        opened if opened.table.convention else opened._replace(table=replace(opened.table, convention=convention))
        for opened in found
    )


def _doubt(text: str) -> tuple[()] | str:
    """What may be misread in cells without a header; empty where nothing is likely to be."""
    rows = cells_of(text)
    every = [cell for row in rows for cell in row]
    pointed = next(filter(_POINTED_GROUPS.fullmatch, every), None)
    comma = next((cell for cell in every if _DECIMAL_COMMA.fullmatch(cell) and not _IN_GROUPS.fullmatch(cell)), None)
    if pointed is not None and comma is not None:
        return (
            f"{pointed!r} can be read in two ways, since {comma!r} has a decimal comma: "
            "the point may separate thousands\n"
            "accepted: decimal commas alone, or decimal points alone, without separators of thousands"
        )
    first = [row[0] for row in rows]
    counted = len(rows) > MOST_NUMBERS and min(map(len, rows)) > len(REQUIRED)
    if counted and any(first == [str(number + start) for number in range(len(rows))] for start in (0, 1)):
        return (
            f"the first column counts the rows, {first[0]} to {first[-1]}, and would be cells of the table\n"
            "copy the cells without it, or with their header"
        )
    return ()


def _uncommented(text: str) -> str:
    """The table that a text has behind the sign of a comment in every line; any other text as it is."""
    lines = [line for line in text.splitlines() if line.strip()]
    if len(lines) < MIN_COLUMNS or not all(map(_COMMENTED.match, lines)):
        return text
    without = "\n".join(_COMMENTED.sub("", line) for line in lines)
    return without if typeset(without) else text


def has_header(text: str) -> bool:
    """Whether a text has comments of a table, or lines of words with lines of numbers below."""
    lines = [line for line in text.splitlines() if line.strip()]
    if lines and lines[0].lstrip().startswith("#"):
        return True
    lines = [line for line in lines if not line.lstrip().startswith("#")]
    rows = cells_of("\n".join(lines))
    if all(len(row) == 1 for row in rows):  # some lines have more commas than others: the reader says which
        rows = [[cell.strip() for cell in row] for row in _split(lines, ",")]
    return _is_headed(rows)


def _is_headed(rows: Sequence[Sequence[str]]) -> bool:
    """Whether rows of words are above rows of numbers."""
    widest = 0
    for row, below in pairwise(rows[: MOST_HEADERS + 1]):
        if not all(_is_word(cell) or not cell for cell in row):
            return False
        widest = max(widest, sum(map(bool, row)))
        if widest >= MIN_COLUMNS and sum(bool(_DIGIT.search(cell)) for cell in below) >= MIN_COLUMNS:
            return True
    return False


def _is_word(cell: str) -> bool:
    """Whether a cell is a word of a header or a unit, and no value such as ``pi/2`` or ``q1``."""
    return _WORD.match(cell) is not None and not is_value(cell)


def pasted(table: TableText, row: int, field: str, text: str, columns: Sequence[str]) -> Put:
    """The table with the cells of a text put in, from one cell to the right and downwards.

    Args:
        table: the table; rows are added where there are too few.
        row: number of the row of the first cell.
        field: its field.
        text: the text.
        columns: the fields that are on the screen, in order.
    """
    lines = cells_of(text)
    first = columns.index(field)
    table = resized(table, max(len(table.rows), min(row + len(lines), MOST_ROWS)))
    every = {(row + down, first + right): cell for down, line in enumerate(lines) for right, cell in enumerate(line)}
    fitting = {
        (down, columns[right]): cell
        for (down, right), cell in every.items()
        if down < len(table.rows) and right < len(columns)
    }
    return Put(
        table=with_cells(table, fitting), left_out=sum(map(bool, every.values())) - sum(map(bool, fitting.values()))
    )
