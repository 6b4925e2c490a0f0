"""A header of several rows: titles over the names of columns, and units below them."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from dh2urdf.errors import TableError
from dh2urdf.quantities import is_unit
from dh2urdf.source import Messages, Problem
from dh2urdf.table_text import CellRow
from dh2urdf_plugins.readers.header.words import read_header
from dh2urdf_plugins.readers.words.cells import SPACES, text_of
from dh2urdf_plugins.readers.words.fields import key_of, keys_in

if TYPE_CHECKING:
    from collections.abc import Sequence

say = Messages(__file__)

_UNIT = r"(.*\S)\s*[\[(]([^\[\]()]*)[\])]"


def text_in(cell: object) -> str:
    """What a cell holds, as a text; empty where it holds nothing."""
    if isinstance(cell, Problem):
        return cell.found or ""
    if cell is None or isinstance(cell, str):
        return cell or ""
    if isinstance(cell, bool):
        return str(cell).lower()
    return text_of(cell) if isinstance(cell, float) else str(cell)


def is_number(text: str) -> bool:
    """Whether a cell begins as a number does."""
    return bool(re.match(r"[+\-−]?[.,]?[0-9]", text))


def headers_in(row: CellRow) -> list[str]:
    """The texts of a header; a spreadsheet may break them into lines."""
    return [" ".join(text_in(cell).split("\n")).strip(SPACES) for cell in row.cells]


def unit_in(text: str) -> str | None:
    """The unit that a cell is, in brackets or not: ``mm``, ``[deg]``; None where it is none."""
    word = text.strip(f"{SPACES}[]()")
    return word if word and is_unit(word) else None


def _is_dash(text: str) -> bool:
    """Whether a cell of a row of units says that there is none: empty, ``-``, ``n/a``."""
    return key_of(text.strip(f"{SPACES}[]()–—").casefold()) in {"", *keys_in("headers", "no_unit")}


def is_beside(index: int, named: Sequence[object]) -> bool:
    """Whether a column, counted from 0, is beside the table: neither it nor those right and next left have a header."""
    return index > 0 and not any(named[index - 1 :])


def join_headers(upper: CellRow, lower: CellRow) -> CellRow:
    """A header of two rows: ``Limits [deg]`` over ``lower`` and ``upper``, ``com`` over ``x``, a name over a unit."""
    pairs = _pairs(headers_in(upper), headers_in(lower))
    marks = lower.marks if len(lower.marks or ()) == len(pairs) else upper.marks
    return CellRow([_joined(top, sub) for top, sub in pairs], lower.mark, marks)


def completed(header: CellRow, row: CellRow) -> CellRow | None:
    """The header with the row below it, where that is a row of units, or of names under shared titles; else None."""
    if len(row.cells) > len(header.cells) or not all(cell is None or isinstance(cell, str) for cell in row.cells):
        return None
    names, texts = headers_in(header), headers_in(row)
    if all(map(_is_dash, texts)):
        return None
    for name, text in _pairs(names, texts):
        title = read_header(name).field
        is_part = not (title and not title.parts) and any(read_header(each).field for each in (f"{name} {text}", text))
        if not (_is_dash(text) or unit_in(text) or is_part):
            return None
    below: list[str] = []
    for name, text, mark in zip(names, texts, row.marks or [row.mark] * len(texts), strict=False):
        said, unit = read_header(name).unit, unit_in(text)
        if said and unit and said.casefold() != unit.casefold():
            raise TableError(say("row-of-units", mark, found=unit, header=name))
        below.append(text if (name and unit) or not _is_dash(text) else "")
    return join_headers(header, CellRow(below, header.mark, header.marks))


def _pairs(tops: list[str], subs: list[str]) -> list[tuple[str, str]]:
    """Titles and what is below them; a title is also over the next columns where these are its parts: a merged cell."""
    width, title, found = max(len(tops), len(subs)), "", list[tuple[str, str]]()
    for top, sub in zip(tops + [""] * (width - len(tops)), subs + [""] * (width - len(subs)), strict=True):
        title = top or title
        group = read_header(title).field if title and sub and not top else None
        part = read_header(sub).field or read_header(f"{_stem(title)[0]} {sub}").field if group else None
        found.append((title if group and part and part.name in group.parts else top, sub))
    return found


def _stem(title: str) -> tuple[str, str | None]:
    """A title without its unit, and the unit."""
    match = re.fullmatch(_UNIT, title)
    return (match[1], match[2]) if match else (title, None)


def _joined(top: str, sub: str) -> str:
    """The header that a name and what is below it make; the lower one where the upper one adds nothing."""
    if not top or not sub:
        return sub or (top if read_header(top).field else "")
    if own := unit_in(sub):
        return f"{top} [{own}]"
    stem, unit = _stem(top)
    if read_header(sub).field is None and read_header(f"{stem} {sub}").field:
        sub = f"{stem} {sub}"
    header = read_header(sub)
    measures = header.field and header.field.dimension and header.unit is None
    return f"{sub} [{unit}]" if measures and unit and is_unit(unit) else sub
