"""Several tables in one file: they are counted by their headers, and one of them is chosen by its number."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from dh2urdf.errors import TableError
from dh2urdf.source import Mark, Messages
from dh2urdf_plugins.readers.comments.top import comment_text, is_header
from dh2urdf_plugins.readers.header.header_rows import is_number, text_in
from dh2urdf_plugins.readers.words.cells import SPACES

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from pathlib import Path

    from dh2urdf.table_text import CellRow

    Table = TypeVar("Table")

say = Messages(__file__)


def choose(tables: Sequence[Table], places: Sequence[str], number: int | None, path: Path | str) -> Table:
    """The table that a number means, from 1, or the only one; places are where each begins, as a sentence names it."""
    if number is not None and 0 < number <= len(tables):
        return tables[number - 1]
    if len(tables) == 1 and number is None:
        return tables[0]
    mark, found = Mark(file=str(path)), None if number is None else str(number)
    if not tables:
        raise TableError(say("no-table", mark, field="columns", found=found))
    count = "1 table" if len(tables) == 1 else f"{len(tables)} tables"
    listed = [f"{at} in {place}" for at, place in enumerate(places, start=1)]
    raise TableError(
        say("several-tables", mark, field="table_number", found=found, count=count, places=listed, most=len(tables))
    )


def starts_table(row: CellRow) -> bool:
    """Whether a row is a header, and so begins a table; it has no number in it."""
    return not _has_number(row) and is_header(row)


def one_table(rows: Iterable[CellRow], number: int) -> Iterator[CellRow]:
    """The rows of one of several tables below each other, which are counted from 1.

    What is above the first header holds for every table, unless the lines above a table's own header say it.
    """
    top: list[CellRow] = []
    held: list[CellRow] = []  # rows without a number, which a header may follow
    seen = 0
    for row in rows:
        if starts_table(row):
            seen += 1
            if seen > number:
                return
            if seen == number:
                own = {key for each in held if (key := _key(each))}
                yield from (each for each in top if _key(each) not in own)
                yield from held
                yield row
            held = []
        elif not seen:
            top.append(row)
        else:
            held.append(row)
            if _has_number(row):
                yield from held if seen == number else ()
                held = []
    yield from held if seen else top


def _has_number(row: CellRow) -> bool:
    return any(isinstance(cell, float | int) or is_number(text_in(cell).strip(SPACES)) for cell in row.cells)


def _key(row: CellRow) -> str | None:
    """What a line above a header declares something under."""
    if not any(map(text_in, row.cells)):
        return None
    key, colon, _ = comment_text(row).partition(":")
    return key.strip("#%/ ").casefold() if colon else None
