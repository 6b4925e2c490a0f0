"""What a person pastes: cells of a spreadsheet, a table of a text or of a page, or a whole table with its header."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from itertools import pairwise, takewhile
from typing import TYPE_CHECKING

from dh2urdf.manipulator import Convention
from dh2urdf.table_text import REQUIRED, TableText
from dh2urdf_studio.editing.edits import MOST_ROWS, resized, with_cells
from dh2urdf_studio.editing.opening import Opened, tables_of
from dh2urdf_studio.editing.reading import read_whole
from dh2urdf_studio.pasting.typeset import Typeset, is_value, typeset

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

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
_TIMES_PI = re.compile(r"(?<![\w.])(\d+(?:\.\d*)?|\.\d+)(?=(?:π|pi)\b)", re.IGNORECASE)
"""A number to be multiplied by π, as in ``2π/3``."""
_PARAMETER = re.compile(r"[ ({\[]*(?:(alpha|α)|([ar])|(d))(?![^\W\d_])", re.IGNORECASE)
_DIGIT = re.compile(r"\d")
_PROGRAM = (
    "this is code of a program, and not a table: paste the matrix of its numbers, or in Python call "
    "dh2urdf.from_roboticstoolbox(robot).to_csv('arm.csv') and open that file"
)
ORDERS = {
    3: ("a alpha d", "alpha a d", "d a alpha", "a d alpha"),
    4: ("a alpha d theta", "theta d a alpha", "alpha a d theta", "theta a d alpha", "d theta a alpha"),
}
"""Usual orders of columns: of Spong, of the Robotics Toolbox, of Craig, of Universal Robots, of Wikipedia."""
_NAMED = ("joint", "type")
"""What columns of words are before them."""
USUAL_UNITS = ("m", "rad")
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
    text = _TIMES_PI.sub(r"\1*", _GAP.sub(r"\1", re.sub("\r\n?", "\n", text)))
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


def orders(text: str) -> list[tuple[str, ...]]:
    """What the columns of cells may be that have no names: of DH parameters alone, or behind names and types."""
    rows = cells_of(text)
    if len({len(row) for row in rows}) > 1:
        return []
    columns = [*zip(*rows, strict=True)]
    names = [*takewhile(lambda cells: all(map(_is_name, cells)), columns)]
    usual = ORDERS.get(len(columns) - len(names), ()) if len(names) <= len(_NAMED) else ()
    return [(*_NAMED[: len(names)], *order.split()) for order in usual]


def _is_name(cell: str) -> bool:
    return _NAME.fullmatch(cell) is not None and not is_value(cell)


def whole_tables(
    text: str, catalog: Catalog, convention: str = "", units: tuple[str, str] = USUAL_UNITS
) -> tuple[Opened, ...] | str:
    """The tables of a pasted text, as the readers read them: a YAML file, or a table that has comments or a header.

    Args:
        text: the text.
        catalog: the installed stages.
        convention: the convention of a table that names none.
        units: the units of lengths and of angles of a table that names none.

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
    text = _TIMES_PI.sub(r"\1*", _NUMBER_SIGN.sub(r"\1no.", _uncommented(text)))
    lines = [line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")]
    shown = typeset(text)
    if turned := _turned(shown.rows if shown else cells_of("\n".join(lines))):
        comments = [line for line in text.splitlines() if line.lstrip().startswith("#")]
        shown = Typeset(turned, shown.around if shown else "\n".join(comments))
    is_yaml = not shown and _YAML.match("\n".join(lines)) is not None
    if not is_yaml and not shown and 2 * sum(map(bool, map(_STATEMENT.match, lines))) > len(lines):
        return _PROGRAM
    if not is_yaml and not has_header(text) and not (shown and (shown.says_more or _is_headed(shown.rows))):
        return _doubt(text)
    if is_yaml and "joints" not in text and text.lstrip()[:1] in ("-", "["):
        text = "joints:\n" + "\n".join(f"  {line}" for line in text.splitlines())
    if shown:
        text = shown.as_csv()
    return _read(text, catalog, convention, units, is_yaml=is_yaml)


def _read(
    text: str, catalog: Catalog, convention: str, units: tuple[str, str], *, is_yaml: bool
) -> tuple[Opened, ...] | str:
    """The tables of a text, in the units of the page where it can be read in them."""
    unread: tuple[Opened, ...] | str = ()
    for declared in _declared(text, units, is_yaml=is_yaml):
        found = tables_of("clipboard.yaml" if is_yaml else "clipboard.csv", declared.encode(), catalog)
        if not isinstance(found, str):
            found = tuple(opened._replace(table=_of(convention, opened.table)) for opened in found)
            if not any(read_whole(_of(Convention.STANDARD, opened.table), catalog).errors for opened in found):
                return found
        unread = found
    return unread


def _of(convention: str, table: TableText) -> TableText:
    """A table in a convention, unless it names one."""
    return replace(table, convention=table.convention or str(convention))


def _declared(text: str, units: tuple[str, str], *, is_yaml: bool) -> Iterator[str]:
    """A text with units declared in it: a reader refuses that where the text names its own. The text itself is last."""
    pairs = [(kind, unit) for kind, unit in zip(("length", "angle"), units, strict=True) if unit not in USUAL_UNITS]
    for some in ([pairs] if pairs else []) + ([[pair] for pair in pairs] if len(pairs) > 1 else []):
        said = "units: {" + ", ".join(f"{kind}: {unit}" for kind, unit in some) + "}"
        if not is_yaml:
            yield f"# {said}\n{text}"
        elif text.lstrip().startswith("{"):
            yield text.replace("{", f"{{{said}, ", 1)
        else:
            begin = found.end() if (found := re.match(r"\s*---.*\n", text)) else 0
            yield f"{text[:begin]}{said}\n{text[begin:]}"
    yield text


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


def _turned(rows: Sequence[Sequence[str]]) -> list[list[str]]:
    """The table that a table is whose joints are in columns, with a row for each; none where it is no such table."""
    found = {match.lastindex for row in rows if row and (match := _PARAMETER.match(row[0]))}
    is_turned = len(found) == len(REQUIRED) and len({len(row) for row in rows}) == 1 < len(rows[0])
    if not is_turned:
        return []
    head, *columns = zip(*rows, strict=True)
    return [[head[0] or "joint", *head[1:]], *map(list, columns)]


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
