"""What a person pastes: cells for the table on the page, or a whole table, which the reader of tables reads."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache
from itertools import takewhile
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.manipulator import Convention
from dh2urdf.plugin_system.catalog import load
from dh2urdf.stages import ReadsCells
from dh2urdf_studio.editing.edits import MOST_ROWS, resized, with_cells
from dh2urdf_studio.editing.opening import Opened, tables_of
from dh2urdf_studio.editing.reading import read_whole

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.table_text import TableText

USUAL_UNITS = ("m", "rad")
ORDERS = {
    3: ("a alpha d", "alpha a d", "d a alpha", "a d alpha"),
    4: ("a alpha d theta", "theta d a alpha", "alpha a d theta", "theta a d alpha", "d theta a alpha"),
}
"""Usual orders of columns: of Spong, of the Robotics Toolbox, of Craig, of Universal Robots, of Wikipedia."""
_NO_TABLE = (
    "this is no table\naccepted: cells of a spreadsheet or CSV, a table of Markdown or LaTeX, YAML, JSON, or rows of "
    "numbers in brackets; a robot description is opened as a file"
)
_NAME = re.compile(r"(?!pi\b)[^\W\d_][\w -]*", re.IGNORECASE)
_VALUE = re.compile(r"[-+−–]?(?:[\d.,]+(?:e[-+]?\d+)?|pi|π|(?:θ|theta|th|q|d)_?\d+)(?!\w)", re.IGNORECASE)
"""How a number or an expression begins."""
_WORD = re.compile(r"[^\W\d_]{2,}")
_UNNAMED = "field 'columns'"
"""What the reader's message has in it where nothing names the columns."""


class Put(NamedTuple):
    """A table with pasted cells in it, and how many cells found no place."""

    table: TableText
    left_out: int = 0


@cache
def _cells() -> Callable[[str], list[list[str]]]:
    reads = load().cell_reader().can(ReadsCells)
    return (reads and reads.cells_of) or (lambda text: [line.split("\t") for line in text.splitlines()])


def cells_of(text: str) -> list[list[str]]:
    """The cells of a pasted text, line by line; decimal commas become points where they can be nothing else."""
    return _cells()(text)


def first_field(text: str) -> str:
    """The field of the first cell of a text that is pasted into an empty table: names of joints may come first."""
    return "joint" if _NAME.fullmatch(cells_of(text)[0][0]) else "a"


def orders(text: str) -> list[tuple[str, ...]]:
    """What the columns of cells may be that have no names: of DH parameters alone, or behind names and types."""
    rows = cells_of(text)
    if len({len(row) for row in rows}) > 1:
        return []
    columns = [*zip(*rows, strict=True)]
    names = [*takewhile(lambda cells: all(_NAME.fullmatch(each) and not _VALUE.match(each) for each in cells), columns)]
    usual = ORDERS.get(len(columns) - len(names), ()) if len(names) <= len(("joint", "type")) else ()
    return [(*("joint", "type")[: len(names)], *order.split()) for order in usual]


def whole_tables(
    text: str, catalog: Catalog, convention: str = "", units: tuple[str, str] = USUAL_UNITS
) -> tuple[Opened, ...] | str:
    """The tables of a pasted text with a header; convention and units hold where it names none.

    Returns:
        The tables; none where the text has no header, and so is cells. A message where it has one and cannot be read.
    """
    text = text.strip("\r\n")
    if text.lstrip().startswith("<"):
        return _NO_TABLE
    if not re.search(r"[\r\n]|^\s*(?:- )?[\[{]|\\begin", text):
        return ()
    unread: tuple[Opened, ...] | str = ()
    for options in _declared(units):
        found = tables_of("clipboard.txt", text.encode(), catalog, options=options)
        if not isinstance(found, str):
            found = tuple(opened._replace(table=_of(convention, opened.table)) for opened in found)
            if not any(read_whole(_of(Convention.STANDARD, opened.table), catalog).errors for opened in found):
                return found
        unread = found
    return () if isinstance(unread, str) and _UNNAMED in unread and not _words_around(text) else unread


def _words_around(text: str) -> bool:
    """Whether a text has sentences around its cells, which nobody would see again."""
    cells = {cell for row in cells_of(text) for cell in row if cell}
    others = (line for line in text.splitlines() if not any(cell in line for cell in cells) and "=" not in line)
    return "\\caption" in text or any(_WORD.search(line) and not line.startswith("import ") for line in others)


def _of(convention: str, table: TableText) -> TableText:
    """A table in a convention, unless it names one."""
    return replace(table, convention=table.convention or str(convention))


def _declared(units: tuple[str, str]) -> Iterator[dict[str, str]]:
    """The units of the page as options: a reader refuses those where the text names its own. The last are none."""
    said = {
        f"{kind}_unit": unit for kind, unit in zip(("length", "angle"), units, strict=True) if unit not in USUAL_UNITS
    }
    yield from [said, *({key: unit} for key, unit in said.items())] if said else []
    yield {}


def pasted(table: TableText, row: int, field: str, text: str, columns: Sequence[str]) -> Put:
    """The table with the cells of a text put in, from one cell to the right and downwards; rows are added for them."""
    lines = cells_of(text)
    first = columns.index(field)
    table = resized(table, max(len(table.rows), min(row + len(lines), MOST_ROWS)))
    every = {(row + down, first + right): cell for down, line in enumerate(lines) for right, cell in enumerate(line)}
    fitting = {
        (down, columns[right]): cell
        for (down, right), cell in every.items()
        if down < len(table.rows) and right < len(columns)
    }
    return Put(with_cells(table, fitting), sum(map(bool, every.values())) - sum(map(bool, fitting.values())))
